// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <vector>

namespace mimetic {

/// Where a muscle's fibres end in the skin, K x 3: a point, points along a sheet's edge, a ring's own focus.
Points insertion_nodes(const Muscle& muscle);

/// Straight fibres of a muscle, those of a sheet parallel, or half rings about the foci, in space, before
/// projection onto the skin. Each has num_steps points, its origin first.
std::vector<Points> muscle_fibres(const Muscle& muscle, int num_steps);

/// Lines from the bone to the skin: one end moves with the bone, the other with the skin. P points.
struct MuscleLines {
    SkinPlaces places;      ///< of the points on the skin's triangles
    Points rest;            ///< P x 3, on the skin at rest, metres
    MatrixRows bone;        ///< J x 3P, displacement of the bone under each point in each jaw motion, metres
    Eigen::VectorXd share;  ///< P, 0 where a point is on the bone to 1 on the skin

    /// P x 3 on a shape of the skin (N x 3), lifted off it outwards, with the jaw's motions at values (J).
    Points positions(PointsIn vertices, VectorIn jaw_values, double lift) const;
};

}  // namespace mimetic
