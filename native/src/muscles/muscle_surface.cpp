// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/error.hpp>
#include <queue>
#include <string>
#include <utility>

namespace mimetic {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

MuscleSurface::MuscleSurface(PointsIn vertices, TrianglesIn triangles, const std::vector<bool>& carries)
    : vertices_(vertices),
      normals_(Points::Zero(vertices.rows(), 3)),
      areas_(Eigen::VectorXd::Zero(vertices.rows())),
      links_(vertices.rows()) {
    if (static_cast<Eigen::Index>(carries.size()) != triangles.rows()) {
        throw InvalidInput("carries has " + std::to_string(carries.size()) + " entries for " +
                           std::to_string(triangles.rows()) + " triangles");
    }
    const auto num_carrying = std::count(carries.begin(), carries.end(), true);
    if (num_carrying == 0) {
        throw InvalidInput("no triangle carries muscles");
    }
    triangles_.resize(num_carrying, 3);
    std::map<std::pair<int, int>, int> opposite;  // of each edge, in the first triangle that has it
    const auto connect = [&](int a, int b) {
        const double length = (vertices_.row(a) - vertices_.row(b)).norm();
        links_[a].push_back({b, length});
        links_[b].push_back({a, length});
    };
    Eigen::Index row = 0;
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        if (!carries[f]) {
            continue;
        }
        if (triangles.row(f).minCoeff() < 0 || triangles.row(f).maxCoeff() >= vertices.rows()) {
            throw InvalidInput("face " + std::to_string(f) + " names a vertex that the skin does not have");
        }
        triangles_.row(row++) = triangles.row(f);
        const Eigen::RowVector3d a = vertices_.row(triangles(f, 0));
        const Eigen::RowVector3d cross =
            (vertices_.row(triangles(f, 1)) - a).cross(vertices_.row(triangles(f, 2)) - a);
        for (int k = 0; k < 3; ++k) {
            const int from = triangles(f, k);
            const int to = triangles(f, (k + 1) % 3);
            const int third = triangles(f, (k + 2) % 3);
            normals_.row(from) += cross;
            areas_[from] += cross.norm() / 6;
            const auto [entry, is_new] = opposite.try_emplace(std::minmax(from, to), third);
            if (is_new) {
                connect(from, to);
            } else {
                connect(entry->second,
                        third);  // across the edge: otherwise distances depend on the mesh's directions
            }
        }
    }
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
        normals_.row(v) /= std::max(normals_.row(v).norm(), std::numeric_limits<double>::min());
    }
}

Eigen::VectorXd MuscleSurface::distances(PointsIn sources, double limit) const {
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(vertices_.rows(), kInfinity);
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto offer = [&](int vertex, double d) {
        if (d < distance[vertex] && d <= limit) {
            distance[vertex] = d;
            queue.emplace(d, vertex);
        }
    };
    for (Eigen::Index s = 0; s < sources.rows(); ++s) {
        Eigen::VectorXd squared = (vertices_.rowwise() - sources.row(s)).rowwise().squaredNorm();
        for (Eigen::Index v = 0; v < squared.size(); ++v) {
            squared[v] = links_[v].empty() ? kInfinity : squared[v];
        }
        Eigen::Index nearest = 0;
        squared.minCoeff(&nearest);
        offer(static_cast<int>(nearest), std::sqrt(squared[nearest]));
        for (const Link& link : links_[nearest]) {
            offer(link.to, std::sqrt(squared[link.to]));
        }
    }
    while (!queue.empty()) {
        const auto [d, vertex] = queue.top();
        queue.pop();
        if (d > distance[vertex]) {
            continue;
        }
        for (const Link& link : links_[vertex]) {
            offer(link.to, d + link.length);
        }
    }
    return distance;
}

}  // namespace mimetic
