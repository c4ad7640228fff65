// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "joint_solver.hpp"

namespace mimetic {

/// Normal equations of the detail's coefficients: information * detail = pull - coupling * step.
struct DetailTerms {
    DetailTerms(Eigen::Index num_detail, Eigen::Index num_unknowns)
        : information(Eigen::MatrixXd::Zero(num_detail, num_detail)),
          coupling(Eigen::MatrixXd::Zero(num_detail, num_unknowns)),
          pull(Eigen::VectorXd::Zero(num_detail)) {}

    Eigen::MatrixXd information;  ///< D squared
    Eigen::MatrixXd coupling;     ///< D x (6 + M)
    Eigen::VectorXd pull;         ///< D
};

/// The residual of the samples' displacements, as the most probable coefficients of the detail modes. It uses
/// the joint solver's robust weights, so outliers there count for nothing here.
class DetailSolver {
public:
    explicit DetailSolver(const FaceMotion& motion);

    /// From the residual of its displacements after `step`, the joint solver's last, and from other evidence
    /// at the state after it.
    DetailEstimate solve(const JointSolver& solver, const std::vector<SampleMeasurement>& measurements,
                         const Eigen::VectorXd& step, const DetailTerms& other);

private:
    struct Sums {
        Eigen::MatrixXf information, coupling;
        Eigen::VectorXf pull;
    };

    Eigen::MatrixXd prior_;  // D squared, diagonal
    Eigen::MatrixXf rows_;   // D x 2K, whitened and weighted
};

/// Coefficients over a clip from each frame's normal equations, once pose and values have moved by `steps`.
/// std_acceleration: of a coefficient's second difference, in its own prior standard deviations.
std::vector<DetailEstimate> smooth_detail(const std::vector<FrameEstimate>& estimates,
                                          const std::vector<Eigen::VectorXd>& steps, const FaceMotion& motion,
                                          double std_acceleration);

}  // namespace mimetic
