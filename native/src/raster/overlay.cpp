// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/raster/depth.hpp>
#include <mimetic/raster/gauge.hpp>
#include <mimetic/raster/overlay.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

constexpr int kSubpixelBits = 4;
const cv::Scalar kWhite(255, 255, 255);
const cv::Vec3f kIris(255, 120, 200);
constexpr double kUnderLid = 1e-3;  // metres behind the skin at which an iris is covered

cv::Point to_fixed(const Eigen::Vector2d& pixel) {
    constexpr double kFar = 32000;  // OpenCV's fixed point ends beyond
    const double unit = 1 << kSubpixelBits;
    return {static_cast<int>(std::lround(std::clamp(pixel.x(), -kFar, kFar) * unit)),
            static_cast<int>(std::lround(std::clamp(pixel.y(), -kFar, kFar) * unit))};
}

/// Pixels move towards `colour` as far as the mask covers them.
void tint(cv::Mat& image, const cv::Mat& mask, const cv::Vec3f& colour, double opacity) {
    const auto strength = static_cast<float>(opacity / 255);
    for (int y = 0; y < image.rows; ++y) {
        auto* pixels = image.ptr<cv::Vec3b>(y);
        const auto* cover = mask.ptr<std::uint8_t>(y);
        for (int x = 0; x < image.cols; ++x) {
            if (cover[x] == 0) {
                continue;
            }
            const float a = strength * cover[x];
            for (int k = 0; k < 3; ++k) {
                pixels[x][k] =
                    static_cast<std::uint8_t>(static_cast<float>(pixels[x][k]) * (1 - a) + colour[k] * a);
            }
        }
    }
}

}  // namespace

void OverlayOptions::check() const {
    check_range("overlay option scale", scale, 1, 8);
    check_range("overlay option opacity", opacity, 0, 1);
    check_range("overlay option depth_tolerance (metres)", depth_tolerance, 0, 1);
    check_range("overlay option held_quality", held_quality, 0, 1);
}

OverlayPainter::OverlayPainter(const Camera& camera, int num_vertices, QuadsIn faces,
                               std::vector<int> landmarks, const OverlayOptions& options)
    : camera_(camera),
      options_(options),
      num_vertices_(num_vertices),
      mesh_(faces, num_vertices),
      landmarks_(std::move(landmarks)) {
    options.check();
    const auto fits = [num_vertices](int vertex) { return vertex >= 0 && vertex < num_vertices; };
    if (!std::all_of(landmarks_.begin(), landmarks_.end(), fits)) {
        throw InvalidInput("a landmark names a vertex outside 0 to " + std::to_string(num_vertices - 1));
    }
    // Pixel (0, 0) is a centre, so enlarging keeps the corner at (-0.5, -0.5) in place.
    const double scale = options.scale;
    camera_ = {camera.fx * scale,
               camera.fy * scale,
               (camera.cx + 0.5) * scale - 0.5,
               (camera.cy + 0.5) * scale - 0.5,
               camera.width * options.scale,
               camera.height * options.scale};
    camera_.check();
}

std::vector<OverlayPainter::Place> OverlayPainter::find_places(PointsIn points_in_camera,
                                                               const DepthMap& depth,
                                                               double tolerance) const {
    std::vector<Place> places(static_cast<std::size_t>(points_in_camera.rows()));
    for (Eigen::Index i = 0; i < points_in_camera.rows(); ++i) {
        const Eigen::Vector3d point = points_in_camera.row(i);
        Place& place = places[static_cast<std::size_t>(i)];
        place.is_shown = depth.shows(camera_, point, tolerance);
        if (place.is_shown) {
            place.pixel = camera_.project(point);
        }
    }
    return places;
}

ColorImage OverlayPainter::paint(const ColorView& image, PointsIn vertices_in_camera, double quality,
                                 int frame, const std::vector<Points>& rings) const {
    if (image.cols * options_.scale != camera_.width || image.rows * options_.scale != camera_.height) {
        throw InvalidInput("the picture and the camera differ in size");
    }
    if (vertices_in_camera.rows() != num_vertices_) {
        throw InvalidInput("the overlay needs " + std::to_string(num_vertices_) + " vertices, got " +
                           std::to_string(vertices_in_camera.rows()));
    }
    ColorImage painted{camera_.height, camera_.width, {}};
    painted.pixels.resize(3 * static_cast<std::size_t>(painted.rows) *
                          static_cast<std::size_t>(painted.cols));
    cv::Mat canvas(painted.rows, painted.cols, CV_8UC3, painted.pixels.data());
    const cv::Mat source = as_matrix(image);
    cv::resize(source, canvas, canvas.size(), 0, 0, cv::INTER_CUBIC);

    const DepthMap depth = render_depth(camera_, vertices_in_camera, mesh_.faces());
    const std::vector<Place> places = find_places(vertices_in_camera, depth, options_.depth_tolerance);
    cv::Mat mask = cv::Mat::zeros(canvas.size(), CV_8U);
    const std::vector<bool> turned = mesh_.turned_to_camera(vertices_in_camera);
    for (const QuadEdges::Edge& edge : mesh_.edges()) {
        const Place& first = places[static_cast<std::size_t>(edge.first)];
        const Place& second = places[static_cast<std::size_t>(edge.second)];
        if (first.is_shown && second.is_shown && QuadEdges::is_turned(edge, turned)) {
            cv::line(mask, to_fixed(first.pixel), to_fixed(second.pixel), kWhite, 1, cv::LINE_AA,
                     kSubpixelBits);
        }
    }
    const bool held = quality < options_.held_quality;
    const Eigen::Vector3f shown = quality_colour(quality, options_.held_quality);
    const cv::Vec3f colour(shown[0], shown[1], shown[2]);
    tint(canvas, mask, colour, held ? 0.4 * options_.opacity : options_.opacity);

    mask.setTo(0);
    const int radius = (3 + options_.scale) << (kSubpixelBits - 1);
    for (const int vertex : landmarks_) {
        const Place& place = places[static_cast<std::size_t>(vertex)];
        if (place.is_shown) {
            cv::circle(mask, to_fixed(place.pixel), radius, kWhite, cv::FILLED, cv::LINE_AA, kSubpixelBits);
        }
    }
    tint(canvas, mask, {255, 235, 90}, 0.95);
    mask.setTo(0);
    for (const Points& ring : rings) {
        const std::vector<Place> rim = find_places(ring, depth, kUnderLid);
        for (std::size_t i = 0; i < rim.size(); ++i) {
            const Place &from = rim[i], &to = rim[(i + 1) % rim.size()];
            if (from.is_shown && to.is_shown) {
                cv::line(mask, to_fixed(from.pixel), to_fixed(to.pixel), kWhite, 1, cv::LINE_AA,
                         kSubpixelBits);
            }
        }
    }
    tint(canvas, mask, kIris, held ? 0.4 : 0.95);
    draw_gauge(painted, quality, options_.held_quality, frame);
    return painted;
}

}  // namespace mimetic
