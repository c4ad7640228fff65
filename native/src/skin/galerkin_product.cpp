// SPDX-License-Identifier: GPL-3.0-or-later
#include "galerkin_product.hpp"

#include <algorithm>
#include <vector>

namespace mimetic {
namespace {

using Columns = Eigen::SparseMatrix<double>;

/// Blocks of the lower triangle by columns; in each column rows rise.
struct LowerBlocks {
    std::vector<std::vector<int>> rows;
    std::vector<std::vector<Eigen::Matrix3d>> blocks;
};

/// Unknowns that act on a vertex or its neighbours, rising, for each vertex that is not held.
std::vector<std::vector<int>> unknowns_around(const VertexLists& columns, const SparseRows& basis) {
    std::vector<std::vector<int>> around(basis.rows());
    std::vector<int> last(basis.cols(), -1);
    for (int vertex = 0; vertex < static_cast<int>(basis.rows()); ++vertex) {
        if (!SparseRows::InnerIterator(basis, vertex)) {
            continue;
        }
        for (const int other : columns.of(vertex)) {
            for (SparseRows::InnerIterator it(basis, other); it; ++it) {
                if (last[it.col()] != vertex) {
                    last[it.col()] = vertex;
                    around[vertex].push_back(static_cast<int>(it.col()));
                }
            }
        }
        std::sort(around[vertex].begin(), around[vertex].end());
    }
    return around;
}

LowerBlocks empty_blocks(const SparseRows& basis, const std::vector<std::vector<int>>& around) {
    LowerBlocks lower;
    lower.rows.resize(basis.cols());
    lower.blocks.resize(basis.cols());
    const Columns by_unknown = basis;
    std::vector<int> last(basis.cols(), -1);
    for (int column = 0; column < static_cast<int>(basis.cols()); ++column) {
        std::vector<int>& rows = lower.rows[column];
        for (Columns::InnerIterator it(by_unknown, column); it; ++it) {
            for (const int row : around[it.row()]) {
                if (row >= column && last[row] != column) {
                    last[row] = column;
                    rows.push_back(row);
                }
            }
        }
        std::sort(rows.begin(), rows.end());
        lower.blocks[column].assign(rows.size(), Eigen::Matrix3d::Zero());
    }
    return lower;
}

/// Adds basis^T (columns of blocks of one vertex) basis.
void add_vertex(const std::vector<int>& rows, const std::vector<Eigen::Matrix3d>& reduced,
                const SparseRows& basis, int vertex, LowerBlocks& lower) {
    for (SparseRows::InnerIterator it(basis, vertex); it; ++it) {
        const std::vector<int>& places = lower.rows[it.col()];
        std::vector<Eigen::Matrix3d>& blocks = lower.blocks[it.col()];
        std::size_t place = 0;
        for (auto row = std::lower_bound(rows.begin(), rows.end(), static_cast<int>(it.col()));
             row != rows.end(); ++row) {
            while (places[place] < *row) {
                ++place;
            }
            blocks[place] += it.value() * reduced[*row];
        }
    }
}

/// Both triangles as a scalar matrix.
Columns whole(const LowerBlocks& lower) {
    struct Entry {
        int row;
        const Eigen::Matrix3d* block;
        bool transposed;
    };
    const auto count = static_cast<int>(lower.rows.size());
    std::vector<std::vector<Entry>> columns(count);
    Eigen::Index num_blocks = 0;
    for (int column = 0; column < count; ++column) {
        for (std::size_t k = 0; k < lower.rows[column].size(); ++k) {
            const int row = lower.rows[column][k];
            columns[column].push_back({row, &lower.blocks[column][k], false});
            num_blocks += row == column ? 1 : 2;
            if (row > column) {  // columns come in order, so each one's upper rows rise before its own
                columns[row].push_back({column, &lower.blocks[column][k], true});
            }
        }
    }
    Columns result(3 * count, 3 * count);
    result.reserve(9 * num_blocks);
    for (int column = 0; column < 3 * count; ++column) {
        result.startVec(column);
        for (const Entry& entry : columns[column / 3]) {
            for (int axis = 0; axis < 3; ++axis) {
                result.insertBack(3 * entry.row + axis, column) =
                    entry.transposed ? (*entry.block)(column % 3, axis) : (*entry.block)(axis, column % 3);
            }
        }
    }
    result.finalize();
    return result;
}

}  // namespace

Columns galerkin_product(const BlockRows& nodal, const SparseRows& basis) {
    const std::vector<std::vector<int>> around = unknowns_around(nodal.columns, basis);
    LowerBlocks lower = empty_blocks(basis, around);
    std::vector<Eigen::Matrix3d> reduced(basis.cols());
    for (int vertex = 0; vertex < static_cast<int>(basis.rows()); ++vertex) {
        for (const int row : around[vertex]) {
            reduced[row].setZero();
        }
        if (around[vertex].empty()) {
            continue;
        }
        // The column of a symmetric matrix is its row, each block transposed
        for (int i = nodal.columns.start[vertex]; i < nodal.columns.start[vertex + 1]; ++i) {
            for (SparseRows::InnerIterator it(basis, nodal.columns.vertex[i]); it; ++it) {
                reduced[it.col()] += it.value() * nodal.blocks[i].transpose();
            }
        }
        add_vertex(around[vertex], reduced, basis, vertex, lower);
    }
    return whole(lower);
}

}  // namespace mimetic
