// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "joint_solver.hpp"

namespace mimetic {

/// The residual of the samples' displacements, as the most probable coefficients of the detail modes. It uses
/// the joint solver's robust weights, so outliers there count for nothing here.
class DetailSolver {
public:
    explicit DetailSolver(const FaceMotion& motion);

    /// From the residual of its displacements after `step`, the joint solver's last.
    DetailEstimate solve(const JointSolver& solver, const std::vector<SampleMeasurement>& measurements,
                         const Eigen::VectorXd& step);

private:
    Eigen::MatrixXd prior_;  // D squared, diagonal
    Eigen::MatrixXf rows_;   // D x 2K, whitened and weighted
    Eigen::MatrixXf sum_;
};

/// Coefficients over a clip from each frame's normal equations, once pose and values have moved by `steps`.
/// std_acceleration: of a coefficient's second difference, in its own prior standard deviations.
std::vector<DetailEstimate> smooth_detail(const std::vector<FrameEstimate>& estimates,
                                          const std::vector<Eigen::VectorXd>& steps, const FaceMotion& motion,
                                          double std_acceleration);

}  // namespace mimetic
