// SPDX-License-Identifier: GPL-3.0-or-later
#include "cholesky.hpp"

#include <mutex>
#include <utility>
#include <vector>

namespace mimetic {
namespace {

using Columns = Eigen::SparseMatrix<double>;

/// The points in the order of elimination; empty if CHOLMOD has no nested dissection.
std::vector<int> order_points(const Columns& matrix, cholmod_common& common) {
    const auto count = static_cast<std::size_t>(matrix.cols() / 3);
    std::vector<int> start{0}, rows;
    start.reserve(count + 1);
    rows.reserve(static_cast<std::size_t>(matrix.nonZeros()) / 18 + count);
    for (int column = 0; column < static_cast<int>(count); ++column) {
        for (Columns::InnerIterator it(matrix, 3 * column); it; ++it) {
            if (it.row() % 3 == 0 && it.row() >= 3 * column) {
                rows.push_back(static_cast<int>(it.row()) / 3);
            }
        }
        start.push_back(static_cast<int>(rows.size()));
    }
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = count;
    graph.nzmax = rows.size();
    graph.p = start.data();
    graph.i = rows.data();
    graph.stype = -1;  // the lower triangle
    graph.itype = CHOLMOD_INT;
    graph.xtype = CHOLMOD_PATTERN;
    graph.dtype = CHOLMOD_DOUBLE;
    graph.sorted = graph.packed = 1;
    std::vector<int> order(count), parents(count), components(count);
    // METIS draws from random numbers of the C library, which it seeds anew at each call: two at once would
    // take each other's, and the factors, with all that is computed by them, would differ from run to run.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const auto num_components = cholmod_nested_dissection(&graph, nullptr, 0, order.data(), parents.data(),
                                                          components.data(), &common);
    return num_components < 0 ? std::vector<int>{} : order;
}

}  // namespace

void BlockCholesky::compute_blocks(const Columns& matrix) {
    std::vector<int> order;
    order.reserve(static_cast<std::size_t>(matrix.cols()));
    for (const int point : order_points(matrix, cholmod())) {
        order.insert(order.end(), {3 * point, 3 * point + 1, 3 * point + 2});
    }
    if (order.empty()) {
        Cholesky::compute(matrix);
        return;
    }
    if (m_cholmodFactor != nullptr) {
        cholmod_free_factor(&m_cholmodFactor, &cholmod());
    }
    cholmod_sparse lower = Eigen::viewAsCholmod(matrix.selfadjointView<Eigen::Lower>());
    const int usual = std::exchange(cholmod().method[0].ordering, CHOLMOD_GIVEN);
    m_cholmodFactor = cholmod_analyze_p(&lower, order.data(), nullptr, 0, &cholmod());
    cholmod().method[0].ordering = usual;
    m_isInitialized = true;
    m_info = Eigen::Success;
    m_analysisIsOk = true;
    m_factorizationIsOk = false;
    factorize(matrix);
}

}  // namespace mimetic
