// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/spread.hpp>

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

}  // namespace mimetic
