// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Points on the triangles of a surface of N vertices.
struct SkinPlaces {
    Triangles corners;     ///< P x 3, vertices
    Points weights;        ///< P x 3, of the corners; they sum to 1
    Eigen::VectorXd gaps;  ///< P, metres from the query points

    /// Values at the vertices (N x K), interpolated: P x K. Throws InvalidInput if a corner has none.
    MatrixRows values(MatrixIn at_vertices) const;

    /// The places on a shape of the surface (N x 3, metres), lifted off it outwards by so many metres.
    Points positions(PointsIn vertices, double lift) const;
};

/// Weights of the corners at the point of a triangle that is nearest to a point. The nearest of the
/// projection onto its plane, if that is inside, and of the nearest points on its edges.
Eigen::RowVector3d closest_weights(const Eigen::RowVector3d& point, const Eigen::Matrix3d& corners);

/// Triangles by their vertices.
class TrianglesAround {
public:
    /// Throws InvalidInput if a triangle names a vertex outside 0 to num_vertices - 1.
    TrianglesAround(TrianglesIn triangles, int num_vertices);

    /// Vertices that triangles use, rising.
    const std::vector<int>& used() const { return used_; }

    /// The place that is nearest to each point (P x 3) on the triangles at a vertex near it (P). Throws
    /// InvalidInput if there are none.
    SkinPlaces closest(PointsIn points, const Eigen::VectorXi& near, PointsIn vertices) const;

private:
    Triangles triangles_;
    std::vector<int> first_, around_, used_;
};

/// The places on triangles that are nearest to points (P x 3), searched around the nearest vertex.
SkinPlaces nearest_places(PointsIn points, PointsIn vertices, TrianglesIn triangles);

}  // namespace mimetic
