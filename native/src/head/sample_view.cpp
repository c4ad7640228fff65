// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample_view.hpp"

#include <mimetic/shared/rotations.hpp>
#include <opencv2/imgproc.hpp>

namespace mimetic::head {
namespace {

constexpr int kBorder = 2;        // pixels
constexpr int kPatchesAlong = 9;  // of a head's height, that move or are occluded as one

constexpr float kNoise = .2F;  // of a value
constexpr float kOff = .5F;    // pixels: error of the model's reprojection

/// A candidate pixel of a level for a sample.
struct Place {
    int x, y;
    Eigen::Vector2f gradient;
};

Eigen::Vector2f gradient_at(const cv::Mat1f& image, int x, int y) {
    return {.5F * (image(y, x + 1) - image(y, x - 1)), .5F * (image(y + 1, x) - image(y - 1, x))};
}

/// The pixel of each block of skin whose gradient is steepest.
std::vector<Place> choose_places(const cv::Mat1f& image, const cv::Mat1f& inside, int spacing) {
    std::vector<Place> places;
    for (int top = kBorder; top + spacing + kBorder <= image.rows; top += spacing) {
        for (int left = kBorder; left + spacing + kBorder <= image.cols; left += spacing) {
            std::optional<Place> best;
            for (int y = top; y < top + spacing; ++y) {
                for (int x = left; x < left + spacing; ++x) {
                    if (inside(y, x) == 0) {
                        continue;
                    }
                    const Eigen::Vector2f gradient = gradient_at(image, x, y);
                    if (!best || gradient.squaredNorm() > best->gradient.squaredNorm()) {
                        best = Place{x, y, gradient};
                    }
                }
            }
            if (best) {
                places.push_back(*best);
            }
        }
    }
    return places;
}

Eigen::Vector3d to_eigen(const cv::Vec3f& v) { return {v[0], v[1], v[2]}; }

Samples make_samples(const HeadShape& shape, const HeadOptions& options, const PyramidLevel& level,
                     std::size_t index, const Eigen::Isometry3d& camera_from_head) {
    const int spacing = sample_spacing(options, index);
    const SeenHead seen = see_head(shape, level.camera, camera_from_head);
    const cv::Mat faces_camera = seen.facing >= options.least_facing;
    cv::Mat1f mask;
    faces_camera.convertTo(mask, CV_32F, 1. / 255);
    const cv::Mat1f image = normalised(level.gray, mask, index);
    cv::Mat1f inside;  // whose gradient is the head's own
    cv::erode(mask, inside, cv::Mat());
    const auto places = choose_places(image, inside, spacing);
    const auto num = static_cast<Eigen::Index>(places.size());
    const int patch = std::max(3, level.camera.height / kPatchesAlong);
    const int patches_across = level.camera.width / patch + 1;
    Samples made{PointRows(3, num),
                 PointRows(3, num),
                 Eigen::VectorXf(num),
                 Eigen::VectorXf(num),
                 Eigen::VectorXf(num),
                 Eigen::Matrix<float, 2, Eigen::Dynamic>(2, num),
                 Eigen::Matrix<float, 6, Eigen::Dynamic>(6, num),
                 PointRows(3, num),
                 {},
                 patches_across * (level.camera.height / patch + 1)};
    const Eigen::Vector3d eye = camera_from_head.inverse().translation();
    for (Eigen::Index k = 0; k < num; ++k) {
        const auto& [x, y, gradient] = places[static_cast<std::size_t>(k)];
        const Eigen::Vector3d point = to_eigen(seen.points(y, x));
        const double slant = (seen.facing(y, x) - options.least_facing) / (1 - options.least_facing);
        Eigen::Matrix<double, 3, 6> moved;
        moved << -cross_matrix(point), Eigen::Matrix3d::Identity();
        made.points.col(k) = point.cast<float>();
        made.normals.col(k) = to_eigen(seen.normals(y, x)).cast<float>();
        made.values[k] = image(y, x);
        made.spread[k] = std::sqrt(kNoise * kNoise + kOff * kOff * gradient.squaredNorm());
        made.weights[k] = static_cast<float>(rigidity(shape, point) * slant);
        made.gradients.col(k) = gradient;
        made.jacobian.col(k) =
            (gradient.cast<double>().transpose() * level.camera.project_jacobian(camera_from_head * point) *
             camera_from_head.linear() * moved)
                .cast<float>();
        made.depth_error.col(k) = (shape.depth_error * (point - eye).normalized()).cast<float>();
        made.patches.push_back(y / patch * patches_across + x / patch);
    }
    return made;
}

}  // namespace

int sample_spacing(const HeadOptions& options, std::size_t level) {
    return std::max(1, options.sample_spacing - (level + 1 < kLevels ? 1 : 2));
}

SampleView::SampleView(const HeadShape& shape, const HeadOptions& options, const Pyramid& pyramid,
                       const Eigen::Isometry3d& camera_from_head) {
    for (std::size_t level = 0; level < samples_.size(); ++level) {
        samples_[level] = make_samples(shape, options, pyramid[level], level, camera_from_head);
    }
}

}  // namespace mimetic::head
