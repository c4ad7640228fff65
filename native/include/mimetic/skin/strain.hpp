// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// How a skin is stretched from rest to another shape: the deformation of constant-strain triangles in their
/// own planes. It is not linearised, so that a rotation of the head or of the jaw causes no
/// strain.
class StrainMeter {
public:
    /// rest N x 3, triangles T x 3. Throws InvalidInput, naming the triangle, on vertices out of range,
    /// numbers that are not finite and triangles without area.
    StrainMeter(PointsIn rest, TrianglesIn triangles);

    int num_vertices() const { return static_cast<int>(area_around_.size()); }

    /// N x 3 at the vertices of a shape N x 3: area over its area at rest, then the largest and the smallest
    /// length over its length at rest, each less 1 (0.1 is 10 % longer). A vertex takes the mean of the
    /// triangles around it by their areas at rest; 0 where there are none.
    Points at_vertices(PointsIn vertices) const;

private:
    struct Element {
        Eigen::Vector3i corners;
        Eigen::Matrix2d plane_from_edges;  // inverse of the two edges at rest, in the triangle's plane; 1/m
        double area;
    };

    std::vector<Element> elements_;
    Eigen::VectorXd area_around_;
};

}  // namespace mimetic
