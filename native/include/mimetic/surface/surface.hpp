// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

using IndicesIn = const Eigen::Ref<const Eigen::VectorXi>&;

/// Places on the Catmull-Clark limit surface of a quad mesh. A place is a face and (s, t) in [0, 1] x [0, 1]:
/// the face's four vertices lie at (0, 0), (1, 0), (1, 1), (0, 1). Positions and tangents are linear in the
/// control vertices, so one sparse matrix each holds for every shape of the mesh (OpenSubdiv limit stencils).
/// Boundary edges are smooth curves, as in Blender's Subdivision Surface by default.
class LimitSurface {
public:
    LimitSurface() = default;  ///< no points

    /// Throws InvalidInput, naming the face or the point, on indices out of range, a face that repeats a
    /// vertex and (s, t) outside the face. Vertices that no face uses are allowed.
    LimitSurface(QuadsIn faces, int num_vertices, IndicesIn face_index, Points2In st);

    int num_points() const { return static_cast<int>(position_.rows()); }
    int num_vertices() const { return static_cast<int>(position_.cols()); }

    const SparseRows& position_stencils() const { return position_; }    ///< P x V, rows sum to 1
    const SparseRows& s_tangent_stencils() const { return s_tangent_; }  ///< P x V, d position / d s
    const SparseRows& t_tangent_stencils() const { return t_tangent_; }  ///< P x V, d position / d t

    Points positions(PointsIn vertices) const;  ///< metres
    Points normals(PointsIn vertices) const;  ///< unit, outwards; zero where the surface has no tangent plane

private:
    SparseRows position_;
    SparseRows s_tangent_;
    SparseRows t_tangent_;
};

/// A quad mesh refined `levels` times (each face becomes 4^levels), its vertices on the limit surface.
/// Refined vertex i < num_vertices is the limit of control vertex i; edge and face points follow.
/// Throws InvalidInput, naming it, on a vertex that no face uses.
class SubdividedMesh {
public:
    static constexpr int kMaxLevels = 5;

    SubdividedMesh(QuadsIn faces, int num_vertices, int levels);

    int num_refined() const { return limit_.num_points(); }
    const Quads& faces() const { return faces_; }                   ///< refined, oriented as their parents
    const Eigen::VectorXi& parent_face() const { return parent_; }  ///< of each refined face

    /// A point of the control mesh: a face of it, and (s, t) there, as `LimitSurface` has them.
    struct FacePlace {
        int face;
        Eigen::Vector2d st;
    };
    /// Where a point of a triangle of `triangles_of(faces())` lies, by the weights of its corners. Throws
    /// InvalidInput for no such triangle.
    FacePlace place_of(int triangle, const Eigen::Vector3d& weights) const;
    const SparseRows& stencils() const { return limit_.position_stencils(); }
    Points positions(PointsIn vertices) const { return limit_.positions(vertices); }
    Points normals(PointsIn vertices) const { return limit_.normals(vertices); }

private:
    int side_;  // children along an edge
    Quads faces_;
    Eigen::VectorXi parent_;
    LimitSurface limit_;
};

}  // namespace mimetic
