// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

namespace mimetic::validation {

bool Grid::on_edge(int vertex) const {
    const int column = vertex % (columns + 1);
    const int row = vertex / (columns + 1);
    return column == 0 || column == columns || row == 0 || row == rows;
}

Grid make_grid(int columns, int rows, const Place& place) {
    Grid grid{columns, rows, Points((columns + 1) * (rows + 1), 3), Triangles(2 * columns * rows, 3)};
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            grid.vertices.row(grid.at(column, row)) =
                place(static_cast<double>(column) / columns, static_cast<double>(row) / rows);
        }
    }
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int a = grid.at(column, row);
            const int b = grid.at(column + 1, row);
            const int c = grid.at(column + 1, row + 1);
            const int d = grid.at(column, row + 1);
            const double ac = (grid.vertices.row(a) - grid.vertices.row(c)).norm();
            const double bd = (grid.vertices.row(b) - grid.vertices.row(d)).norm();
            auto halves = grid.triangles.middleRows<2>(2 * (row * columns + column));
            if (ac < (1 + 1e-9) * bd) {
                halves << a, b, c, a, c, d;
            } else {
                halves << a, b, d, b, c, d;
            }
        }
    }
    return grid;
}

void jitter(Grid& grid, double amount) {
    const Eigen::RowVector3d right = grid.vertices.row(1) - grid.vertices.row(0);
    const Eigen::RowVector3d up = grid.vertices.row(grid.columns + 1) - grid.vertices.row(0);
    for (int v = 0; v < grid.num_vertices(); ++v) {
        if (!grid.on_edge(v)) {
            grid.vertices.row(v) += amount * (std::sin(7.3 * v) * right + std::cos(5.1 * v) * up);
        }
    }
}

Eigen::VectorXd vertex_areas(PointsIn vertices, TrianglesIn triangles) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.rows());
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3d a = vertices.row(triangles(f, 0));
        const Eigen::RowVector3d ab = vertices.row(triangles(f, 1)) - a;
        const Eigen::RowVector3d ac = vertices.row(triangles(f, 2)) - a;
        for (int k = 0; k < 3; ++k) {
            areas[triangles(f, k)] += ab.cross(ac).norm() / 6;
        }
    }
    return areas;
}

SkinMaterials even_skin(Eigen::Index count, double young, double poisson, double thickness) {
    const auto all = [&](double value) -> Eigen::VectorXd { return Eigen::VectorXd::Constant(count, value); };
    return {all(young), all(poisson), all(thickness), all(0), all(0), all(0)};
}

std::vector<int> free_columns(const std::vector<bool>& held) {
    std::vector<int> columns(held.size(), -1);
    int next = 0;
    for (std::size_t v = 0; v < held.size(); ++v) {
        if (!held[v]) {
            columns[v] = next++;
        }
    }
    return columns;
}

SparseRows free_basis(const std::vector<bool>& held) {
    const std::vector<int> columns = free_columns(held);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t v = 0; v < held.size(); ++v) {
        if (columns[v] >= 0) {
            entries.emplace_back(static_cast<int>(v), columns[v], 1.0);
        }
    }
    SparseRows basis(held.size(), entries.size());
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
}

Eigen::VectorXd solve_prescribed(const Eigen::MatrixXd& stiffness, const std::vector<bool>& prescribed,
                                 const Eigen::VectorXd& values) {
    std::vector<Eigen::Index> free;
    Eigen::VectorXd all = values;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        if (!prescribed[i]) {
            free.push_back(i);
            all[i] = 0;
        }
    }
    const Eigen::VectorXd loads = -(stiffness * all)(free);
    const Eigen::MatrixXd inner = stiffness(free, free);
    const Eigen::VectorXd solution = inner.ldlt().solve(loads);
    all(free) = solution;
    return all;
}

}  // namespace mimetic::validation
