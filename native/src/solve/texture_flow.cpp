// SPDX-License-Identifier: GPL-3.0-or-later
#include "texture_flow.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

constexpr int kPatch = 11;  // reference pixels

void box_mean(const cv::Mat1f& in, cv::Mat1f& out) {
    cv::boxFilter(in, out, CV_32F, {kPatch, kPatch}, {-1, -1}, true, cv::BORDER_CONSTANT);
}

/// d frame pixel / d crop pixel, from the map's neighbours; false at the skin's edge.
bool map_jacobian(const cv::Mat2f& map, int x, int y, Eigen::Matrix2d& jacobian) {
    constexpr int kReach = 2;
    if (x < kReach || y < kReach || x >= map.cols - kReach || y >= map.rows - kReach) {
        return false;
    }
    const cv::Vec2f &left = map(y, x - kReach), &right = map(y, x + kReach);
    const cv::Vec2f &up = map(y - kReach, x), &down = map(y + kReach, x);
    if (std::min({left[0], right[0], up[0], down[0]}) < -1e5f) {
        return false;
    }
    const cv::Vec2f across = (right - left) / (2.f * kReach);
    const cv::Vec2f along = (down - up) / (2.f * kReach);
    jacobian << across[0], along[0], across[1], along[1];
    return true;
}

}  // namespace

TextureFlow::TextureFlow(FlowMethod method) { options_.method = method; }

void TextureFlow::compare_patches(const cv::Mat1f& reference, const cv::Mat1f& texture,
                                  const FlowField& flow) {
    lookup_.create(texture.size());
    for (int y = 0; y < texture.rows; ++y) {
        for (int x = 0; x < texture.cols; ++x) {
            const float* motion = flow.flow_at(y, x);
            lookup_(y, x) = {static_cast<float>(x) + motion[0], static_cast<float>(y) + motion[1]};
        }
    }
    cv::remap(texture, displaced_, lookup_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::multiply(reference, displaced_, product_);
    box_mean(product_, correlation_);
    cv::multiply(reference, reference, product_);
    box_mean(product_, aa_);
    cv::multiply(displaced_, displaced_, product_);
    box_mean(product_, bb_);
    // The contrast floor keeps patches without texture from counting as outliers.
    constexpr float kFloor = 150;
    for (int y = 0; y < texture.rows; ++y) {
        for (int x = 0; x < texture.cols; ++x) {
            correlation_(y, x) =
                (correlation_(y, x) + kFloor) / std::sqrt((aa_(y, x) + kFloor) * (bb_(y, x) + kFloor));
        }
    }
    // An occluder corrupts the flow a little beyond its edge.
    constexpr int kSpoiled = 7;
    cv::erode(correlation_, correlation_, cv::getStructuringElement(cv::MORPH_RECT, {kSpoiled, kSpoiled}));
}

void TextureFlow::measure(const ReferenceView& view, const cv::Mat2f& map, const cv::Mat1f& texture,
                          const std::vector<float>& visible, double view_angle_sine, bool first_guess,
                          std::vector<SampleMeasurement>& measurements) {
    options_.first_guess = first_guess;
    view.flow_texture().values().convertTo(from_, CV_8U, 1, 128);
    texture.convertTo(to_, CV_8U, 1, 128);
    const FlowField flow =
        compute_flow({from_.data, from_.rows, from_.cols, static_cast<std::ptrdiff_t>(from_.step)},
                     {to_.data, to_.rows, to_.cols, static_cast<std::ptrdiff_t>(to_.step)}, options_);
    compare_patches(view.flow_texture().values(), texture, flow);
    constexpr float kBare = 300;  // normalised grey squared that noise alone reaches
    for (std::size_t k = 0; k < view.samples().size(); ++k) {
        const ReferenceSample& sample = view.samples()[k];
        Eigen::Matrix2d jacobian;
        if (visible[k] <= 0 || !map_jacobian(map, sample.x, sample.y, jacobian)) {
            continue;
        }
        const float* motion = flow.flow_at(sample.y, sample.x);
        const float* spread = flow.covariance_at(sample.y, sample.x);
        Eigen::Matrix2d covariance;
        covariance << spread[0], spread[1], spread[1], spread[2];
        SampleMeasurement measurement;
        measurement.sample = &sample;
        measurement.displacement = jacobian * Eigen::Vector2d(motion[0], motion[1]);
        measurement.covariance = jacobian * covariance * jacobian.transpose();
        measurement.correlation = correlation_(sample.y, sample.x);
        measurement.weight = sample.weight * visible[k];
        measurement.texture = aa_(sample.y, sample.x) / (aa_(sample.y, sample.x) + kBare);
        measurement.view_angle_sine = view_angle_sine;
        measurements.push_back(measurement);
    }
}

}  // namespace mimetic
