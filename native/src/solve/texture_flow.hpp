// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/flow/flow.hpp>
#include <opencv2/core.hpp>

#include "reference_view.hpp"

namespace mimetic {

/// The measurement of one sample of a reference texture in the present frame.
struct SampleMeasurement {
    const ReferenceSample* sample = nullptr;
    Eigen::Vector2d displacement;  ///< frame pixels from the hypothesis to where the texture is
    Eigen::Matrix2d covariance;    ///< of the flow, frame pixels squared, one independent sample
    float correlation = 0;         ///< of the patch once displaced, -1 to 1
    float texture = 0;             ///< contrast of the patch, 0 without texture to 1
    float weight = 1;              ///< texture seen head-on in both frames: 1
    double view_angle_sine = 0;    ///< of the turn since the texture was taken
};

/// Flow with covariance between a reference texture and the stabilised image, at the view's samples.
class TextureFlow {
public:
    explicit TextureFlow(FlowMethod method);
    /// map: as ReferenceView::stabilise gives it; visible: of each sample; first_guess: as in FlowOptions.
    /// Appends to `measurements`.
    void measure(const ReferenceView& view, const cv::Mat2f& map, const cv::Mat1f& texture,
                 const std::vector<float>& visible, double view_angle_sine, bool first_guess,
                 std::vector<SampleMeasurement>& measurements);

private:
    void compare_patches(const cv::Mat1f& reference, const cv::Mat1f& texture, const FlowField& flow);

    FlowOptions options_;
    cv::Mat1b from_, to_;
    cv::Mat2f lookup_;
    cv::Mat1f displaced_, correlation_, product_, aa_, bb_;
};

}  // namespace mimetic
