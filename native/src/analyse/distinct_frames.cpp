// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <mimetic/analyse/distinct_frames.hpp>
#include <mimetic/shared/error.hpp>
#include <set>

namespace mimetic {

std::vector<int> distinct_rows(MatrixIn table, const std::vector<bool>& usable, int first, int count) {
    if (first < 0 || first >= table.rows() || usable.size() != static_cast<std::size_t>(table.rows())) {
        throw InvalidInput("the first of the distinct rows is none of the table's");
    }
    std::set<int> chosen{first};
    Eigen::VectorXd distance =
        Eigen::VectorXd::Constant(table.rows(), std::numeric_limits<double>::infinity());
    for (int last = first; static_cast<int>(chosen.size()) < count;) {
        distance = distance.cwiseMin((table.rowwise() - table.row(last)).rowwise().norm());
        double largest = -1;
        int next = -1;
        for (int i = 0; i < static_cast<int>(table.rows()); ++i) {
            if (usable[static_cast<std::size_t>(i)] && !chosen.contains(i) && distance[i] > largest) {
                largest = distance[i];
                next = i;
            }
        }
        if (next < 0) {
            break;
        }
        chosen.insert(last = next);
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace mimetic
