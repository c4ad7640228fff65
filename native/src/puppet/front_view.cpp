// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/puppet/front_view.hpp>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/checks.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/bilinear.hpp"
#include "shared/gray.hpp"

namespace mimetic {

namespace {

constexpr double kFillSigma = .008;  // metres, of the skin around holes that closes them
constexpr double kLeastDepth = .05;  // metres

/// Heights with holes closed smoothly from their sides, and by the mean further away.
cv::Mat1f closed(const cv::Mat1f& heights, const cv::Mat1f& is_seen, double pixel) {
    const double sigma = kFillSigma / pixel;
    const float mean = static_cast<float>(cv::sum(heights.mul(is_seen))[0] / cv::sum(is_seen)[0]);
    cv::Mat1f weighted = (heights - mean).mul(is_seen), weights = is_seen.clone();
    cv::GaussianBlur(weighted, weighted, {}, sigma);
    cv::GaussianBlur(weights, weights, {}, sigma);
    cv::Mat1f filled;
    cv::divide(weighted, weights + 1e-3F, filled);
    filled += mean;
    heights.copyTo(filled, is_seen > .5F);
    return filled;
}

/// Those seen from outside: through the eyes' holes the back of the head is not.
Quads facing_quads(const Points2& pixels, QuadsIn faces) {
    require(faces.size() == 0 || (faces.minCoeff() >= 0 && faces.maxCoeff() < pixels.rows()),
            "a face names a vertex that is not there");
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < faces.rows(); ++i) {
        const Eigen::RowVector2d a = pixels.row(faces(i, 2)) - pixels.row(faces(i, 0));
        const Eigen::RowVector2d b = pixels.row(faces(i, 3)) - pixels.row(faces(i, 1));
        if (a.x() * b.y() - a.y() * b.x() < 0) {  // y is down in pictures
            kept.push_back(i);
        }
    }
    return faces(kept, Eigen::all);
}

}  // namespace

void FrontViewOptions::check() const {
    check_range("pixel", pixel, 2e-4, .01);
    for (const double side : {left, right, bottom, top}) {
        check_range("side of the view", side, -.3, .3);
    }
    require(right - left >= 32 * pixel && top - bottom >= 32 * pixel,
            "a view of a face needs at least 32 pixels a side");
}

FrontView::FrontView(const Camera& camera, PointsIn vertices, QuadsIn faces, const FrontViewOptions& options)
    : camera_(camera), options_(options) {
    camera.check();
    options.check();
    rows_ = static_cast<int>(std::lround((options.top - options.bottom) / options.pixel));
    cols_ = static_cast<int>(std::lround((options.right - options.left) / options.pixel));
    Points2 pixels(vertices.rows(), 2);
    for (Eigen::Index i = 0; i < vertices.rows(); ++i) {
        pixels.row(i) = pixel_of(vertices(i, 0), vertices(i, 1));
    }
    const Eigen::VectorXd depth = vertices.col(2);
    const Quads front = facing_quads(pixels, faces);
    const QuadRaster seen = raster_quads(pixels, depth, front, rows_, cols_);
    cv::Mat1f heights = cv::Mat1f::zeros(rows_, cols_), is_seen = cv::Mat1f::zeros(rows_, cols_);
    for (int y = 0; y < rows_; ++y) {
        for (int x = 0; x < cols_; ++x) {
            const std::size_t at = seen.raster.index(x, y);
            const int face = seen.raster.face[at];
            if (face < 0) {
                continue;
            }
            is_seen(y, x) = 1;
            for (int corner = 0; corner < 4; ++corner) {
                heights(y, x) += seen.weights(static_cast<Eigen::Index>(at), corner) *
                                 static_cast<float>(depth[front(face, corner)]);
            }
        }
    }
    require(cv::countNonZero(is_seen) > 0, "the view shows nothing of the face");
    heights = closed(heights, is_seen, options.pixel);
    places_.resize(Eigen::Index{rows_} * cols_, 3);
    for (int y = 0; y < rows_; ++y) {
        for (int x = 0; x < cols_; ++x) {
            places_.row(Eigen::Index{y} * cols_ + x) << options.left + (x + .5) * options.pixel,
                options.top - (y + .5) * options.pixel, double{heights(y, x)};
        }
    }
}

Eigen::Vector2d FrontView::pixel_of(double x, double y) const {
    return {(x - options_.left) / options_.pixel - .5, (options_.top - y) / options_.pixel - .5};
}

GrayPicture FrontView::picture(const ColorView& image, const Eigen::Isometry3d& camera_from_head) const {
    require(image.rows == camera_.height && image.cols == camera_.width,
            "the image has another size than the camera's");
    require(camera_from_head.matrix().allFinite(), "the head's pose must be finite");
    cv::Mat1b gray = to_gray(image);
    // Finer pixels than the picture's are averaged first
    double shrunk = 1;
    const double distance = std::max(kLeastDepth, camera_from_head.translation().z());
    while (camera_.fx * options_.pixel / distance / shrunk > 2 && std::min(gray.rows, gray.cols) >= 64) {
        cv::Mat1b half;
        cv::resize(gray, half, {gray.cols / 2, gray.rows / 2}, 0, 0, cv::INTER_AREA);
        gray = half;
        shrunk *= 2;
    }
    const double last_x = gray.cols - 1.001, last_y = gray.rows - 1.001;
    GrayPicture picture{rows_, cols_, std::vector<std::uint8_t>(static_cast<std::size_t>(rows_ * cols_))};
    const Eigen::Matrix3d turn = camera_from_head.linear();
    const Eigen::Vector3d shift = camera_from_head.translation();
    for (Eigen::Index i = 0; i < places_.rows(); ++i) {
        Eigen::Vector3d place = turn * places_.row(i).transpose() + shift;
        place.z() = std::max(place.z(), kLeastDepth);
        const Eigen::Vector2d pixel = ((camera_.project(place).array() + .5) / shrunk - .5).matrix();
        const double x = std::clamp(pixel.x(), 0., last_x), y = std::clamp(pixel.y(), 0., last_y);
        picture.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(bilinear(gray, x, y) + .5);
    }
    return picture;
}

GrayPicture scaled_gray(const ColorView& image, double scale) {
    check_range("scale", scale, .02, 8);
    const cv::Mat1b gray = to_gray(image);
    const cv::Size size(std::max(1, cvRound(scale * gray.cols)), std::max(1, cvRound(scale * gray.rows)));
    cv::Mat1b scaled;
    cv::resize(gray, scaled, size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    return {scaled.rows, scaled.cols, {scaled.begin(), scaled.end()}};
}

}  // namespace mimetic
