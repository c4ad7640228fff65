// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/types.hpp>
#include <mimetic/surface/nearest.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <vector>

namespace mimetic {

/// A skin whose nearest-point search distinguishes inside from outside and upper from lower lip.
class LippedSurface {
public:
    /// vertices N x 3, metres, of a head of the template's size; surface: of all its triangles; lips: 2 x 3,
    /// points of the upper and the lower lip's vermilion border.
    LippedSurface(PointsIn vertices, TrianglesIn triangles, const MuscleSurface& surface, PointsIn lips);

    /// Nearest places to P points (P x 3) with their outward normals (P x 3) and lips (P; 1 on the upper one,
    /// -1 on the lower one).
    SkinPlaces find(PointsIn points, PointsIn normals, VectorIn lip) const;

    const Points& vertices() const { return vertices_; }
    const Triangles& triangles() const { return triangles_; }
    const Points& normals() const { return normals_; }
    const Eigen::VectorXd& lip() const { return lip_; }  ///< N, 1 on the upper lip to -1 on the lower one

private:
    Points vertices_;
    Triangles triangles_;
    Points normals_;
    Eigen::VectorXd lip_;
    TrianglesAround around_;
    NearestPoints nearest_;  // among the vertices that triangles have, by place, normal and lip
};

/// How vertices with places on a refined skin (stencils, N x S) are carried by its control vertices: P x S.
/// The share falls smoothly from all at half of `reach` (metres, of the gap between) to none.
SparseRows carrier_rows(const SkinPlaces& places, const SparseRows& stencils, double reach);

/// Points P x 3 warped so that sources (K x 3) reach their targets; radial basis function -r. Conditionally
/// positive definite of order 1 [Wendland 2004]: a constant is enough beside it, so points far from all
/// landmarks are neither sheared nor scaled. Throws InvalidInput if two sources are at one place.
Points warp_points(PointsIn points, PointsIn source, PointsIn target);

/// Vertices of a head that move with the mean of others: teeth with the lips, an eye with its lids.
struct Follower {
    std::vector<int> edge;
    std::vector<int> vertices;
};

/// A head of the template's mesh during registration to another head's skin. V control vertices, S of the
/// skin (they come first), N of the refined skin, whose vertex i < S is the limit of control vertex i.
struct LaidTemplate {
    Points neutral;           ///< V x 3
    LippedSurface skin;       ///< refined
    std::vector<bool> outer;  ///< N, which are not linings
    SparseRows stencils;      ///< N x S
    std::vector<int> held;    ///< L control vertices, the landmarks
    std::vector<Follower> followers;
};

/// One round of non-rigid closest points [Amberg 2007] with our own shell as the regulariser: the foundation
/// of the skin model is the pull to the surface, strong across the skin and weak along it. Returns the
/// neutral, V x 3. targets: L x 3, of the held vertices; reach: metres, of the pull. Throws InvalidInput as
/// SkinModel does.
Points draw_to_surface(const LaidTemplate& laid, PointsIn targets, const LippedSurface& surface,
                       double reach);

}  // namespace mimetic
