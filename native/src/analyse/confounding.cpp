// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <cmath>
#include <mimetic/analyse/confounding.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/solve/stored_evidence.hpp>

namespace mimetic {
namespace {

constexpr int kPose = 6;
constexpr double kWidePose = 1;    // rad, metres: the pictures alone say where the head is
constexpr double kWideValue = .5;  // half of a muscle's range: what may be known without a picture
constexpr double kAtWork = .1;
constexpr double kUnsure = .1;     // deviations below matter to no one
constexpr double kInflation = 10;  // of a variance, by not knowing the other values [Marquardt 1970]

/// Covariance of the values (without the pose) of one frame by its pictures.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
    const Eigen::Index size = information.rows();
    Eigen::MatrixXd posterior = information;
    posterior.diagonal().head(kPose).array() += std::pow(kWidePose, -2);
    posterior.diagonal().tail(size - kPose).array() += std::pow(kWideValue, -2);
    return posterior.ldlt()
        .solve(Eigen::MatrixXd::Identity(size, size))
        .bottomRightCorner(size - kPose, size - kPose);
}

/// The value that goes with another most, up or down.
Eigen::Index partner_of(const Eigen::MatrixXd& covariance, Eigen::Index value) {
    Eigen::VectorXd shared =
        covariance.col(value).array().square() / covariance.diagonal().array();  // times 1 / its variance
    shared[value] = -1;
    Eigen::Index partner = 0;
    shared.maxCoeff(&partner);
    return partner;
}

}  // namespace

Rows<int, Eigen::Dynamic> confounded_values(MatrixIn activations, MatrixIn activations_std,
                                            const Eigen::Ref<const Rows<float, Eigen::Dynamic>>& evidence) {
    const Eigen::Index num_muscles = activations.cols();
    const int size = evidence_state_size(evidence.cols());
    require(evidence.rows() == activations.rows() && size > kPose + 1 && size >= kPose + num_muscles,
            "confounded_values: the evidence is not of these frames and muscles");
    require(activations_std.rows() == activations.rows() && activations_std.cols() == num_muscles,
            "confounded_values: one deviation for each activation is wanted");
    require(activations.allFinite() && activations_std.allFinite() && evidence.allFinite(),
            "confounded_values: activations, deviations or evidence are not finite");
    Rows<int, Eigen::Dynamic> confounded =
        Rows<int, Eigen::Dynamic>::Constant(activations.rows(), num_muscles, -1);
    for (Eigen::Index row = 0; row < activations.rows(); ++row) {
        const Eigen::Array<bool, 1, Eigen::Dynamic> is_unsure =
            (activations.row(row).array() >= kAtWork) && (activations_std.row(row).array() >= kUnsure);
        if (!is_unsure.any() || (evidence.row(row).array() == 0).all()) {
            continue;
        }
        const Eigen::MatrixXd covariance = covariance_of(stored_information(evidence.row(row), size));
        const Eigen::VectorXd known =
            covariance.ldlt().solve(Eigen::MatrixXd::Identity(size - kPose, size - kPose)).diagonal();
        for (Eigen::Index muscle = 0; muscle < num_muscles; ++muscle) {
            if (!is_unsure[muscle] || covariance(muscle, muscle) * known[muscle] < kInflation) {
                continue;
            }
            const Eigen::Index partner = partner_of(covariance, muscle);
            confounded(row, muscle) = static_cast<int>(partner);
            if (partner < num_muscles && confounded(row, partner) < 0) {
                confounded(row, partner) = static_cast<int>(muscle);
            }
        }
    }
    return confounded;
}

}  // namespace mimetic
