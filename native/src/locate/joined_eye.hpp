// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/feature_networks.hpp>

#include "point_regressor.hpp"

namespace mimetic::locate {

inline constexpr int kEyeSide = 64;  ///< pixels of an eye's picture, for the network and the regressor

/// The points of an eye's regressor: both margins from the outer to the inner corner, then the iris.
struct RegressedEye {
    static constexpr int kMargin = static_cast<int>(LidMargins::kUpper.size());
    static constexpr int kPoints = 2 * kMargin + EyePoints::kIris;
    static constexpr int kGroups = 3;  ///< upper lid, lower lid, iris
};

/// Times its usual error: how far off a regressor's lids or iris are, by what it expects for them. In blocky
/// footage, where it expects more, its bias is larger, too.
double lid_doubt(double spread);
double iris_doubt(double spread);

/// The iris network's points, between the corners the lids' margins joined with a regressor's, by the errors
/// of both; all in sides of the crop. side: of the crop, pixels.
EyePoints joined_eye(const EyePoints& by_network, const RegressedPoints& regressed, double side);

}  // namespace mimetic::locate
