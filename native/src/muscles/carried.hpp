// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/skin_mesh.hpp>

namespace mimetic {

/// A point of the template carried to the person, relative to the mean of control vertices.
inline Eigen::RowVector3d carried(const SkinMesh& mesh, const Eigen::RowVector3d& point,
                                  const std::vector<int>& vertices) {
    const auto middle = [&](const Points& of) -> Eigen::RowVector3d {
        return of(vertices, Eigen::all).colwise().mean();
    };
    return middle(mesh.neutral()) + mesh.size() * (point - middle(mesh.head().vertices));
}

}  // namespace mimetic
