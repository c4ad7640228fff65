// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/edge_loop.hpp>
#include <string>

namespace mimetic {

namespace {

/// Faces round a vertex, and its neighbours.
struct Ring {
    std::vector<Eigen::Index> faces;
    std::vector<int> neighbours;
};

bool has(const std::vector<int>& vertices, int vertex) {
    return std::find(vertices.begin(), vertices.end(), vertex) != vertices.end();
}

Ring ring_of(QuadsIn faces, int vertex) {
    Ring ring;
    for (Eigen::Index face = 0; face < faces.rows(); ++face) {
        for (int corner = 0; corner < 4; ++corner) {
            if (faces(face, corner) != vertex) {
                continue;
            }
            ring.faces.push_back(face);
            for (const int other : {faces(face, (corner + 1) % 4), faces(face, (corner + 3) % 4)}) {
                if (!has(ring.neighbours, other)) {
                    ring.neighbours.push_back(other);
                }
            }
        }
    }
    return ring;
}

}  // namespace

std::vector<int> edge_loop(QuadsIn faces, int from, int over) {
    Ring ring = ring_of(faces, over);
    if (!has(ring.neighbours, from)) {
        throw InvalidInput("vertices " + std::to_string(from) + " and " + std::to_string(over) +
                           " are not ends of one edge");
    }
    std::vector<int> loop{from, over};
    while (ring.faces.size() == 4 && ring.neighbours.size() == 4) {
        const int before = loop[loop.size() - 2];
        int next = -1;
        for (const int neighbour : ring.neighbours) {
            const bool shares = std::any_of(ring.faces.begin(), ring.faces.end(), [&](Eigen::Index face) {
                const auto corners = faces.row(face).array();
                return (corners == before).any() && (corners == neighbour).any();
            });
            next = shares ? next : neighbour;
        }
        if (next < 0 || has(loop, next)) {
            break;
        }
        loop.push_back(next);
        ring = ring_of(faces, next);
    }
    return loop;
}

}  // namespace mimetic
