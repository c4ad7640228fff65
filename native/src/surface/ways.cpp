// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/ways.hpp>
#include <queue>
#include <set>
#include <string>
#include <tuple>

namespace mimetic {

namespace {

using Neighbours = std::vector<std::set<int>>;

std::vector<int> way_between(const Neighbours& neighbours, PointsIn vertices, int start, int goal) {
    std::vector<int> before(neighbours.size(), -1);
    using Step = std::tuple<double, int, int>;  // length so far, vertex, vertex before
    std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
    queue.emplace(0, start, start);
    while (!queue.empty()) {
        const auto [length, vertex, last] = queue.top();
        queue.pop();
        if (before[static_cast<std::size_t>(vertex)] >= 0) {
            continue;
        }
        before[static_cast<std::size_t>(vertex)] = last;
        if (vertex == goal) {
            break;
        }
        for (const int other : neighbours[static_cast<std::size_t>(vertex)]) {
            if (before[static_cast<std::size_t>(other)] < 0) {
                queue.emplace(length + (vertices.row(other) - vertices.row(vertex)).norm(), other, vertex);
            }
        }
    }
    if (before[static_cast<std::size_t>(goal)] < 0) {
        throw InvalidInput("no way leads from vertex " + std::to_string(start) + " to " +
                           std::to_string(goal));
    }
    std::vector<int> way{goal};
    while (way.back() != start) {
        way.push_back(before[static_cast<std::size_t>(way.back())]);
    }
    return {way.rbegin(), way.rend()};
}

}  // namespace

std::vector<int> shortest_way(QuadsIn quads, PointsIn vertices, const std::vector<int>& stops) {
    const auto is_vertex = [&](int vertex) { return vertex >= 0 && vertex < vertices.rows(); };
    if (stops.empty() || !std::all_of(stops.begin(), stops.end(), is_vertex) ||
        (quads.size() > 0 && (quads.minCoeff() < 0 || quads.maxCoeff() >= vertices.rows()))) {
        throw InvalidInput("quads and stops must name vertices");
    }
    Neighbours neighbours(static_cast<std::size_t>(vertices.rows()));
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        for (int corner = 0; corner < 4; ++corner) {
            const int a = quads(f, corner), b = quads(f, (corner + 1) % 4);
            neighbours[static_cast<std::size_t>(a)].insert(b);
            neighbours[static_cast<std::size_t>(b)].insert(a);
        }
    }
    std::vector<int> all{stops.front()};
    for (std::size_t i = 1; i < stops.size(); ++i) {
        const std::vector<int> way = way_between(neighbours, vertices, stops[i - 1], stops[i]);
        all.insert(all.end(), way.begin() + 1, way.end());
    }
    return all;
}

Sphere nearest_sphere(PointsIn points) {
    if (points.rows() < 4) {
        throw InvalidInput("a sphere needs four points, got " + std::to_string(points.rows()));
    }
    Eigen::MatrixXd system(points.rows(), 4);
    system << 2 * points, Eigen::VectorXd::Ones(points.rows());
    const Eigen::Vector4d solved = system.colPivHouseholderQr().solve(points.rowwise().squaredNorm().eval());
    const Eigen::Vector3d centre = solved.head<3>();
    return {centre, std::sqrt(solved[3] + centre.squaredNorm())};
}

}  // namespace mimetic
