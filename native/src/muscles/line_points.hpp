// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Points along straight pieces between corners, so close to each other that they snap to neighbouring
/// vertices. spacing: metres at most.
inline Points line_points(const Points& corners, double spacing) {
    std::vector<Eigen::RowVector3d> samples{corners.row(0)};
    for (Eigen::Index i = 1; i < corners.rows(); ++i) {
        const Eigen::RowVector3d step = corners.row(i) - corners.row(i - 1);
        const int count = std::max(1, static_cast<int>(std::ceil(step.norm() / spacing)));
        for (int k = 1; k <= count; ++k) {
            samples.emplace_back(corners.row(i - 1) + step * (static_cast<double>(k) / count));
        }
    }
    Points points(samples.size(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        points.row(i) = samples[i];
    }
    return points;
}

}  // namespace mimetic
