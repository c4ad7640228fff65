// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/flow.hpp>
#include <opencv2/core.hpp>

namespace mimetic::flow {

// Mean squared normalised errors of the two raw covariances, over 2, on textured images with known warps and
// sensor noise: see tests/native/flow.
constexpr float kProbabilisticScale = 0.135f;
constexpr float kDisScale = 0.01f;

/// `initial`: CV_32FC2 or empty. The images are CV_8U of one size.
FlowField compute_probabilistic(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                                const cv::Mat& initial);
FlowField compute_dis(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                      const cv::Mat& initial);

}  // namespace mimetic::flow
