// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "flow/methods.hpp"

namespace mimetic::flow {
namespace {

constexpr int kWindow = 9;              // pixels, of the structure tensor and of the residual's variance
constexpr double kWindowSigma = 1.7;    // pixels
constexpr float kImageVariance = 4.0f;  // grey levels^2 of a sensor's noise
constexpr float kLoopScale = 0.5f;      // the error is shared by the two flows
constexpr float kSmallestTensor =
    1e-3f;  // grey levels^2 a pixel^2: a flat window has a large covariance, not infinite

cv::Mat run_dis(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options, const cv::Mat& initial) {
    const auto dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_FAST);
    // Skin moves by fractions of a pixel: the preset's last level, a quarter of the size, is too coarse. The
    // full size costs six times the half, from which OpenCV interpolates.
    dis->setFinestScale(options.finest_level + 1);
    if (options.first_guess) {
        constexpr int kFewRefinements = 1;  // they take most of the time
        dis->setVariationalRefinementIterations(kFewRefinements);
    }
    cv::Mat flow = initial.clone();
    dis->calc(from, to, flow);
    return flow;
}

cv::Mat blur(const cv::Mat& plane) {
    cv::Mat blurred;
    cv::GaussianBlur(plane, blurred, {kWindow, kWindow}, kWindowSigma);
    return blurred;
}

struct StructureTensor {
    cv::Mat xx, xy, yy;
};

StructureTensor tensor_of(const cv::Mat& image) {
    cv::Mat gx;
    cv::Mat gy;
    cv::Scharr(image, gx, CV_32F, 1, 0, 1.0 / 32);
    cv::Scharr(image, gy, CV_32F, 0, 1, 1.0 / 32);
    return {blur(gx.mul(gx)), blur(gx.mul(gy)), blur(gy.mul(gy))};
}

/// How far the grey levels that a flow joins are from one another.
cv::Mat variance_of(const cv::Mat& from, const cv::Mat& to, const cv::Mat& targets) {
    cv::Mat warped;
    cv::Mat residual;
    cv::remap(to, warped, targets, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::subtract(warped, from, residual, cv::noArray(), CV_32F);
    return blur(residual.mul(residual));
}

/// Second moments of how far a pixel lands from itself there and back, direction kept: along an edge it may
/// wander, across not.
std::array<cv::Mat, 3> loop_moments(const cv::Mat& forward, const cv::Mat& backward, const cv::Mat& targets) {
    cv::Mat returned;
    cv::remap(backward, returned, targets, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    const cv::Mat loop = forward + returned;
    std::array<cv::Mat, 2> loops;
    cv::split(loop, loops.data());
    return {blur(loops[0].mul(loops[0])), blur(loops[0].mul(loops[1])), blur(loops[1].mul(loops[1]))};
}

/// Without the forward-backward check.
std::array<cv::Mat, 3> no_moments(const cv::Size& size) {
    const cv::Mat none = cv::Mat::zeros(size, CV_32F);
    return {none, none, none};
}

}  // namespace

cv::Mat targets_of(const cv::Mat& flow) {
    cv::Mat targets(flow.size(), CV_32FC2);
    for (int y = 0; y < flow.rows; ++y) {
        const auto* from = flow.ptr<cv::Vec2f>(y);
        auto* to = targets.ptr<cv::Vec2f>(y);
        for (int x = 0; x < flow.cols; ++x) {
            to[x] = from[x] + cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
        }
    }
    return targets;
}

FlowField compute_dis(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                      const cv::Mat& initial) {
    cv::Mat forward;
    cv::Mat backward;
    cv::Mat targets;
    cv::Mat variance;
    StructureTensor tensor;
    // Small images leave DIS itself too little to share out between processors.
    const auto one_way = [&](const cv::Range& range) {
        for (int way = range.start; way < range.end; ++way) {
            if (way == 0) {
                forward = run_dis(from, to, options, initial);
                targets = targets_of(forward);
                variance = variance_of(from, to, targets);
            } else {
                tensor = tensor_of(from);
                if (!options.first_guess) {
                    backward = run_dis(to, from, options, initial.empty() ? initial : cv::Mat(-initial));
                }
            }
        }
    };
    cv::parallel_for_({0, 2}, one_way, 2);
    const auto [loop_xx, loop_xy, loop_yy] =
        options.first_guess ? no_moments(from.size()) : loop_moments(forward, backward, targets);

    FlowField field{from.rows, from.cols, {}, {}};
    field.flow.assign(forward.ptr<float>(), forward.ptr<float>() + 2 * forward.total());
    field.covariance.resize(3 * forward.total());
    cv::Mat covariance(from.rows, from.cols, CV_32FC3, field.covariance.data());
    for (int y = 0; y < from.rows; ++y) {
        auto* out = covariance.ptr<cv::Vec3f>(y);
        for (int x = 0; x < from.cols; ++x) {
            const float xx = tensor.xx.at<float>(y, x) + kSmallestTensor;
            const float yy = tensor.yy.at<float>(y, x) + kSmallestTensor;
            const float xy = tensor.xy.at<float>(y, x);
            const float noise = std::max(variance.at<float>(y, x), 2 * kImageVariance);
            const float scale = kDisScale * noise / (xx * yy - xy * xy);
            out[x] = {scale * yy + kLoopScale * loop_xx.at<float>(y, x),
                      -scale * xy + kLoopScale * loop_xy.at<float>(y, x),
                      scale * xx + kLoopScale * loop_yy.at<float>(y, x)};
        }
    }
    return field;
}

}  // namespace mimetic::flow
