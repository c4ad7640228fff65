// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <mimetic/register/shown_head.hpp>
#include <mimetic/shared/error.hpp>

#include "skin/mesh_edges.hpp"
#include "weld.hpp"

namespace mimetic {
namespace {

const Eigen::RowVector3d kSkin(225, 180, 155), kEyeball(235, 235, 235);
constexpr double kRound = .06;  // of its radius, deviation of an eyeball from a sphere
constexpr double kDeep = .8,
                 kWhole = 4;      // radii: of a ball's extents the least, and their sum; half a ball has 5
constexpr double kEyeShare = .4;  // of the mesh's extent, largest diameter of an eyeball
constexpr double kSheetShare = .18, kSheetFaces = .2;  // of the extent, and the faces: a lash, a brow, a lock
constexpr double kLashes = 1.6;  // eyeballs' diameters, beside a mask whose own extent is small

/// What is known of a connected part.
struct Part {
    std::vector<int> vertices;
    Eigen::Index num_triangles = 0;
    bool has_boundary = false;
};

/// Diameter of the sphere on which points lie, or a large piece of it; 0 if it is none, or over `widest`.
double ball_diameter(const Points& vertices, const std::vector<int>& own, double widest) {
    if (own.size() < 12) {
        return 0;
    }
    const Points points = vertices(own, Eigen::all);
    const Eigen::RowVector3d mean = points.colwise().mean();
    MatrixRows system(points.rows(), 4);  // |p|^2 = 2 c p + (r^2 - |c|^2)
    system.leftCols<3>() = 2 * (points.rowwise() - mean);
    system.col(3).setOnes();
    const Eigen::VectorXd squares = (points.rowwise() - mean).rowwise().squaredNorm();
    const Eigen::Vector4d solution = system.colPivHouseholderQr().solve(squares);
    const double radius = std::sqrt(std::max(0., solution[3] + solution.head<3>().squaredNorm()));
    const Eigen::VectorXd distances =
        ((points.rowwise() - mean).rowwise() - solution.head<3>().transpose()).rowwise().norm();
    const double deviation = std::sqrt((distances.array() - radius).square().mean());
    // Lashes lie on a sphere, too, but are no large piece of one
    const Eigen::RowVector3d extent = points.colwise().maxCoeff() - points.colwise().minCoeff();
    const bool is_large = extent.minCoeff() > kDeep * radius && extent.sum() > kWhole * radius;
    return is_large && 2 * radius < widest && deviation < kRound * radius ? 2 * radius : 0;
}

/// Whether a part is an open sheet, smaller than `widest`, which covers skin.
bool is_sheet(const Points& vertices, const Part& part, const Part& largest, double widest) {
    const Points points = vertices(part.vertices, Eigen::all);
    const double own = (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
    return part.has_boundary && own < widest &&
           static_cast<double>(part.num_triangles) < kSheetFaces * static_cast<double>(largest.num_triangles);
}

}  // namespace

ShownHead ShownHead::aligned(const Similarity& target_from_mesh) const {
    ShownHead head = *this;
    head.mesh.vertices = target_from_mesh.apply(mesh.vertices);
    head.mesh.normals = mesh.normals * target_from_mesh.rotation.transpose();
    return head;
}

ShownHead shown_head(PointsIn vertices, TrianglesIn triangles) {
    if (triangles.rows() == 0 || !vertices.allFinite()) {
        throw InvalidInput("the mesh has no faces, or a vertex that is not finite");
    }
    if (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices.rows()) {
        throw InvalidInput("a face names a vertex that the mesh does not have");
    }
    const Points all = vertices;
    const Welded welded = weld(all);
    ShownHead head;
    head.mesh.vertices = all(welded.kept, Eigen::all);
    Triangles joined(triangles.rows(), 3);
    for (Eigen::Index i = 0; i < triangles.size(); ++i) {
        joined.data()[i] = welded.number[static_cast<std::size_t>(triangles(i / 3, i % 3))];
    }
    const std::vector<int> part = parts_of(joined, welded.kept.size());
    std::map<int, Part> parts;
    for (std::size_t v = 0; v < part.size(); ++v) {
        parts[part[v]].vertices.push_back(static_cast<int>(v));
    }
    for (Eigen::Index t = 0; t < joined.rows(); ++t) {
        ++parts[part[static_cast<std::size_t>(joined(t, 0))]].num_triangles;
    }
    for (const Edge& edge : boundary_edges(joined)) {
        parts[part[static_cast<std::size_t>(edge.from)]].has_boundary = true;
    }
    int largest = -1;
    std::map<int, bool> is_eye, is_drawn;
    const double extent =
        (head.mesh.vertices.colwise().maxCoeff() - head.mesh.vertices.colwise().minCoeff()).maxCoeff();
    double widest_sheet = kSheetShare * extent;
    for (const auto& [label, one] : parts) {
        largest = largest < 0 || one.num_triangles > parts[largest].num_triangles ? label : largest;
    }
    for (const auto& [label, one] : parts) {
        const double diameter =
            label == largest ? 0 : ball_diameter(head.mesh.vertices, one.vertices, kEyeShare * extent);
        is_eye[label] = diameter > 0;
        widest_sheet = std::max(widest_sheet, kLashes * diameter);
    }
    for (const auto& [label, one] : parts) {
        is_drawn[label] = is_eye[label] || !is_sheet(head.mesh.vertices, one, parts[largest], widest_sheet);
    }
    std::vector<Eigen::Index> drawn;
    for (Eigen::Index t = 0; t < joined.rows(); ++t) {
        if (is_drawn[part[static_cast<std::size_t>(joined(t, 0))]]) {
            drawn.push_back(t);
        }
    }
    head.mesh.triangles = joined(drawn, Eigen::all);
    head.mesh.normals = vertex_normals(head.mesh.vertices, head.mesh.triangles);
    head.mesh.colours.resize(head.mesh.triangles.rows(), 3);
    for (Eigen::Index t = 0; t < head.mesh.triangles.rows(); ++t) {
        head.part.push_back(part[static_cast<std::size_t>(head.mesh.triangles(t, 0))]);
        head.is_eye.push_back(is_eye[head.part.back()]);
        head.mesh.colours.row(t) = head.is_eye.back() ? kEyeball : kSkin;
    }
    return head;
}

}  // namespace mimetic
