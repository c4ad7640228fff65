// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// A model's points aligned with a head by points that both have: affine where the two differ by an affine
/// map, and the smoothest correction of it elsewhere (the spline of kernel r).
class PointWarp {
public:
    /// from, to: A x 3, the same points in the model and on the head, A at least 5 and not in a plane. Throws
    /// InvalidInput.
    PointWarp(PointsIn from, PointsIn to);
    Points operator()(PointsIn points) const;

private:
    Points from_;
    Eigen::MatrixXd weights_;  // (A + 4) x 3
};

/// Displacement field around points: each moves skin within the radius, in proportion to its nearness; where
/// several overlap, their mean weighted by nearness, and no more than each alone. vertices: V x 3;
/// is_skin: V, others stay; places, displacements: K x 3, all metres. Throws InvalidInput.
Points displacement_about(PointsIn vertices, const std::vector<bool>& is_skin, PointsIn places,
                          PointsIn displacements, double radius);

/// How much each vertex belongs to places, 0 to 1: the largest nearness to any of K x 3 places.
Eigen::VectorXd nearness_to(PointsIn vertices, const std::vector<bool>& is_skin, PointsIn places,
                            double radius);

/// How much each vertex belongs to the left side, x above 0: half in the middle, all of it a margin (metres,
/// above 0) aside, smooth between, so that the two sides add up to the whole.
Eigen::VectorXd left_share(PointsIn vertices, double margin);

}  // namespace mimetic
