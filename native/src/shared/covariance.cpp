// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <mimetic/shared/covariance.hpp>

namespace mimetic {

bool is_covariance(const Eigen::MatrixXd& covariance, double asymmetry) {
    if (!covariance.allFinite() || covariance.diagonal().minCoeff() < 0 ||
        (covariance - covariance.transpose()).cwiseAbs().maxCoeff() > asymmetry) {
        return false;
    }
    const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
    return correlation.allFinite() &&  // else there is variation where there is no variance
           Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation, Eigen::EigenvaluesOnly)
                   .eigenvalues()
                   .minCoeff() > -1e-6;
}

Eigen::MatrixXd nearest_covariance(const Eigen::MatrixXd& covariance, double least) {
    const Eigen::MatrixXd symmetric = (covariance + covariance.transpose()) / 2;
    const Eigen::VectorXd std = symmetric.diagonal().cwiseMax(1e-300).cwiseSqrt();
    const Eigen::VectorXd scale = std.cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * symmetric *
                                                                scale.asDiagonal());
    const Eigen::MatrixXd& vectors = solver.eigenvectors();
    return std.asDiagonal() *
           (vectors * solver.eigenvalues().cwiseMax(least).asDiagonal() * vectors.transpose()).eval() *
           std.asDiagonal();
}

}  // namespace mimetic
