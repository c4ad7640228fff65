// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <mimetic/raster/quad_edges.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {

QuadEdges::QuadEdges(QuadsIn faces, Eigen::Index num_vertices) : faces_(faces) {
    if (faces_.size() > 0 && (faces_.minCoeff() < 0 || faces_.maxCoeff() >= num_vertices)) {
        throw InvalidInput("a face names a vertex outside 0 to " + std::to_string(num_vertices - 1));
    }
    std::map<std::pair<int, int>, std::size_t> known;
    for (int f = 0; f < faces_.rows(); ++f) {
        for (int k = 0; k < 4; ++k) {
            const auto ends = std::minmax(faces_(f, k), faces_(f, (k + 1) % 4));
            const auto [place, is_new] = known.emplace(std::pair(ends.first, ends.second), edges_.size());
            if (is_new) {
                edges_.push_back({ends.first, ends.second, {f, -1}});
            } else {
                edges_[place->second].faces[1] = f;
            }
        }
    }
}

std::vector<bool> QuadEdges::turned_to_camera(PointsIn vertices_in_camera) const {
    std::vector<bool> turned(static_cast<std::size_t>(faces_.rows()));
    for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
        const auto at = [&](int k) { return Eigen::Vector3d(vertices_in_camera.row(faces_(f, k))); };
        const Eigen::Vector3d normal = (at(2) - at(0)).cross(at(3) - at(1));
        turned[static_cast<std::size_t>(f)] = normal.dot(at(0)) < 0;
    }
    return turned;
}

}  // namespace mimetic
