// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/analyse/group_curves.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {

MeanCurves mean_curves(MatrixIn values, MatrixIn stds, MatrixIn members) {
    require(stds.rows() == values.rows() && stds.cols() == values.cols() && members.cols() == values.cols(),
            "mean_curves: values, standard deviations and members must have the same columns");
    const Eigen::VectorXd counts = members.rowwise().sum().cwiseMax(1);
    const Eigen::MatrixXd weights = members.transpose() * counts.cwiseInverse().asDiagonal();  // M x G
    MeanCurves means;
    means.values = values * weights;
    means.stds = (stds.cwiseAbs2() * weights.cwiseAbs2()).cwiseSqrt();
    means.measured_std = (stds * weights).colwise().mean().transpose();
    return means;
}

}  // namespace mimetic
