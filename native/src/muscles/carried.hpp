// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/skin_mesh.hpp>

namespace mimetic {

/// Where a point of the template lies on the person, as seen from the middle of control vertices.
inline Eigen::RowVector3d carried(const SkinMesh& mesh, const Eigen::RowVector3d& point,
                                  const std::vector<int>& vertices) {
    const auto middle = [&](const Points& of) -> Eigen::RowVector3d {
        return of(vertices, Eigen::all).colwise().mean();
    };
    return middle(mesh.neutral()) + mesh.size() * (point - middle(mesh.head().vertices));
}

}  // namespace mimetic
