// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference_view.hpp"

#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

constexpr int kMargin = 8;           // crop pixels round the skin
constexpr float kMinimumSkin = .5f;  // vertex weight from which a pixel counts as skin
constexpr int kFlowWindow = 25;      // crop pixels: of 37, the same share of a face of 300, flow errs more
// Of the face's height: how alike two textures are must not hang on how fine they are
constexpr double kComparedWindow = .125;
constexpr double kNearest = .02;      // metres before the camera
constexpr double kRimWidth = 3.5e-3;  // metres to each side that a rim of glasses may cover
constexpr double kRimReach = 6e-3;    // and the flow's patches on it

struct Box {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
    Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);
};

Box box_of_measured(const FaceSurface& surface, const ProjectedSurface& projected) {
    Box box;
    for (Eigen::Index i = 0; i < projected.pixels.rows(); ++i) {
        if (surface.weights()[i] >= kMinimumSkin && projected.depths[i] > 0) {
            const Eigen::Vector2d pixel = projected.pixels.row(i).transpose().cast<double>();
            box.low = box.low.cwiseMin(pixel);
            box.high = box.high.cwiseMax(pixel);
        }
    }
    return box;
}

}  // namespace

void PreparedFrame::update(const cv::Mat1b& full, double wanted_scale) {
    // The pose of a face that is lost can be anything, also behind the camera
    const double least = static_cast<double>(kSmallestImage) / std::min(full.rows, full.cols);
    if (!(std::max(wanted_scale, least) <= .8)) {
        scale = 1;
        full.copyTo(gray);
        return;
    }
    scale = std::max(wanted_scale, least);
    cv::resize(full, gray, cv::Size(), scale, scale, cv::INTER_AREA);
}

LocalNormaliser::LocalNormaliser(const cv::Mat1b& mask, int window) : window_(window) {
    mask.convertTo(mask_, CV_32F, 1. / 255);
    cv::Mat1f count;
    cv::boxFilter(mask_, count, CV_32F, {window_, window_}, {-1, -1}, true, cv::BORDER_CONSTANT);
    inverse_count_ = 1 / (count + 1e-3f);
    // With a hard edge, the mask's own outline would be texture that never moves.
    cv::GaussianBlur(mask_, soft_mask_, {0, 0}, 2);
    soft_mask_ = (soft_mask_ - .5f) * 2;
    cv::max(soft_mask_, 0, soft_mask_);
}

void LocalNormaliser::apply(const cv::Mat1f& image, cv::Mat1f& values) {
    constexpr float kNoise = 5;  // grey levels: flat skin is not blown up to texture
    const auto mean_in_mask = [this](const cv::Mat1f& in, cv::Mat1f& out) {
        cv::boxFilter(in, out, CV_32F, {window_, window_}, {-1, -1}, true, cv::BORDER_CONSTANT);
        cv::multiply(out, inverse_count_, out);
    };
    cv::multiply(image, mask_, masked_);
    mean_in_mask(masked_, mean_);
    cv::multiply(masked_, masked_, squared_);
    mean_in_mask(squared_, variance_);
    values.create(image.size());
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const float mean = mean_(y, x);
            const float deviation = std::sqrt(std::max(0.f, variance_(y, x) - mean * mean));
            values(y, x) = soft_mask_(y, x) * kContrast * (image(y, x) - mean) / (deviation + kNoise);
        }
    }
}

