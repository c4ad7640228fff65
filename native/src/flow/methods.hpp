// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/flow/flow.hpp>
#include <opencv2/core.hpp>

#include "flow/image_noise.hpp"

namespace mimetic::flow {

// Mean squared normalised errors of the two raw covariances, over 2, on textured images with known warps and
// sensor noise: see tests/native/flow.
constexpr float kProbabilisticScale = 0.135f;
constexpr float kDisScale = 0.01f;

// From rendered faces, as filmed and compressed once more, and from those textures under noise of 1 to 5 grey
// levels: `mimetic evaluate flow`. DIS errs by its smoothing too, which no noise changes.
constexpr NoiseResponse kProbabilisticNoise{0.133f, 1.0f, 7.0e-3f, 2.3f};
constexpr NoiseResponse kDisNoise{0.120f, 0.5f, 8.3e-4f, 2.6f};

/// `initial`: CV_32FC2 or empty. The images are CV_8U of one size.
FlowField compute_probabilistic(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                                const cv::Mat& initial);
FlowField compute_dis(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                      const cv::Mat& initial);

/// Absolute pixel positions that a flow leads to; both CV_32FC2.
cv::Mat targets_of(const cv::Mat& flow);

}  // namespace mimetic::flow
