// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// How several muscles rise and fall together by the pictures alone, frame by frame: without the smoother,
/// and without the prior by which it takes most muscles to be at rest. That prior cuts the foot of an
/// application, which looks like a later onset with another exponent.
class MeasuredCourses {
public:
    /// activations: N x P, as captured; evidence: N x E, as `pack_evidence` has it, of P muscles and then of
    /// further values. Throws InvalidInput on other shapes or what is not finite.
    MeasuredCourses(MatrixIn activations, const Eigen::Ref<const Rows<float, Eigen::Dynamic>>& evidence);

    int num_frames() const { return static_cast<int>(activations_.rows()); }
    int num_muscles() const { return static_cast<int>(activations_.cols()); }

    /// The members' mean in rows first to last, if they keep the proportions that they have about row `top`:
    /// least squares of the pictures, pose free, all other values near what was captured. Frames without
    /// evidence have the captured mean. members: P, 1 for those of the mean, 0 for others.
    Eigen::VectorXd course(VectorIn members, int first, int last, int top) const;

private:
    double measured_mean(const Eigen::VectorXd& pattern, const std::vector<int>& others, int row) const;
    MatrixRows activations_;
    Rows<float, Eigen::Dynamic> evidence_;
    int size_ = 0;  // of pose and values
};

}  // namespace mimetic