ReferenceView::ReferenceView(const FaceSurface& surface, const Camera& camera, const FaceState& state,
                             const cv::Mat1b& gray, int crop_height, int spacing, double flow_blur)
    : camera_from_head_(state.camera_from_head) {
    ProjectedSurface projected;
    projected.update(surface, camera, state.camera_from_head, state.values);
    const Box box = box_of_measured(surface, projected);
    const Eigen::Vector2d size = box.high - box.low;
    if (!(size.minCoeff() >= 16) || size.maxCoeff() > 4 * std::max(camera.width, camera.height)) {
        throw InvalidInput(
            "the face's skin does not project into the reference image: it must be at least 16 pixels wide "
            "and "
            "high, in front of the camera; check the pose and the vertex weights");
    }
    scale_ = crop_height / size.y();
    origin_ = box.low - Eigen::Vector2d::Constant(kMargin / scale_);
    const int rows = crop_height + 2 * kMargin;
    const int cols = std::min(4 * crop_height, static_cast<int>(size.x() * scale_) + 2 * kMargin);
    Raster raster;
    raster_surface(projected, surface.triangles(), {origin_, scale_, rows, cols}, raster);

    triangle_ = cv::Mat1i(rows, cols, -1);
    barycentric_ = cv::Mat3f::zeros(rows, cols);
    mask_ = cv::Mat1b::zeros(rows, cols);
    const Eigen::Vector2f origin = origin_.cast<float>();
    const auto inverse_scale = static_cast<float>(1 / scale_);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < cols; ++x) {
            const int index = raster.face[raster.index(x, y)];
            if (index < 0) {
                continue;
            }
            TriangleCorners<float> corners;
            Eigen::Vector3f skin;
            for (int k = 0; k < 3; ++k) {
                const int vertex = surface.triangles()(index, k);
                corners[static_cast<std::size_t>(k)] = projected.pixels.row(vertex);
                skin[k] = surface.weights()[vertex];
            }
            const Eigen::Vector2f pixel = Eigen::Vector2f(x, y) * inverse_scale + origin;
            Eigen::Vector3f weights;
            const bool inside =
                pixel.minCoeff() >= 0 && pixel.x() < camera.width - 1 && pixel.y() < camera.height - 1;
            if (inside && barycentric_of(pixel, corners, weights) && weights.dot(skin) >= kMinimumSkin) {
                triangle_(y, x) = index;
                barycentric_(y, x) = {weights[0], weights[1], weights[2]};
                mask_(y, x) = 255;
            }
        }
    }
    const int compared_window = odd(kComparedWindow * crop_height);
    normaliser_ = std::make_unique<LocalNormaliser>(mask_, compared_window);
    has_finer_flow_texture_ = compared_window > kFlowWindow;
    if (compared_window != kFlowWindow || !surface.rims().empty()) {
        cv::Mat1b skin = mask_.clone();
        if (!surface.rims().empty()) {
            skin.setTo(0, rims_drawn(surface.rims(), camera, kRimWidth));
        }
        flow_normaliser_ = std::make_unique<LocalNormaliser>(skin, kFlowWindow);
    }
    PreparedFrame frame;
    frame.update(gray, scale_);
    cv::Mat2f map;
    cv::Mat1f texture;
    stabilise(surface.triangles(), projected, frame, map, texture);
    texture_ = ReferenceTexture(texture);
    if (flow_normaliser_) {
        normalise_for_flow(texture);
        flow_texture_ = ReferenceTexture(texture);
    }
    choose_samples(surface, projected, spacing, rims_drawn(surface.rims(), camera, kRimReach));
    blur_modes(flow_blur);
}

Eigen::Vector2f place_of(const ReferenceSample& sample, const Triangles& triangles,
                         const ProjectedSurface& projected) {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
    for (int corner = 0; corner < 3; ++corner) {
        pixel +=
            sample.barycentric[corner] * projected.pixels.row(triangles(sample.triangle, corner)).transpose();
    }
    return pixel;
}

cv::Mat1f ReferenceView::sample_weights(const std::vector<float>& visible) const {
    cv::Mat1f weights = cv::Mat1f::zeros(texture_.values().size());
    for (std::size_t k = 0; k < samples_.size(); ++k) {
        weights(samples_[k].y, samples_[k].x) = samples_[k].weight * std::max(0.f, visible[k]);
    }
    return weights;
}

void ReferenceView::keep_detail(const Eigen::VectorXd& coefficients) {
    const Eigen::VectorXf flat = coefficients.cast<float>();
    for (ReferenceSample& sample : samples_) {
        sample.offset = sample.skin.detail_modes * flat;
    }
}

