// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion_prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {

void check_correlation(const FaceMotion& motion) {
    constexpr double kRounding = 1e-9;
    const Eigen::MatrixXd& correlation = motion.correlation;
    const Eigen::Index count = motion.modes.rows();
    if (correlation.size() == 0) {
        return;
    }
    if (correlation.rows() != count || correlation.cols() != count || !correlation.allFinite() ||
        (correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kRounding ||
        (correlation.diagonal().array() - 1).abs().maxCoeff() > kRounding ||
        correlation.llt().info() != Eigen::Success) {
        throw InvalidInput(
            "correlation must be empty or a symmetric, positive definite matrix with ones on its diagonal, " +
            std::to_string(count) + " x " + std::to_string(count));
    }
}

Eigen::MatrixXd rest_covariance(const FaceMotion& motion) {
    if (motion.correlation.size() == 0) {
        return motion.prior_std.cwiseAbs2().asDiagonal();
    }
    return motion.prior_std.asDiagonal() * motion.correlation * motion.prior_std.asDiagonal();
}

RestPull::RestPull(const FaceMotion& motion) : motion_(&motion) {
    constexpr double kOpposite = -.6;  // correlation of two motions of which one undoes the other
    const Eigen::MatrixXd overlaps = motion.modes * motion.modes.transpose();
    const Eigen::VectorXd energy = overlaps.diagonal().cwiseMax(1e-18);
    undone_.setZero(energy.size(), energy.size());
    for (Eigen::Index i = 0; i < motion.num_muscles; ++i) {
        for (Eigen::Index j = 0; j < motion.num_muscles; ++j) {
            if (overlaps(i, j) < kOpposite * std::sqrt(energy[i] * energy[j])) {
                undone_(i, j) = -overlaps(i, j) / energy[i];
            }
        }
    }
    constexpr double kTogether = .4;  // correlation from which on a value is as active as the other
    frees_.setIdentity(energy.size(), energy.size());
    if (motion.correlation.size() > 0) {
        frees_ = (motion.correlation / kTogether).cwiseMax(0).cwiseMin(1);
    }
}

Eigen::VectorXd RestPull::shown(const Eigen::VectorXd& values) const {
    return (values.cwiseAbs() - undone_ * values).cwiseMax(0);
}

RestPull::Terms RestPull::at(const Eigen::VectorXd& values, const Eigen::VectorXd& likely,
                             const Eigen::VectorXd& seen, const Eigen::VectorXd& std,
                             double dead_zone) const {
    constexpr double kFree = .4;       // of prior_std: lids come and go by themselves
    constexpr double kActive = .15;    // a value beyond which the pull to rest fades
    constexpr double kDoubtful = 1.1;  // of std: up to here a value may be none
    constexpr double kSmallest = .03;
    constexpr double kSurest = .03;  // of std
    const FaceMotion& motion = *motion_;
    const Eigen::Index count = values.size();
    Terms terms{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        if (motion.prior_std[i] > kFree) {
            continue;
        }
        // What moves frees what goes with it: the other side, else the sparsest answer is half a face, and
        // muscles that act together, else it is one of them, as chance has it.
        const double active = frees_.row(i).transpose().cwiseProduct(seen).maxCoeff();
        const double fade = 1 + std::pow(active / std::max(kActive, kDoubtful * std[i]), 4);
        const double strength = dead_zone / std::max(std[i], kSurest) / fade;
        if (motion.lower[i] >= 0) {
            terms.pull[i] = -strength;
        } else {
            // Two-sided: a quadratic with the same slope at the likely value
            terms.information[i] = strength / (std::abs(likely[i]) + kSmallest);
            terms.pull[i] = -terms.information[i] * values[i];
        }
    }
    return terms;
}

}  // namespace mimetic
