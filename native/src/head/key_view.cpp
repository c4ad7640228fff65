// SPDX-License-Identifier: GPL-3.0-or-later
#include "key_view.hpp"

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

namespace mimetic::head {
namespace {

constexpr float kOutOfSight = -1e6f;
constexpr float kContrast = 40;          // grey levels of a texture's standard deviation
constexpr int kLightWindow = 21;         // pixels over which light and contrast are constant
constexpr double kFlowPatch = 81;        // pixels that share one measurement of the flow
constexpr double kLeastVariance = 4e-3;  // pixels^2, added to a flow's variance

GrayView view_of(const cv::Mat1b& image) {
    return {image.data, image.rows, image.cols, static_cast<std::ptrdiff_t>(image.step)};
}

Eigen::Matrix2d covariance_at(const FlowField& flow, int y, int x) {
    const float* spread = flow.covariance_at(y, x);
    Eigen::Matrix2d covariance;
    covariance << spread[0] + kLeastVariance, spread[1], spread[1], spread[2] + kLeastVariance;
    return covariance;
}

/// Oblique skin has less detail and a larger effect of the model's error.
double slant_weight(float facing, double least_facing) {
    return (facing - least_facing) / (1 - least_facing);
}

FlowOptions flow_options(const HeadOptions& options) {
    FlowOptions flow;
    flow.method = options.flow_method;
    flow.judges_noise = false;  // textures of one contrast have no camera's noise
    return flow;
}

/// Correlation of each patch of a texture at the place that the flow gives, -1 to 1: low for occluders.
cv::Mat1f patch_correlation(const cv::Mat1f& from, const cv::Mat1f& to, const FlowField& flow) {
    cv::Mat2f places(from.size());
    for (int y = 0; y < from.rows; ++y) {
        for (int x = 0; x < from.cols; ++x) {
            const float* motion = flow.flow_at(y, x);
            places(y, x) = {static_cast<float>(x) + motion[0], static_cast<float>(y) + motion[1]};
        }
    }
    cv::Mat1f found;
    cv::remap(to, found, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    const auto patch_mean = [](const cv::Mat1f& values) {
        constexpr int kPatch = 9;
        cv::Mat1f mean;
        cv::boxFilter(values, mean, CV_32F, {kPatch, kPatch});
        return mean;
    };
    constexpr float kBare = 100;  // normalised grey squared that noise alone reaches
    cv::Mat1f spread;
    cv::sqrt((patch_mean(from.mul(from)) + kBare).mul(patch_mean(found.mul(found)) + kBare), spread);
    return (patch_mean(from.mul(found)) + kBare) / spread;
}

double spacing_weight(int spacing) { return std::min(1., spacing * spacing / kFlowPatch); }

}  // namespace

std::vector<PointMeasurement> measure_flow(const HeadShape& shape, const HeadOptions& options,
                                           const HeadCrop& before, const HeadCrop& now,
                                           const Eigen::Isometry3d& camera_from_head) {
    const FlowField flow = compute_flow(view_of(before.gray), view_of(now.gray), flow_options(options));
    const int spacing =
        std::min(options.sample_spacing, std::min(before.camera.width, before.camera.height) / 20);
    const SeenHead seen = see_head(shape, thin_camera(before.camera, spacing), camera_from_head);
    const Eigen::Vector3d eye = camera_from_head.inverse().translation();
    std::vector<PointMeasurement> measurements;
    for (int j = 0; j < seen.facing.rows; ++j) {
        for (int i = 0; i < seen.facing.cols; ++i) {
            if (seen.facing(j, i) < options.least_facing) {
                continue;
            }
            const int x = spacing / 2 + spacing * i, y = spacing / 2 + spacing * j;
            const float* motion = flow.flow_at(y, x);
            PointMeasurement m;
            const cv::Vec3f& point = seen.points(j, i);
            m.point = {point[0], point[1], point[2]};
            m.pixel = {double(x) + motion[0], double(y) + motion[1]};
            m.information = covariance_at(flow, y, x).inverse();
            m.weight = rigidity(shape, m.point) * slant_weight(seen.facing(j, i), options.least_facing) *
                       spacing_weight(spacing);
            m.depth_error = shape.depth_error * (m.point - eye).normalized();
            measurements.push_back(m);
        }
    }
    return measurements;
}

KeyView::KeyView(const HeadShape& shape, const HeadOptions& options, const HeadCrop& crop,
                 const Eigen::Isometry3d& camera_from_head, const Matrix6& covariance)
    : camera_from_head_(camera_from_head),
      covariance_(covariance),
      crop_(crop),
      least_facing_(options.least_facing) {
    move(shape, camera_from_head, covariance);
}

void KeyView::move(const HeadShape& shape, const Eigen::Isometry3d& camera_from_head,
                   const Matrix6& covariance) {
    camera_from_head_ = camera_from_head;
    covariance_ = covariance;
    seen_ = see_head(shape, crop_.camera, camera_from_head);
    const cv::Mat faces_camera = seen_.facing >= least_facing_;
    faces_camera.convertTo(mask_, CV_32F, 1. / 255);
    cv::Mat1f texture;
    crop_.gray.convertTo(texture, CV_32F);
    normalise(texture, mask_);
    texture_ = ReferenceTexture(texture);
}

void KeyView::normalise(cv::Mat1f& image, const cv::Mat1f& mask) const {
    const auto mean_of = [](const cv::Mat1f& values) {
        cv::Mat1f mean;
        cv::boxFilter(values, mean, CV_32F, {kLightWindow, kLightWindow});
        return mean;
    };
    const cv::Mat1f share = mean_of(mask) + 1e-3f;
    const cv::Mat1f mean = mean_of(image.mul(mask)) / share;
    image = (image - mean).mul(mask);
    const cv::Mat1f variance = mean_of(image.mul(image)) / share;
    constexpr float kNoise = 9;  // grey levels^2: bare skin is not made into texture
    cv::Mat1f spread;
    cv::sqrt(variance + kNoise, spread);
    image = kContrast * image / spread;
}

Stabilised KeyView::stabilise(const HeadCrop& now, const Eigen::Isometry3d& hypothesis) const {
    Stabilised result;
    result.map.create(mask_.size());
    cv::Mat1f seen = cv::Mat1f::zeros(mask_.size());
    const Eigen::Matrix3f turn = hypothesis.linear().cast<float>();
    const Eigen::Vector3f shift = hypothesis.translation().cast<float>();
    const auto fx = static_cast<float>(now.camera.fx), fy = static_cast<float>(now.camera.fy);
    const auto cx = static_cast<float>(now.camera.cx), cy = static_cast<float>(now.camera.cy);
    for (int y = 0; y < mask_.rows; ++y) {
        for (int x = 0; x < mask_.cols; ++x) {
            result.map(y, x) = {kOutOfSight, kOutOfSight};
            if (mask_(y, x) == 0) {
                continue;
            }
            const cv::Vec3f& p = seen_.points(y, x);
            const cv::Vec3f& n = seen_.normals(y, x);
            const Eigen::Vector3f point = turn * Eigen::Vector3f(p[0], p[1], p[2]) + shift;
            const float facing = -(turn * Eigen::Vector3f(n[0], n[1], n[2])).dot(point) / point.norm();
            const float u = fx * point.x() / point.z() + cx, v = fy * point.y() / point.z() + cy;
            if (point.z() > 0 && facing >= static_cast<float>(least_facing_) && u > 0 && v > 0 &&
                u < static_cast<float>(now.camera.width - 1) &&
                v < static_cast<float>(now.camera.height - 1)) {
                result.map(y, x) = {u, v};
                seen(y, x) = 1;
            }
        }
    }
    cv::Mat1b gray;
    cv::remap(now.gray, gray, result.map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    gray.convertTo(result.texture, CV_32F);
    normalise(result.texture, seen);
    const cv::Mat1f reference = texture_.values().mul(seen);
    const double both = std::sqrt(reference.dot(reference) * result.texture.dot(result.texture));
    result.correlation = both > 0 ? reference.dot(result.texture) / both : 0;
    result.in_sight = cv::sum(seen)[0] / std::max(1., cv::sum(mask_)[0]);
    return result;
}

cv::Mat1f KeyView::weights(const HeadShape& shape, const HeadOptions& options,
                           const Stabilised& stabilised) const {
    cv::Mat1f weights = cv::Mat1f::zeros(mask_.size());
    for (int y = 0; y < weights.rows; y += options.sample_spacing) {
        for (int x = 0; x < weights.cols; x += options.sample_spacing) {
            if (stabilised.map(y, x)[0] > 0) {
                weights(y, x) = static_cast<float>(rigidity(shape, to_eigen(seen_.points(y, x))) *
                                                   slant_weight(seen_.facing(y, x), options.least_facing));
            }
        }
    }
    return weights;
}

void KeyView::measure(const HeadShape& shape, const HeadOptions& options, const Stabilised& stabilised,
                      double share, std::vector<PointMeasurement>& measurements) const {
    cv::Mat1b from, to;
    texture_.values().convertTo(from, CV_8U, 1, 128);
    stabilised.texture.convertTo(to, CV_8U, 1, 128);
    const FlowField flow = compute_flow(view_of(from), view_of(to), flow_options(options));
    const cv::Mat1f correlation = patch_correlation(texture_.values(), stabilised.texture, flow);
    const Eigen::Vector3d eye = camera_from_head_.inverse().translation();
    constexpr int kReach = 2;
    const cv::Mat2f& map = stabilised.map;
    for (int y = kReach; y < map.rows - kReach; y += options.sample_spacing) {
        for (int x = kReach; x < map.cols - kReach; x += options.sample_spacing) {
            const cv::Vec2f left = map(y, x - kReach), right = map(y, x + kReach);
            const cv::Vec2f up = map(y - kReach, x), down = map(y + kReach, x), here = map(y, x);
            if (std::min({left[0], right[0], up[0], down[0], here[0]}) < 0) {
                continue;
            }
            Eigen::Matrix2d jacobian;
            jacobian << right[0] - left[0], down[0] - up[0], right[1] - left[1], down[1] - up[1];
            jacobian /= 2. * kReach;
            const float* motion = flow.flow_at(y, x);
            PointMeasurement m;
            m.point = to_eigen(seen_.points(y, x));
            m.pixel = Eigen::Vector2d(here[0], here[1]) + jacobian * Eigen::Vector2d(motion[0], motion[1]);
            const Eigen::Matrix2d covariance = jacobian * covariance_at(flow, y, x) * jacobian.transpose() +
                                               1e-6 * Eigen::Matrix2d::Identity();
            m.information = covariance.inverse();
            m.weight = share * rigidity(shape, m.point) * std::pow(std::max(0.F, correlation(y, x)), 4) *
                       slant_weight(seen_.facing(y, x), options.least_facing) *
                       spacing_weight(options.sample_spacing);
            m.depth_error = shape.depth_error * (m.point - eye).normalized();
            measurements.push_back(m);
        }
    }
}

}  // namespace mimetic::head
