// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/flow/flow.hpp>
#include <opencv2/core.hpp>

namespace mimetic::flow {

/// Error of a method where two images differ by noise; measured on rendered faces, compressed and not.
struct NoiseResponse {
    float scale;     ///< of the covariance, at a variance of 1 grey level^2
    float exponent;  ///< with which it grows with the variance: 1 where noise is all that errs
    float floor;     ///< pixels^2 that noise of one colour adds, for each unit of `color` over `white`
    float white;     ///< `color` of a sensor's noise as the method leaves it
};

/// Scales a covariance that assumes uniform noise to the noise of these two images.
///
/// The noise is estimated from the residual between them: its power at the wave lengths of skin, from place
/// to place, and for the whole image the `color`, by how much that outweighs the power from pixel to pixel. A
/// sensor's noise is white and averages out within a window; a codec takes the fine part away and leaves
/// errors as wide as the window, the codec's own displacements among them, and those show in no difference of
/// the images.
void own_up_to_noise(const cv::Mat& from, const cv::Mat& to, const NoiseResponse& response, FlowField& field);

}  // namespace mimetic::flow
