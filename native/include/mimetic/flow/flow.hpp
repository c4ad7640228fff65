// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic {

enum class FlowMethod {
    probabilistic,  ///< Simoncelli, Adelson and Heeger's multi-scale Bayesian flow (1991), as in the paper
    dis,            ///< dense inverse search (Kroeger 2016), OpenCV's, with a covariance of our own
};

struct FlowOptions {  // defaults suit faces at 320x240 to 1280x720, 8-bit
    FlowMethod method = FlowMethod::probabilistic;
    int num_levels = 0;    ///< pyramid levels; 0: until the coarsest side is near 12 pixels
    int finest_level = 0;  ///< stop at 1/2^finest_level of the size, then interpolate: faster, blurred
    int iterations = 2;    ///< warps a level, one less at full size
    double gradient_noise = 0.005;   ///< s1: variance of the velocity's constancy in the window, px^2
    double temporal_noise = 1.0;     ///< s2: variance of the smoothed temporal derivative, grey levels^2
    double prior_variance = 2.0;     ///< of the flow at the coarsest level about its start, its pixels^2
    double process_variance = 0.03;  ///< of the flow from one level to the next finer, its pixels^2
    bool judges_noise = true;        ///< estimated from the warped images' residual; false: temporal_noise
    bool first_guess = false;        ///< dis: in a third of the time, no forward-backward check, less refined
    void check() const;              ///< throws InvalidInput: field, value, limit
};

/// Positions of one image's pixels in another, x + flow(x), with a covariance each.
struct FlowField {
    int rows = 0;
    int cols = 0;
    std::vector<float> flow;        ///< rows x cols x 2: x right, y down, pixels
    std::vector<float> covariance;  ///< rows x cols x 3: xx, xy, yy, pixels^2

    const float* flow_at(int y, int x) const { return flow.data() + 2 * (y * std::ptrdiff_t{cols} + x); }
    const float* covariance_at(int y, int x) const {
        return covariance.data() + 3 * (y * std::ptrdiff_t{cols} + x);
    }
};

/// Flow of every pixel of `from` to `to`, images of one size. `initial`, a flow of the same size (the motion
/// that a model predicts), is where the search starts. Throws InvalidInput on images that do not match.
FlowField compute_flow(const GrayView& from, const GrayView& to, const FlowOptions& options = {},
                       const FlowField* initial = nullptr);

/// A flow is the motion blurred, by about a Gaussian of this standard deviation, pixels: a bump of s.d. s
/// keeps s^2 / (s^2 + blur^2) of its height. Measured on faces; the tests measure it on noise.
double flow_blur_px(FlowMethod method);

}  // namespace mimetic
