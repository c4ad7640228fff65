// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

#include "carried.hpp"

namespace mimetic {
namespace {

constexpr double kOpening = 20 * std::numbers::pi / 180;
constexpr double kGlide[] = {0, -0.0015, 0.004};  // m: the condyle slides down its slope as the jaw opens
constexpr double kSide = 0.007;
constexpr double kThrust = 0.006;
constexpr double kLipBlend = 0.004;
constexpr double kCornerBlend = 0.018;  // where the lips meet, both follow the jaw by half
constexpr double kCheekBlend = 0.025;
constexpr double kNeckStart = 0.005;
constexpr double kNeckBlend = 0.030;

const Eigen::RowVector3d kRight(1, 0, 0);

}  // namespace

JawMotion jaw_motion(const std::string& name) {
    for (const auto& [word, motion] :
         {std::pair("jaw_open", JawMotion::jaw_open), std::pair("jaw_side", JawMotion::jaw_side),
          std::pair("jaw_thrust", JawMotion::jaw_thrust)}) {
        if (name == word) {
            return motion;
        }
    }
    throw InvalidInput("the jaw has no motion '" + name + "'; it has jaw_open, jaw_side, jaw_thrust");
}

Points rotate(PointsIn points, const Eigen::RowVector3d& centre, const Eigen::RowVector3d& axis,
              VectorIn angles) {
    if (angles.size() != points.rows()) {
        throw InvalidInput("got " + std::to_string(angles.size()) + " angles for " +
                           std::to_string(points.rows()) + " points");
    }
    Points turned(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::RowVector3d arm = points.row(i) - centre;
        const Eigen::RowVector3d along = arm.dot(axis) * axis;
        turned.row(i) =
            centre + along + std::cos(angles[i]) * (arm - along) + std::sin(angles[i]) * axis.cross(arm);
    }
    return turned;
}

double smooth_step(double value) {
    const double inside = std::clamp(value, 0.0, 1.0);
    return inside * inside * (3 - 2 * inside);
}

Jaw::Jaw(std::shared_ptr<const SkinMesh> mesh) : mesh_(std::move(mesh)) {
    const std::vector<int> ears{mesh_->landmark("tragus.L"), mesh_->landmark("tragus.R")};
    hinge_ = carried(*mesh_, mesh_->head().jaw_hinge.colwise().mean(), ears);
    influence_ = find_influence();
}

std::vector<int> Jaw::rigid_vertices() const {
    std::vector<int> vertices = mesh_->shared().part_vertices("teeth_lower");
    const std::vector<int> tongue = mesh_->shared().part_vertices("tongue");
    vertices.insert(vertices.end(), tongue.begin(), tongue.end());
    return vertices;
}

Points Jaw::motion(JawMotion motion, PointsIn points) const {
    const double size = mesh_->size();
    if (motion == JawMotion::jaw_open) {
        Points moved =
            rotate(points, hinge_, kRight, Eigen::VectorXd::Constant(points.rows(), kOpening)) - points;
        moved.rowwise() += size * Eigen::Map<const Eigen::RowVector3d>(kGlide);
        return moved;
    }
    if (motion == JawMotion::jaw_side) {
        // About the condyle of the side it goes to: the chin swings, that condyle stays.
        const double angle = size * kSide / (mesh_->landmark_place("chin")[2] - hinge_[2]);
        return rotate(points, hinge_, Eigen::RowVector3d(0, 1, 0),
                      Eigen::VectorXd::Constant(points.rows(), angle)) -
               points;
    }
    return (size * Eigen::RowVector3d(0, -0.1 * kThrust, kThrust)).replicate(points.rows(), 1);
}

Points Jaw::under_skin(JawMotion which) const {
    return influence_.asDiagonal() * motion(which, mesh_->vertices());
}

Eigen::VectorXd Jaw::find_influence() const {
    const SkinMesh& mesh = *mesh_;
    const Points& points = mesh.vertices();
    const double size = mesh.size();
    Eigen::RowVector3d corner = mesh.mean_landmark({"mouth_corner.L", "mouth_corner.R"});
    corner[0] = 0;
    const double reach = (corner - hinge_).norm();
    const Eigen::RowVector3d forward = (corner - hinge_) / reach;
    const Eigen::RowVector3d down = kRight.cross(forward);
    const double half_mouth = std::abs(mesh.landmark_place("mouth_corner.L")[0]);
    const Eigen::RowVector3d slit = mesh.mean_landmark({"lip_upper_inner", "lip_lower_inner"});
    const Eigen::VectorXd lip = mesh.stencils() * (mesh.shared().in_region("lower_lip").cast<double>() -
                                                   mesh.shared().in_region("upper_lip").cast<double>())
                                                      .matrix();
    const Points corners = mesh.places({mesh.landmark("mouth_corner.L"), mesh.landmark("mouth_corner.R")});
    const Eigen::RowVector3d menton = mesh.landmark_place("menton");
    const Eigen::RowVector3d edge = (menton - mesh.mean_landmark({"gonion.L", "gonion.R"})).normalized();
    Eigen::VectorXd influence(points.rows());
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const Eigen::RowVector3d p = points.row(v);
        // Between the lips the slit parts skull from jaw, in the cheek the change is gradual.
        const double aside = smooth_step((std::abs(p[0]) - half_mouth) / (0.02 * size));
        const double blend = size * (kLipBlend + (kCheekBlend - kLipBlend) * aside);
        const double level = (slit - hinge_).dot(down) * (1 - aside);
        const double gap = (corners.rowwise() - p).rowwise().norm().minCoeff();
        const double which_lip = lip[v] * smooth_step(gap / (kCornerBlend * size));
        const double value = smooth_step(0.5 + ((p - hinge_).dot(down) - level) / blend + which_lip) *
                             smooth_step((p - hinge_).dot(forward) / reach / 0.3);
        // Below the lower edge of the mandible the neck takes over.
        const double under = (p - menton).dot(kRight.cross(edge));
        influence[v] = value * smooth_step(1 - (under / size - kNeckStart) / kNeckBlend);
    }
    return influence;
}

}  // namespace mimetic
