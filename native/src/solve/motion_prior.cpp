// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion_prior.hpp"

#include <Eigen/LU>

namespace mimetic {

Eigen::MatrixXd rest_covariance(const FaceMotion& motion) {
    constexpr double kTogether = .8;  // correlation of the two sides
    Eigen::MatrixXd covariance = motion.prior_std.cwiseAbs2().asDiagonal();
    for (Eigen::Index i = 0; i < motion.partner.size(); ++i) {
        const Eigen::Index other = motion.partner[i];
        if (other >= 0 && other != i) {
            covariance(i, other) = kTogether * motion.prior_std[i] * motion.prior_std[other];
        }
    }
    return covariance;
}

Eigen::MatrixXd rest_information(const FaceMotion& motion) {
    constexpr double kFramesPerState = 12;
    return rest_covariance(motion).inverse() / kFramesPerState;
}

Sparsity sparsity_at(const FaceMotion& motion, const Eigen::VectorXd& values, const Eigen::VectorXd& likely,
                     const Eigen::VectorXd& std, double dead_zone) {
    constexpr double kActive = .15;  // a value beyond which the pull to rest fades
    constexpr double kSmallest = .03;
    constexpr double kFree = .4;     // of prior_std: lids come and go by themselves
    constexpr double kSurest = .03;  // of std
    const Eigen::Index count = values.size();
    Sparsity sparsity{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        if (motion.prior_std[i] > kFree) {
            continue;
        }
        // One side that moves frees the other: else the sparsest answer is half a face.
        const Eigen::Index other = motion.partner.size() > 0 ? motion.partner[i] : -1;
        const double active = std::max(std::abs(likely[i]), other >= 0 ? std::abs(likely[other]) : 0);
        const double fade = 1 + std::pow(active / kActive, 4);
        const double strength = dead_zone / std::max(std[i], kSurest) / fade;
        if (motion.lower[i] >= 0) {
            sparsity.pull[i] = -strength;
        } else {
            // Two-sided: a quadratic with the same slope at the likely value
            sparsity.information[i] = strength / (std::abs(likely[i]) + kSmallest);
            sparsity.pull[i] = -sparsity.information[i] * values[i];
        }
    }
    return sparsity;
}

}  // namespace mimetic
