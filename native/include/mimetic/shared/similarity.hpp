// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// target = scale * rotation * source + shift.
struct Similarity {
    double scale = 1;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    bool is_mirror = false;  ///< whether the points align better with their mirror image

    Points apply(PointsIn points) const;        ///< K x 3
    Points turn(PointsIn displacements) const;  ///< K x 3: without the shift
    Similarity inverse() const;
};

/// The one that aligns source points (K x 3) with target ones, in least squares [Umeyama 1991].
Similarity fit_similarity(PointsIn source, PointsIn target);

/// Whether a pose is rigid: no scaling, no mirroring. rounding: of the entries of R R' - 1.
bool is_rigid(const Eigen::Matrix4d& pose, double rounding);

}  // namespace mimetic
