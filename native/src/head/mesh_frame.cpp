// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <limits>
#include <mimetic/head/mesh_frame.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/spread.hpp>

namespace mimetic {
namespace {

constexpr double kNear = 1e-5;   // of the marks' extent: on a head less than a hundredth of a millimetre
constexpr double kFlat = 1e-10;  // of the cube of the marks' spread: a plane's thickness is rounding
constexpr double kSingle = 4. * std::numeric_limits<float>::epsilon();

}  // namespace

std::vector<int> marks_of(PointsIn points, int count) {
    require(points.rows() > 0 && points.allFinite(), "a mesh to mark needs points, and finite ones");
    Eigen::Index first = 0;
    (points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().maxCoeff(&first);
    const std::vector<bool> allowed(static_cast<std::size_t>(points.rows()), true);
    std::vector<int> marks = spread_rows(points, {static_cast<int>(first)}, allowed, count);
    marks.resize(static_cast<std::size_t>(count), marks.front());
    return marks;
}

Eigen::Matrix4d now_from_noted(PointsIn noted, PointsIn now) {
    require(noted.rows() > 0 && noted.rows() == now.rows() && noted.allFinite() && now.allFinite(),
            "marks need as many places now as were noted, all finite");
    const double extent = (now.colwise().maxCoeff() - now.colwise().minCoeff()).maxCoeff();
    const double near = kNear * extent + kSingle * now.cwiseAbs().maxCoeff();
    const auto is_near = [near](const Points& off) { return off.cwiseAbs().maxCoeff() <= near; };
    Eigen::Matrix4d moved = Eigen::Matrix4d::Identity();
    if (is_near(now - noted)) {
        return moved;
    }
    const Eigen::RowVector3d origin = noted.colwise().mean(), target = now.colwise().mean();
    const Points before = noted.rowwise() - origin, after = now.rowwise() - target;
    const Eigen::Matrix3d normal = before.transpose() * before;
    if (normal.determinant() <= kFlat * std::pow(normal.trace(), 3)) {
        return moved;
    }
    const Eigen::Matrix3d linear = after.transpose() * before * normal.inverse();
    if (!is_near(before * linear.transpose() - after) || linear.determinant() == 0) {
        return moved;
    }
    moved.topLeftCorner<3, 3>() = linear;
    moved.topRightCorner<3, 1>() = target.transpose() - linear * origin.transpose();
    return moved;
}

}  // namespace mimetic
