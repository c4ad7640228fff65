// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/register/worn.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/ways.hpp>

namespace mimetic {
namespace {

constexpr int kPixels = 256;           // of a view, its width and height
constexpr Eigen::Index kSamples = 96;  // vertices by which a part is judged
// Share of a part's samples and views in which it lies before the skin: of what is worn half the views see
// each place, and most of these the skin behind it; of an eyeball a tenth
constexpr double kBefore = .2;
constexpr double kNear = .008;  // m before the skin: lashes, brows, beards
constexpr double kOnSkin = .9;  // share of the samples of what lies on the skin that are near to it
// A ball, or a cap of one: how rough it is and how far it extends, in its radius, and its radius in the
// head's extent, as lenses of glasses are flatter; and how thick it is, in its breadth, as a rim is a ring of
// a ball
constexpr double kRough = .08, kExtends = 1, kLargest = .2, kThick = .12;

bool is_round(PointsIn points, double head_extent) {
    if (points.rows() < 8) {
        return false;
    }
    const Sphere own = nearest_sphere(points);
    if (!(own.radius > 0) || !(own.radius < kLargest * head_extent)) {
        return false;
    }
    const Eigen::VectorXd distances = (points.rowwise() - own.centre.transpose()).rowwise().norm();
    const double roughness = std::sqrt((distances.array() - own.radius).square().mean());
    const double extent = (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
    const Points spread = points.rowwise() - points.colwise().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(Eigen::Matrix3d(spread.transpose() * spread));
    const Eigen::Vector3d sides = axes.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
    return roughness < kRough * own.radius && extent > kExtends * own.radius && sides[0] > kThick * sides[2];
}

}  // namespace

HeadViews::HeadViews(PointsIn points, TrianglesIn triangles, const Eigen::Matrix4d& metres_from_points) {
    require(points.allFinite(), "the points of a head must be finite");
    check_corners(triangles, points.rows(), "head");
    const double volume = std::abs(metres_from_points.topLeftCorner<3, 3>().determinant());
    require(std::isfinite(volume) && volume > 0, "the head is scaled to nothing");
    near_ = kNear / std::cbrt(volume);
    if (triangles.rows() == 0) {
        return;
    }
    extent_ = (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
    for (int way = 0; way < 27; ++way) {
        View view;
        view.direction = Eigen::Vector3d(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1);
        if (view.direction.isZero()) {
            continue;
        }
        view.direction.normalize();
        view.aside = view.direction.unitOrthogonal();
        view.up = view.direction.cross(view.aside);
        const Eigen::VectorXd x = points * view.aside, y = points * view.up, depth = -points * view.direction;
        view.left = x.minCoeff();
        view.bottom = y.minCoeff();
        view.pixel = std::max({x.maxCoeff() - view.left, y.maxCoeff() - view.bottom, 1e-30}) / (kPixels - 1);
        view.nearest = Raster(kPixels, kPixels);
        std::vector<bool> shows(static_cast<std::size_t>(triangles.rows()));
        for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
            const Eigen::RowVector3i corners = triangles.row(t);
            TriangleCorners<double> seen;
            Eigen::Vector3d depths;
            for (Eigen::Index k = 0; k < 3; ++k) {
                seen[static_cast<std::size_t>(k)] = {(x[corners[k]] - view.left) / view.pixel,
                                                     (y[corners[k]] - view.bottom) / view.pixel};
                depths[k] = depth[corners[k]];
            }
            shows[static_cast<std::size_t>(t)] = doubled_area(seen) > 0;
            fill_triangle(seen, kPixels, kPixels, [&](int column, int row, const Eigen::Vector3d& weights) {
                view.nearest.keep_nearer(column, row, static_cast<int>(t),
                                         static_cast<float>(weights.dot(depths)));
            });
        }
        views_.push_back(std::move(view));
        shows_outside_.push_back(std::move(shows));
    }
}

HeadViews::Sample HeadViews::look_at(const Eigen::Vector3d& point) const {
    Sample sample;
    sample.gap = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const View& view = views_[v];
        const auto column = std::lround((view.aside.dot(point) - view.left) / view.pixel);
        const auto row = std::lround((view.up.dot(point) - view.bottom) / view.pixel);
        if (column < 0 || row < 0 || column >= kPixels || row >= kPixels) {
            continue;
        }
        const std::size_t there = view.nearest.index(static_cast<int>(column), static_cast<int>(row));
        const int face = view.nearest.face[there];
        const double gap = static_cast<double>(view.nearest.depth[there]) + view.direction.dot(point);
        if (face < 0 || gap < 0) {
            continue;
        }
        if (shows_outside_[v][static_cast<std::size_t>(face)]) {
            ++sample.num_before;
            sample.gap = std::min(sample.gap, gap);
        } else {
            ++sample.num_within;
        }
    }
    return sample;
}

bool HeadViews::wears(PointsIn part) const {
    if (views_.empty() || part.rows() == 0 || !part.allFinite()) {
        return false;
    }
    const Eigen::Index step = (part.rows() + kSamples - 1) / kSamples;
    int num_samples = 0, num_before = 0, num_within = 0, num_on_skin = 0;
    for (Eigen::Index p = 0; p < part.rows(); p += step) {
        const Sample sample = look_at(part.row(p).transpose());
        ++num_samples;
        num_before += sample.num_before;
        num_within += sample.num_within;
        num_on_skin += sample.num_before == 0 || sample.gap < near_;
    }
    const bool is_before =
        num_before > kBefore * num_samples * static_cast<double>(views_.size()) && num_before > num_within;
    return is_before && num_on_skin < kOnSkin * num_samples && !is_round(part, extent_);
}

}  // namespace mimetic
