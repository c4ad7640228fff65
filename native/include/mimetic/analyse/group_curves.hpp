// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Means of several columns, with their standard deviations.
struct MeanCurves {
    MatrixRows values;             ///< N x G
    MatrixRows stds;               ///< N x G, columns taken as independent
    Eigen::VectorXd measured_std;  ///< G: mean s.d. of the columns themselves, which is what was smoothed
};

/// values, stds: N x M; members: G x M, 1 for the columns of each mean, 0 for others. A mean without members
/// is 0 with s.d. 0. Throws InvalidInput on other shapes.
MeanCurves mean_curves(MatrixIn values, MatrixIn stds, MatrixIn members);

}  // namespace mimetic
