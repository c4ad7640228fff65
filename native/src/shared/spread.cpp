// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/spread.hpp>
#include <utility>

namespace mimetic {

std::vector<int> spread_rows(MatrixIn rows, const std::vector<int>& first, const std::vector<bool>& allowed,
                             int count, double least) {
    const Eigen::Index size = rows.rows();
    if (first.empty() || static_cast<Eigen::Index>(allowed.size()) != size) {
        throw InvalidInput("rows well apart need a first one, and to be told of each whether it is allowed");
    }
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(size, std::numeric_limits<double>::infinity());
    const auto take = [&](int row) {
        if (row < 0 || row >= size) {
            throw InvalidInput("row " + std::to_string(row) + " is not one of " + std::to_string(size));
        }
        for (Eigen::Index i = 0; i < size; ++i) {
            distance[i] = std::min(distance[i], (rows.row(i) - rows.row(row)).norm());
        }
    };
    std::vector<int> chosen = first;
    for (const int row : first) {
        take(row);
    }
    for (Eigen::Index i = 0; i < size; ++i) {
        if (!allowed[static_cast<std::size_t>(i)]) {
            distance[i] = -1;
        }
    }
    while (static_cast<int>(chosen.size()) < count) {
        Eigen::Index farthest = 0;
        const double away = distance.maxCoeff(&farthest);
        if (!(away > 0) || away < least) {
            break;
        }
        chosen.push_back(static_cast<int>(farthest));
        take(chosen.back());
    }
    return chosen;
}

Points drawn_apart(PointsIn points, double least) {
    if (!(least >= 0) || !points.allFinite()) {
        throw InvalidInput("points are drawn apart by a distance of at least 0, and have finite places");
    }
    constexpr int kMostSweeps = 500;
    constexpr double kNearlyAll = .999, kMiddle = .1;
    Points apart = points;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        Points moved = apart;
        for (Eigen::Index i = 0; i < apart.rows(); ++i) {
            for (Eigen::Index j = i + 1; j < apart.rows(); ++j) {
                const Eigen::Vector2d between(apart(j, 0) - apart(i, 0), apart(j, 2) - apart(i, 2));
                const double distance = between.norm();
                if (distance >= kNearlyAll * least) {
                    continue;
                }
                // At one place the later one goes down
                const Eigen::Vector2d way =
                    distance > 0 ? Eigen::Vector2d(between / distance) : -Eigen::Vector2d::UnitY();
                const Eigen::Vector2d step = .25 * (least - distance) * way;
                for (const auto& [row, sign] : {std::pair(i, -1.), std::pair(j, 1.)}) {
                    const bool is_middle = std::abs(points(row, 0)) < kMiddle * least;
                    moved(row, 0) += is_middle ? 0 : sign * step[0];
                    moved(row, 2) += sign * step[1];
                }
            }
        }
        if (moved == apart) {
            break;
        }
        apart = moved;
    }
    return apart;
}

}  // namespace mimetic
