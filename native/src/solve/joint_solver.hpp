// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unordered_map>

#include "depth_error.hpp"
#include "error_field.hpp"
#include "face_state.hpp"
#include "shared/robust.hpp"
#include "texture_flow.hpp"

namespace mimetic {

/// A Gaussian prior of a step: information and right-hand side at step 0.
struct StepPrior {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
};

/// Error of the measurements at the true state.
struct NoiseModel {
    ModelError model;               ///< a smooth field over the skin; of TrackerOptions
    double fine_error = 4e-4;       ///< metres; independent for each flow window
    double robust_cut = kTukeyCut;  ///< standard deviations
    double samples_a_window = 10;   ///< neighbours share their flow's window and count as one
};

/// Robust whitened normal equations of all samples for one joint step of pose and values. The modes' own
/// error is a smooth random field over the skin, estimated with the step and subtracted from the samples'
/// displacements.
class JointSolver {
public:
    JointSolver(const FaceMotion& motion, ErrorField<float> field);

    /// Linearises at `state`; the measurements must outlive the solver's next calls.
    void linearise(const Camera& camera, const FaceState& state,
                   const std::vector<SampleMeasurement>& measurements, const NoiseModel& noise);
    /// Adds other evidence of a step from the linearisation point; until the next linearise.
    void add(StepPrior evidence) { evidence_ = std::move(evidence); }
    /// Errors with which values are read; until the next linearise.
    void allow(std::vector<ReadingError> errors) { reading_errors_ = std::move(errors); }
    /// Bounded most probable step; num_free < 6 + M keeps the last values as they are (6: pose alone). Starts
    /// from the error field of the last call.
    Eigen::VectorXd solve(const StepPrior& prior, const FaceState& state, Eigen::Index num_free,
                          int num_rounds);

    const Eigen::MatrixXd& information() const { return information_; }
    const Eigen::VectorXd& pull() const { return pull_; }  ///< at step 0
    /// The same where reading errors count as movements of their values
    const StepPrior& as_read() const { return as_read_; }
    const std::vector<float>& robust_weights() const { return robust_weights_; }
    /// Of the last linearisation and weighting: sample k's square root of weighted information, d frame pixel
    /// / d head frame; whitened and weighted Jacobians and displacements.
    Eigen::Matrix2f whitener(std::size_t k) const { return std::sqrt(weights_[k]) * whiteners_[k]; }
    const Eigen::Matrix<float, 2, 3>& projection(std::size_t k) const { return projections_[k]; }
    const Eigen::MatrixXf& rows() const { return rows_; }
    const Eigen::VectorXf& targets() const { return targets_; }
    const std::vector<double>& distances_px() const { return distances_px_; }

private:
    using NearNode = ErrorField<float>::NearNode;

    /// Of some samples, towards the normal equations of step and error field.
    struct Sums {
        Eigen::MatrixXf information, field_coupling;
        Eigen::VectorXf pull;
        Eigen::MatrixXf field_information;
        Eigen::VectorXf field_pull;
    };

    void find_near_nodes();
    void reweight(const Eigen::VectorXd& step, double robust_cut);
    void sum_up(const std::vector<Sums>& parts);
    void allow_for(const ReadingError& error);
    Eigen::VectorXd read_step(const Eigen::VectorXd& step) const;
    Sums sums_of(std::size_t begin, std::size_t end) const;
    Eigen::VectorXd bounded(const StepPrior& prior, const FaceState& state, Eigen::Index num_free) const;

    const FaceMotion& motion_;
    ErrorField<float> error_field_;
    const std::vector<SampleMeasurement>* measurements_ = nullptr;
    NoiseModel noise_;
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobians_;  // 2K x n
    Eigen::VectorXf displacements_, targets_;
    Eigen::MatrixXf rows_;                    // n x 2K, whitened and weighted
    std::vector<Eigen::Matrix2f> whiteners_;  // of each sample for itself
    std::vector<Eigen::Matrix<float, 2, 3>> projections_;
    std::vector<Eigen::Matrix2f> field_pixels_;  // frame pixels a unit of the field, head x and y
    std::unordered_map<const ReferenceSample*, std::vector<NearNode>> near_of_;  // a sample keeps its own
    std::vector<const std::vector<NearNode>*> near_;
    std::vector<float> robust_weights_, weights_;
    std::vector<double> distances_px_;
    // The field's normal equations: two coefficients a node, of unit variance
    Eigen::MatrixXf field_coupling_;  // 2N x n
    Eigen::VectorXf field_pull_, field_;
    Eigen::LLT<Eigen::MatrixXf> field_factor_;
    StepPrior evidence_, as_read_;
    std::vector<ReadingError> reading_errors_;
    Eigen::MatrixXd information_;
    Eigen::VectorXd pull_;
};

}  // namespace mimetic
