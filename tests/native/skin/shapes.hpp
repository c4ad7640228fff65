// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <mimetic/skin/skin.hpp>
#include <mimetic/surface/surface.hpp>
#include <vector>

namespace mimetic {

struct Shell {
    Points vertices;
    Triangles triangles;
};

/// A flat rectangle of columns x rows quads, each cut in two, diagonals alternating.
inline Shell make_rectangle(double width, double height, int columns, int rows) {
    Shell shell{Points((columns + 1) * (rows + 1), 3), Triangles(2 * columns * rows, 3)};
    for (int i = 0; i < shell.vertices.rows(); ++i) {
        const int column = i % (columns + 1);
        const int row = i / (columns + 1);
        shell.vertices.row(i) << width * column / columns, height * row / rows, 0;
    }
    for (int f = 0; f < columns * rows; ++f) {
        const int column = f % columns;
        const int row = f / columns;
        const int a = row * (columns + 1) + column;
        const int b = a + 1;
        const int c = b + columns + 1;
        const int d = c - 1;
        if ((row + column) % 2 == 0) {
            shell.triangles.middleRows<2>(2 * f) << a, b, c, a, c, d;
        } else {
            shell.triangles.middleRows<2>(2 * f) << a, b, d, b, c, d;
        }
    }
    return shell;
}

/// A cube rounded by subdivision: closed and curved everywhere.
inline Shell make_pebble(int levels) {
    Points corners(8, 3);
    for (int i = 0; i < 8; ++i) {
        corners.row(i) << (i & 1 ? 0.06 : -0.06), (i & 2 ? 0.05 : -0.05), (i & 4 ? 0.04 : -0.04);
    }
    Quads quads(6, 4);
    quads << 0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5;
    const SubdividedMesh mesh(quads, 8, levels);
    Shell shell{mesh.positions(corners), Triangles(2 * mesh.faces().rows(), 3)};
    for (int f = 0; f < mesh.faces().rows(); ++f) {
        const Eigen::RowVector4i q = mesh.faces().row(f);
        shell.triangles.middleRows<2>(2 * f) << q[0], q[1], q[2], q[0], q[2], q[3];
    }
    return shell;
}

inline SkinMaterials make_materials(Eigen::Index count) {
    const auto all = [&](double value) -> Eigen::VectorXd { return Eigen::VectorXd::Constant(count, value); };
    return {all(40e3), all(0.3), all(1.5e-3), all(0), all(0), all(0)};
}

/// Identity without the columns of held vertices.
inline SparseRows make_basis(Eigen::Index count, const std::vector<bool>& held = {}) {
    std::vector<Eigen::Triplet<double>> entries;
    int column = 0;
    for (int v = 0; v < count; ++v) {
        if (held.empty() || !held[v]) {
            entries.emplace_back(v, column++, 1.0);
        }
    }
    SparseRows basis(count, column);
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
}

inline Eigen::VectorXd flatten(const Points& points) {
    return Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
}

}  // namespace mimetic
