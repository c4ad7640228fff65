// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/muscles/skin_mesh.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/unfold.hpp>

namespace mimetic {
namespace {

constexpr double kScaleReach =
    0.025;                           // m on the template: s.d. over which sizes are averaged, a pull's spread
constexpr double kTurnedAway = 0.1;  // z of a normal from which skin counts as seen from the front

double length(const Eigen::RowVector3d& arm) {
    return std::sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
}

/// Along a quad's normal, twice its area long.
Eigen::RowVector3d crossed_diagonals(PointsIn vertices, const Eigen::RowVector4i& quad) {
    const Eigen::RowVector3d ac = vertices.row(quad[2]) - vertices.row(quad[0]);
    const Eigen::RowVector3d bd = vertices.row(quad[3]) - vertices.row(quad[1]);
    return ac.cross(bd);
}

Eigen::VectorXd quad_areas(PointsIn vertices, QuadsIn quads) {
    Eigen::VectorXd areas(quads.rows());
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        areas[f] = length(crossed_diagonals(vertices, quads.row(f))) / 2;
    }
    return areas;
}

Points checked(Points neutral, const TemplateMesh& head) {
    if (neutral.rows() != head.vertices.rows()) {
        throw InvalidInput("neutral_vertices are (" + std::to_string(neutral.rows()) + ", 3), needed are (" +
                           std::to_string(head.vertices.rows()) + ", 3)");
    }
    if (!neutral.allFinite()) {
        throw InvalidInput("neutral_vertices hold NaN or infinity");
    }
    return neutral;
}

}  // namespace

Triangles split_quads(PointsIn vertices, QuadsIn quads) {
    check_corners(quads, vertices.rows());
    Triangles triangles(2 * quads.rows(), 3);
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        const Eigen::RowVector4i q = quads.row(f);
        const bool along_ac = length(vertices.row(q[0]) - vertices.row(q[2])) <=
                              length(vertices.row(q[1]) - vertices.row(q[3]));
        if (along_ac) {
            triangles.middleRows<2>(2 * f) << q[0], q[1], q[2], q[0], q[2], q[3];
        } else {
            triangles.middleRows<2>(2 * f) << q[0], q[1], q[3], q[1], q[2], q[3];
        }
    }
    return triangles;
}

Points quad_normals(PointsIn vertices, QuadsIn quads) {
    check_corners(quads, vertices.rows());
    Points normals = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        const Eigen::RowVector3d across = crossed_diagonals(vertices, quads.row(f));
        for (int k = 0; k < 4; ++k) {
            normals.row(quads(f, k)) += across;
        }
    }
    for (Eigen::Index v = 0; v < normals.rows(); ++v) {
        normals.row(v) /= std::max(length(normals.row(v)), 1e-30);
    }
    return normals;
}

SkinMesh::SkinMesh(std::shared_ptr<const TemplateSkin> shared, PointsIn neutral)
    : shared_(std::move(shared)), neutral_(checked(neutral, shared_->mesh())) {
    const SubdividedMesh& refinement = shared_->refinement();
    const auto control = neutral_.topRows(head().num_skin_vertices);
    Eigen::VectorXi face(2 * refinement.faces().rows());
    outer_.resize(face.size());
    const int skin = shared_->part_number("skin");
    for (Eigen::Index t = 0; t < face.size(); ++t) {
        face[t] = refinement.parent_face()[t / 2];
        outer_[t] = head().part[face[t]] == skin;
    }
    Unfolded unfolded = unfold(
        refinement.positions(control),
        [&](PointsIn vertices) { return split_quads(vertices, refinement.faces()); }, face);
    vertices_ = std::move(unfolded.vertices);
    inverted_ = std::move(unfolded.inverted);
    smoothed_by_ = unfolded.farthest;
    triangles_ = split_quads(vertices_, refinement.faces());
    normals_ = refinement.normals(control);
    std::vector<bool> is_outer(vertices_.rows(), false);
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
        for (int k = 0; k < 3 && outer_[t]; ++k) {
            is_outer[triangles_(t, k)] = true;
        }
    }
    for (int v = 0; v < static_cast<int>(is_outer.size()); ++v) {
        if (is_outer[v] && normals_(v, 2) > kTurnedAway) {
            seen_from_front_.push_back(v);
        }
    }
    const Quads& quads = shared_->outer_quads();
    size_ = std::sqrt(quad_areas(neutral_, quads).sum() / quad_areas(head().vertices, quads).sum());
}

