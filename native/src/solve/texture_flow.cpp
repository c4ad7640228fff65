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
    const cv::Vec2f left = map(y, x - kReach), right = map(y, x + kReach);
    const cv::Vec2f up = map(y - kReach, x), down = map(y + kReach, x);
    if (std::min({left[0], right[0], up[0], down[0]}) < -1e5f) {
        return false;
    }
    const cv::Vec2f across = (right - left) / (2.f * kReach);
    const cv::Vec2f along = (down - up) / (2.f * kReach);
    jacobian << across[0], along[0], across[1], along[1];
    return true;
}

}  // namespace

TextureFlow::TextureFlow() : dis_(cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_FAST)) {
    dis_->setFinestScale(1);
    dis_->setUseSpatialPropagation(true);
}

void TextureFlow::compare_patches(const cv::Mat1f& reference, const cv::Mat1f& texture) {
    lookup_.create(flow_.size());
    for (int y = 0; y < flow_.rows; ++y) {
        for (int x = 0; x < flow_.cols; ++x) {
            lookup_(y, x) = flow_(y, x) + cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
        }
    }
    cv::remap(texture, displaced_, lookup_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::multiply(reference, displaced_, product_);
    box_mean(product_, correlation_);
    cv::multiply(reference, reference, product_);
    box_mean(product_, aa_);
    cv::multiply(displaced_, displaced_, product_);
    box_mean(product_, bb_);
    residual_ = aa_ + bb_ - 2 * correlation_;
    // The contrast floor keeps patches that show nothing from counting as lost.
    constexpr float kFloor = 150;
    for (int y = 0; y < flow_.rows; ++y) {
        for (int x = 0; x < flow_.cols; ++x) {
            correlation_(y, x) =
                (correlation_(y, x) + kFloor) / std::sqrt((aa_(y, x) + kFloor) * (bb_(y, x) + kFloor));
        }
    }
    cv::Sobel(reference, dx_, CV_32F, 1, 0, 3, 1. / 8);
    cv::Sobel(reference, dy_, CV_32F, 0, 1, 3, 1. / 8);
    cv::multiply(dx_, dx_, product_);
    box_mean(product_, gxx_);
    cv::multiply(dx_, dy_, product_);
    box_mean(product_, gxy_);
    cv::multiply(dy_, dy_, product_);
    box_mean(product_, gyy_);
}

void TextureFlow::measure(const ReferenceView& view, const cv::Mat2f& map, const cv::Mat1f& texture,
                          const std::vector<float>& visible, double view_angle_sine,
                          std::vector<SampleMeasurement>& measurements) {
    view.texture().convertTo(from_, CV_8U, 1, 128);
    texture.convertTo(to_, CV_8U, 1, 128);
    flow_.create(from_.size());
    dis_->calc(from_, to_, flow_);
    compare_patches(view.texture(), texture);
    constexpr double kResidualFloor = 20;  // normalised grey squared: noise that the flow has fitted away
    constexpr float kBare = 300;           // normalised grey squared that noise alone reaches
    constexpr double kFlat = 3;            // gradient energy under which nothing is seen
    for (std::size_t k = 0; k < view.samples().size(); ++k) {
        const ReferenceSample& sample = view.samples()[k];
        Eigen::Matrix2d jacobian;
        if (visible[k] <= 0 || !map_jacobian(map, sample.x, sample.y, jacobian)) {
            continue;
        }
        const cv::Vec2f flow = flow_(sample.y, sample.x);
        Eigen::Matrix2d tensor;
        tensor << gxx_(sample.y, sample.x) + kFlat, gxy_(sample.y, sample.x), gxy_(sample.y, sample.x),
            gyy_(sample.y, sample.x) + kFlat;
        const double noise = std::max<double>(residual_(sample.y, sample.x), kResidualFloor);
        const Eigen::Matrix2d covariance = noise / (kPatch * kPatch) * tensor.inverse();
        SampleMeasurement measurement;
        measurement.sample = &sample;
        measurement.displacement = jacobian * Eigen::Vector2d(flow[0], flow[1]);
        measurement.covariance = jacobian * covariance * jacobian.transpose();
        measurement.correlation = correlation_(sample.y, sample.x);
        measurement.weight = sample.weight * visible[k];
        measurement.texture = aa_(sample.y, sample.x) / (aa_(sample.y, sample.x) + kBare);
        measurement.view_angle_sine = view_angle_sine;
        measurements.push_back(measurement);
    }
}

}  // namespace mimetic
