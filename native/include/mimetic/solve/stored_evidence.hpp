// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/solve.hpp>

namespace mimetic {

/// What the pictures say about an estimate's pose and values, in single precision, to be kept: the lower
/// triangle of its information by rows, then its gradient.
Eigen::VectorXf pack_evidence(const FrameEstimate& estimate);

/// Of pose and values, from the length of what is kept of their evidence; -1 where none has that length.
int evidence_state_size(Eigen::Index length);

/// The information (size x size, of pose, then values) that is kept in a frame's evidence.
Eigen::MatrixXd stored_information(const Eigen::VectorXf& evidence, Eigen::Index size);

/// An estimate from what is kept of it. Throws InvalidInput where the evidence is not of so many values.
FrameEstimate stored_estimate(const Eigen::Isometry3d& camera_from_head, const Matrix6& pose_covariance,
                              VectorIn values, VectorIn values_std, const Eigen::VectorXf& evidence,
                              double quality, bool is_held);

}  // namespace mimetic
