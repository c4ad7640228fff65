// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of the probabilistic flow: plain arrays, so that the compiler vectorises them.
#pragma once
#include <array>
#include <opencv2/core.hpp>

namespace mimetic::flow {

/// One value a pixel of its information about the flow, before the window: w gx gx, w gx gy, w gy gy,
/// w gx It, w gy It, w It It.
constexpr int kNumProducts = 6;
constexpr int kReach = 4;  ///< of the window, pixels to each side

/// What one level of the pyramid holds of the two images; all CV_32F.
struct Level {
    cv::Mat from;    ///< low-passed
    cv::Mat to;      ///< low-passed
    cv::Mat gx, gy;  ///< gradient of `from`, grey levels a pixel
    cv::Mat weight;  ///< 1 / (s1 |g|^2 + s2)
};

/// A flow with covariance as planes, CV_32F.
struct Belief {
    cv::Mat x, y, xx, xy, yy;
    std::array<cv::Mat*, 5> planes() { return {&x, &y, &xx, &xy, &yy}; }
    std::array<const cv::Mat*, 5> planes() const { return {&x, &y, &xx, &xy, &yy}; }
    void create(int rows, int cols);
};

/// Row `y` of `to` (rows x cols, contiguous) at the places a flow (`at_x`, `at_y`) leads to, less the row
/// `from` itself: `difference`. Where they leave the image `inside` is 0, else 1, and the difference means
/// nothing.
void warp_row(const float* to, int rows, int cols, int y, const float* at_x, const float* at_y,
              const float* from, float* difference, float* inside);

/// Products of row `y`, kNumProducts runs of `cols`, the second image warped by (`at_x`, `at_y`), linearised
/// about the prior mean. Pixels warped out of the image give zeros.
void form_products(const Level& level, const Belief& prior, const cv::Mat& at_x, const cv::Mat& at_y, int y,
                   float* products);

/// Gaussian window over 2 kReach + 1 rows of products and along the row; `scratch` holds cols + 2 kReach.
void sum_window(const float* const* rows, int cols, float* scratch, float* sums);

/// Posterior of row `y` from the windowed sums and the prior (science: L = [M + L'^-1]^-1, mu = mu' - L b).
void update_row(const float* sums, const Belief& prior, int y, Belief& posterior);

/// Twice the size: flow times 2, covariance times 4 plus `process_variance` on the diagonal.
void enlarge(const Belief& coarse, float process_variance, Belief& fine);

}  // namespace mimetic::flow
