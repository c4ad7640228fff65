// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Muscles that the pictures cannot tell apart, frame by frame.
///
/// A muscle at work is confounded where its variance is at least ten times what it would be if all other
/// values were known (the variance inflation factor; ten is the usual limit), and its deviation a tenth of
/// its range: another value that rises or falls with it leaves the picture nearly the same. That value, of
/// the largest correlation, is told; if it is a muscle, too, it is confounded with the first one, at work
/// or not.
///
/// activations, activations_std: N x P, as captured; evidence: N x E, as `pack_evidence` has it, of P
/// muscles and then of further values. Returns N x P: the value's index, muscles first, or -1. Frames
/// without evidence have -1. Throws InvalidInput on other shapes or what is not finite.
Rows<int, Eigen::Dynamic> confounded_values(MatrixIn activations, MatrixIn activations_std,
                                            const Eigen::Ref<const Rows<float, Eigen::Dynamic>>& evidence);

}  // namespace mimetic
