// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "texture_flow.hpp"

namespace mimetic {

/// Pose and values under estimate.
struct FaceState {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    Eigen::VectorXd values;

    void apply(const Eigen::VectorXd& step);  ///< exp(rotation) R, t + translation, values + d
    Eigen::VectorXd difference_from(const FaceState& other) const;  ///< step that leads from other to this
};

/// d frame pixel / d (rotation vector, translation, values) of a skin point, 2 x (6 + M).
void skin_jacobian(const Camera& camera, const FaceState& state, const SkinPoint& skin,
                   Eigen::Matrix<float, 2, Eigen::Dynamic>& jacobian, Eigen::Matrix<double, 2, 3>& by_point);

/// What a Gaussian prior says of a step: information and pull at step 0.
struct StepPrior {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
};

struct NoiseModel {
    double model_error = 1e-3;         ///< metres
    double shape_error = 4e-3;         ///< metres of depth, seen as the view turns
    double correlation_length = .012;  ///< metres over the skin
    double robust_cut = 4.7;           ///< Tukey, in standard deviations
};

/// Robust whitened normal equations of all samples for one joint step of pose and values.
class JointSolver {
public:
    JointSolver(const FaceMotion& motion, std::vector<Eigen::Vector3f> error_nodes);

    /// Linearises at `state`; the measurements must outlive the solver's next calls.
    void linearise(const Camera& camera, const FaceState& state,
                   const std::vector<SampleMeasurement>& measurements, const NoiseModel& noise,
                   double area_per_sample);
    /// Weights every sample by its distance from the step and sums up.
    void reweight(const Eigen::VectorXd& step);
    /// Bounded most probable step; num_free < 6 + M keeps the last values as they are (6: pose alone).
    Eigen::VectorXd step(const StepPrior& prior, const FaceState& state, Eigen::Index num_free) const;
    /// Model error's part of the covariance, for the working posterior covariance.
    Eigen::MatrixXd model_covariance(const Eigen::MatrixXd& working) const;

    const Eigen::MatrixXd& information() const { return information_; }
    const Eigen::VectorXd& pull() const { return pull_; }  ///< at step 0
    const std::vector<float>& robust_weights() const { return robust_weights_; }
    std::vector<double>& distances_px() { return distances_px_; }

private:
    const FaceMotion& motion_;
    std::vector<Eigen::Vector3f> error_nodes_;
    const std::vector<SampleMeasurement>* measurements_ = nullptr;
    NoiseModel noise_;
    Eigen::Matrix3f rotation_;
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobians_;  // 2K x n
    Eigen::MatrixXf rows_;                                                             // whitened
    Eigen::VectorXf displacements_, targets_;
    std::vector<Eigen::Matrix2f> working_whiteners_, robust_whiteners_;
    std::vector<Eigen::Matrix<float, 2, 3>> by_point_;
    std::vector<double> error_std_;  // metres
    std::vector<float> robust_weights_;
    std::vector<double> distances_px_;
    Eigen::MatrixXd information_;
    Eigen::VectorXd pull_;
    Eigen::MatrixXf sum_;
};

}  // namespace mimetic
