// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <mimetic/fit/follow.hpp>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/error.hpp>

#include "shared/gray.hpp"

namespace mimetic {

namespace {

constexpr double kLeastCosine = .35;  // between a point's normal and the way to the camera
constexpr double kMargin = 2;         // pixels to the picture's edge
// Pupil distances: flow's own error, and what faces do between two frames at rest. The errors are
// correlated, so that smaller values let motion outweigh the landmarks of a good single fit
constexpr double kFlowSigma = .036;
constexpr double kLargestMismatch = .04;  // pupil distances between flow there and back
constexpr std::size_t kLeastPoints = 12;

/// A point in both pictures.
struct Pair {
    int point;
    Eigen::Vector2d before;
    Eigen::Vector2d after;
};

double cosine_to_camera(const Eigen::Isometry3d& pose, const Eigen::Vector3d& place,
                        const Eigen::Vector3d& normal) {
    const Eigen::Vector3d in_camera = pose * place;
    return -(pose.linear() * normal).dot(in_camera) / in_camera.norm();
}

std::vector<Pair> pairs_in_sight(const Camera& camera, const Eigen::Isometry3d& reference_pose,
                                 const Eigen::Isometry3d& view_pose, const FollowedPoints& followed) {
    const auto is_inside = [&](const Eigen::Vector2d& pixel) {
        return pixel.x() > kMargin && pixel.y() > kMargin && pixel.x() < camera.width - 1 - kMargin &&
               pixel.y() < camera.height - 1 - kMargin;
    };
    std::vector<Pair> pairs;
    for (std::size_t k = 0; k < followed.points.size(); ++k) {
        const Eigen::Vector3d place = followed.places.row(static_cast<Eigen::Index>(k));
        const Eigen::Vector3d normal = followed.normals.row(static_cast<Eigen::Index>(k));
        const Pair pair{followed.points[k], camera.project(reference_pose * place),
                        camera.project(view_pose * place)};
        const double facing = std::min(cosine_to_camera(reference_pose, place, normal),
                                       cosine_to_camera(view_pose, place, normal));
        if (facing > kLeastCosine && is_inside(pair.before) && is_inside(pair.after)) {
            pairs.push_back(pair);
        }
    }
    return pairs;
}

/// The affine motion nearest to the points' own, as a flow; `forth`: from before to after.
FlowField affine_motion(const std::vector<Pair>& pairs, bool forth, int rows, int cols) {
    Eigen::MatrixXd known(static_cast<Eigen::Index>(pairs.size()), 3);
    Eigen::MatrixXd moved(known.rows(), 2);
    for (Eigen::Index k = 0; k < known.rows(); ++k) {
        const auto& [point, before, after] = pairs[static_cast<std::size_t>(k)];
        const Eigen::Vector2d& from = forth ? before : after;
        known.row(k) << from.x(), from.y(), 1;
        moved.row(k) = (forth ? after - before : before - after).transpose();
    }
    const Eigen::Matrix<double, 3, 2> affine = known.completeOrthogonalDecomposition().solve(moved);
    FlowField field;
    field.rows = rows;
    field.cols = cols;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < cols; ++x) {
            const Eigen::RowVector2d flow = Eigen::RowVector3d(x, y, 1) * affine;
            field.flow.push_back(static_cast<float>(flow.x()));
            field.flow.push_back(static_cast<float>(flow.y()));
        }
    }
    return field;
}

/// Bilinear, held at the border.
Eigen::Vector2d flow_at(const FlowField& field, const Eigen::Vector2d& pixel) {
    const double x = std::clamp(pixel.x(), 0., field.cols - 1.),
                 y = std::clamp(pixel.y(), 0., field.rows - 1.);
    const int left = std::min(static_cast<int>(x), field.cols - 2);
    const int top = std::min(static_cast<int>(y), field.rows - 2);
    const double u = x - left, v = y - top;
    Eigen::Vector2d flow;
    for (int axis = 0; axis < 2; ++axis) {
        flow[axis] = static_cast<float>(
            (1 - v) * ((1 - u) * field.flow_at(top, left)[axis] + u * field.flow_at(top, left + 1)[axis]) +
            v * ((1 - u) * field.flow_at(top + 1, left)[axis] + u * field.flow_at(top + 1, left + 1)[axis]));
    }
    return flow;
}

}  // namespace

std::vector<PointMotion> follow_points(const ColorView& reference, const ColorView& view,
                                       const Camera& camera, const Eigen::Isometry3d& reference_pose,
                                       const Eigen::Isometry3d& view_pose, const FollowedPoints& followed,
                                       double pupil_distance_px) {
    const auto count = static_cast<Eigen::Index>(followed.points.size());
    if (followed.places.rows() != count || followed.normals.rows() != count ||
        reference.rows != camera.height || reference.cols != camera.width || view.rows != camera.height ||
        view.cols != camera.width) {
        throw InvalidInput("points need a place and a normal each, and pictures the camera's size");
    }
    const std::vector<Pair> pairs = pairs_in_sight(camera, reference_pose, view_pose, followed);
    if (pairs.size() < kLeastPoints) {
        return {};
    }
    const cv::Mat1b before = to_gray(reference), after = to_gray(view);
    const auto gray_view = [](const cv::Mat1b& gray) {
        return GrayView{gray.data, gray.rows, gray.cols, static_cast<std::ptrdiff_t>(gray.step)};
    };
    FlowOptions options;
    options.method = FlowMethod::dis;
    const auto flow = [&](bool forth) {
        const FlowField start = affine_motion(pairs, forth, camera.height, camera.width);
        return forth ? compute_flow(gray_view(before), gray_view(after), options, &start)
                     : compute_flow(gray_view(after), gray_view(before), options, &start);
    };
    const FlowField there = flow(true), back = flow(false);
    std::vector<PointMotion> motion;
    for (const Pair& pair : pairs) {
        const Eigen::Vector2d shift = flow_at(there, pair.before);
        const double mismatch = (shift + flow_at(back, pair.before + shift)).norm();
        if (mismatch < kLargestMismatch * pupil_distance_px) {
            motion.push_back({pair.point, shift, std::hypot(kFlowSigma * pupil_distance_px, mismatch)});
        }
    }
    return motion;
}

}  // namespace mimetic