void ReferenceView::stabilise(const Triangles& triangles, const ProjectedSurface& projected,
                              const PreparedFrame& frame, cv::Mat2f& map, cv::Mat1f& texture, bool for_flow) {
    map.create(triangle_.size());
    scaled_map_.create(triangle_.size());
    const auto scale = static_cast<float>(frame.scale);
    const float shift = (scale - 1) / 2;
    const auto fill_row = [&](int y) {
        for (int x = 0; x < map.cols; ++x) {
            const int index = triangle_(y, x);
            if (index < 0) {
                map(y, x) = {-1e6f, -1e6f};
                scaled_map_(y, x) = {-1, -1};
                continue;
            }
            const cv::Vec3f& weights = barycentric_(y, x);
            Eigen::RowVector2f pixel = Eigen::RowVector2f::Zero();
            for (int k = 0; k < 3; ++k) {
                pixel += weights[k] * projected.pixels.row(triangles(index, k));
            }
            map(y, x) = {pixel.x(), pixel.y()};
            scaled_map_(y, x) = {pixel.x() * scale + shift, pixel.y() * scale + shift};
        }
    };
    constexpr int kParts = 4;
    cv::parallel_for_(
        {0, map.rows},
        [&](const cv::Range& rows) {
            for (int y = rows.start; y < rows.end; ++y) {
                fill_row(y);
            }
        },
        kParts);
    cv::Mat1b fetched;
    cv::remap(frame.gray, fetched, scaled_map_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    fetched.convertTo(raw_, CV_32F);
    cv::GaussianBlur(raw_, raw_, {3, 3}, .7);
    if (for_flow) {
        normalise_for_flow(texture);
    } else {
        normaliser_->apply(raw_, texture);
    }
}

void ReferenceView::normalise_for_flow(cv::Mat1f& texture) {
    (flow_normaliser_ ? flow_normaliser_ : normaliser_)->apply(raw_, texture);
}

void ReferenceView::choose_samples(const FaceSurface& surface, const ProjectedSurface& projected, int spacing,
                                   const cv::Mat1b& rims) {
    cv::Mat1b inner;
    cv::erode(mask_, inner, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
    const Eigen::Vector3d eye = -(camera_from_head_.linear().transpose() * camera_from_head_.translation());
    for (int y = spacing / 2; y < mask_.rows; y += spacing) {
        for (int x = spacing / 2; x < mask_.cols; x += spacing) {
            if (inner(y, x) == 0) {
                continue;
            }
            ReferenceSample sample;
            sample.x = x;
            sample.y = y;
            sample.triangle = triangle_(y, x);
            const cv::Vec3f& weights = barycentric_(y, x);
            sample.barycentric = {weights[0], weights[1], weights[2]};
            const auto corner = [&](int k) -> Eigen::Vector3f {
                return projected.points_in_head.row(surface.triangles()(sample.triangle, k));
            };
            const Eigen::Vector3f normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
            const Eigen::Vector3f to_camera = (eye.cast<float>() - corner(0)).normalized();
            const float frontality = normal.dot(to_camera);
            constexpr float kGrazing = .25f;
            if (frontality < kGrazing) {
                continue;
            }
            sample.skin = surface.at(sample.triangle, sample.barycentric);
            sample.weight = std::min(1.f, (frontality - kGrazing) / .3f);
            sample.is_behind_rim = rims(y, x) != 0;
            samples_.push_back(std::move(sample));
        }
    }
}

cv::Mat1b ReferenceView::rims_drawn(const std::vector<Points>& rims, const Camera& camera,
                                    double reach) const {
    cv::Mat1b drawn = cv::Mat1b::zeros(mask_.size());
    constexpr int kShift = 4;  // bits of a pixel's fraction
    for (const Points& rim : rims) {
        std::vector<cv::Point> curve;
        double thickness = 1;
        for (Eigen::Index k = 0; k < rim.rows(); ++k) {
            const Eigen::Vector3d point = camera_from_head_ * rim.row(k).transpose();
            if (!(point.z() > kNearest)) {
                continue;
            }
            const Eigen::Vector2d at = (camera.project(point) - origin_) * scale_ * (1 << kShift);
            curve.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
            thickness = std::max(thickness, 2 * reach * camera.fx / point.z() * scale_);
        }
        cv::polylines(drawn, curve, false, 255, static_cast<int>(std::lround(thickness)), cv::LINE_8, kShift);
    }
    return drawn;
}

void ReferenceView::blur_modes(double flow_blur) {
    const double reach = 2.5 * flow_blur;
    for (ReferenceSample& sample : samples_) {
        sample.seen_modes = Eigen::Matrix3Xf::Zero(3, sample.skin.modes.cols());
        sample.seen_detail_modes = Eigen::Matrix3Xf::Zero(3, sample.skin.detail_modes.cols());
        float sum = 0;
        for (const ReferenceSample& other : samples_) {
            const double distance = std::hypot(other.x - sample.x, other.y - sample.y);
            if (distance <= reach) {
                const auto share = static_cast<float>(std::exp(-.5 * std::pow(distance / flow_blur, 2)));
                sample.seen_modes += share * other.skin.modes;
                sample.seen_detail_modes += share * other.skin.detail_modes;
                sum += share;
            }
        }
        sample.seen_modes /= sum;
        sample.seen_detail_modes /= sum;
    }
}

}  // namespace mimetic
