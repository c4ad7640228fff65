// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/attach.hpp>

namespace mimetic {

/// Compliant modes of a skin: large displacement for little elastic energy.
struct SkinModes {
    MatrixRows modes;            ///< K x 3S, metres at the coefficient 1, of the control vertices
    Eigen::VectorXd compliance;  ///< K, falling
};

/// The `count` modes with the largest ratio of weighted square displacement to energy, by subspace iteration.
/// At the coefficient 1 each moves the skin by `unit` metres, root mean square of the weights.
///
/// weight: N x 3, of each vertex's displacement along x, y and z, sums to 1; start: 3U x C with C > count,
/// random columns. Throws InvalidInput if the sizes do not fit.
SkinModes low_energy_modes(const AttachedSkin& skin, PointsIn weight,
                           const Eigen::Ref<const Eigen::MatrixXd>& start, int count, double unit);

}  // namespace mimetic
