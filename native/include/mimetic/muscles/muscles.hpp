// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

enum class MuscleType {
    linear,    ///< from a point on the bone to a point in the skin
    sheet,     ///< from a line on the bone to a line in the skin, parallel fibres
    sphincter  ///< fibres around two foci, half of the ring
};

/// A muscle placed on a surface; metres, head frame.
struct Muscle {
    MuscleType type = MuscleType::linear;
    Points insertion;  ///< linear: 1 point; sheet: its edge, 2 or more; sphincter: the foci, own side first
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< on the bone; a sphincter has none
    double width = 0.006;  ///< Gaussian s.d. of the footprint along the skin; of a sphincter's ring across
    double normal_share = 0.1;  ///< share of the pull normal to the skin that is kept: bone resists it
    double protrusion = 0;      ///< sphincter: push outwards over pull along the fibres
    double swelling = 0;        ///< sphincter: push across the fibres over pull along them (volume is kept)

    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// The skin that muscles insert into: a triangle mesh with geodesic distances.
class MuscleSurface {
public:
    /// Faces of `carries` false take no force, and no distance crosses them (mouth cavity, eye sockets).
    MuscleSurface(PointsIn vertices, TrianglesIn triangles, const std::vector<bool>& carries);

    /// Geodesic distance from the nearest of `sources` (each snapped to its nearest carrying vertex and that
    /// vertex's neighbours), infinite beyond `limit`. Dijkstra on the edges and across them: too long by 4 %
    /// on average.
    Eigen::VectorXd distances(PointsIn sources, double limit) const;

    /// Nodal forces, N x 3, at activation 1 with a total pull of 1 N (sphincter: a tension of 1 N/m).
    Points forces(const Muscle& muscle) const;

    const Points& vertices() const { return vertices_; }       ///< N x 3
    const Triangles& triangles() const { return triangles_; }  ///< those that carry
    const Points& normals() const { return normals_; }         ///< unit, at the vertices
    const Eigen::VectorXd& areas() const { return areas_; }    ///< N, a third of the triangles around, m^2

private:
    struct Link {
        int to;
        double length;
    };

    Points pull(const Muscle& muscle) const;
    Points squeeze(const Muscle& muscle) const;

    Points vertices_;
    Triangles triangles_;  // those that carry
    Points normals_;
    Eigen::VectorXd areas_;
    std::vector<std::vector<Link>> links_;
};

}  // namespace mimetic
