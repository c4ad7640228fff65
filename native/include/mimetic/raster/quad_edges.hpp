// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// The edges of a mesh of quads, each once, with the faces on its sides.
class QuadEdges {
public:
    struct Edge {
        int first, second;         ///< vertices
        std::array<int, 2> faces;  ///< the second is -1 on a boundary
    };

    /// faces: quads of `num_vertices` vertices. Throws InvalidInput on indices out of range.
    QuadEdges(QuadsIn faces, Eigen::Index num_vertices);

    const Quads& faces() const { return faces_; }
    const std::vector<Edge>& edges() const { return edges_; }

    /// Whether each face is turned to the camera, F. vertices_in_camera: V x 3, metres.
    std::vector<bool> turned_to_camera(PointsIn vertices_in_camera) const;
    /// Whether a face of the edge is turned to the camera.
    static bool is_turned(const Edge& edge, const std::vector<bool>& turned) {
        const auto is_so = [&turned](int face) {
            return face >= 0 && turned[static_cast<std::size_t>(face)];
        };
        return is_so(edge.faces[0]) || is_so(edge.faces[1]);
    }

private:
    Quads faces_;
    std::vector<Edge> edges_;
};

}  // namespace mimetic