const MuscleSurface& SkinMesh::surface() const {
    return surface_.get([&] { return MuscleSurface(vertices_, triangles_, outer_); });
}

const MuscleSurface& SkinMesh::whole_surface() const {
    return whole_surface_.get(
        [&] { return MuscleSurface(vertices_, triangles_, std::vector<bool>(triangles_.rows(), true)); });
}

const Eigen::VectorXd& SkinMesh::local_scale() const {
    return local_scale_.get([&] {
        const Quads& quads = shared_->outer_quads();
        const Points& canonical = head().vertices;
        const Eigen::VectorXd own = quad_areas(neutral_, quads);
        const Eigen::VectorXd usual = quad_areas(canonical, quads);
        Eigen::Array<double, Eigen::Dynamic, 3> middles(quads.rows(), 3);
        for (Eigen::Index f = 0; f < quads.rows(); ++f) {
            middles.row(f) = canonical(quads.row(f), Eigen::all).colwise().mean();
        }
        Eigen::VectorXd scale(head().num_skin_vertices);
        Eigen::ArrayXd near(quads.rows());
        for (Eigen::Index v = 0; v < scale.size(); ++v) {
            near = (middles.col(0) - canonical(v, 0)).square() + (middles.col(1) - canonical(v, 1)).square() +
                   (middles.col(2) - canonical(v, 2)).square();
            near = (near * (-1 / (2 * kScaleReach * kScaleReach))).exp();
            scale[v] = std::sqrt(near.matrix().dot(own) / near.matrix().dot(usual));
        }
        return scale;
    });
}

Eigen::RowVector3d SkinMesh::landmark_place(const std::string& name) const {
    return neutral_.row(landmark(name));
}

Points SkinMesh::places(const std::vector<int>& control_vertices) const {
    return vertices_(control_vertices, Eigen::all);
}

Eigen::RowVector3d SkinMesh::mean_landmark(const std::vector<std::string>& names) const {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const std::string& name : names) {
        sum += landmark_place(name);
    }
    return sum / static_cast<double>(names.size());
}

Eigen::RowVector3d Place::position(const SkinMesh& mesh) const {
    return mesh.vertices().row(vertex) + scale(mesh) * (offset - depth * mesh.normals().row(vertex));
}

double Place::scale(const SkinMesh& mesh) const {
    return mesh.stencils().row(vertex).dot(mesh.local_scale());
}

Place find_place(const SkinMesh& canonical, const LandmarkPlace& at, char side) {
    const bool is_single = canonical.shared().has_landmark(at.anchor);
    const std::string name = is_single ? at.anchor : at.anchor + "." + side;
    const Eigen::RowVector3d from = canonical.landmark_place(name);
    const double outwards = side == 'L' ? 1 : -1;
    const Eigen::RowVector2d target = from.head<2>() + 1e-3 * Eigen::RowVector2d(outwards * at.x, at.y);
    Place place;
    double least = std::numeric_limits<double>::infinity();
    for (const int v : canonical.seen_from_front()) {
        const Eigen::RowVector2d away = canonical.vertices().row(v).head<2>() - target;
        const double distance = std::sqrt(away[0] * away[0] + away[1] * away[1]);
        if (distance < least) {
            least = distance;
            place.vertex = v;
        }
    }
    const Eigen::RowVector3d normal = canonical.normals().row(place.vertex);
    const Eigen::RowVector2d across = target - canonical.vertices().row(place.vertex).head<2>();
    place.offset << across, -normal.head<2>().dot(across) / normal[2];
    place.depth = 1e-3 * at.depth;
    return place;
}

}  // namespace mimetic
