// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/skin/galerkin_product.hpp"

#include <gtest/gtest.h>

#include "../../../native/src/skin/skin_assembly.hpp"
#include "shapes.hpp"

namespace mimetic {
namespace {

Eigen::MatrixXd dense(const BlockRows& matrix) {
    const int count = matrix.columns.size();
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    for (int row = 0; row < count; ++row) {
        for (int i = matrix.columns.start[row]; i < matrix.columns.start[row + 1]; ++i) {
            result.block<3, 3>(3 * row, 3 * matrix.columns.vertex[i]) = matrix.blocks[i];
        }
    }
    return result;
}

TEST(BlockRows, OfTheSecondRingsHoldBendingWhole) {
    const Shell shell = make_pebble(1);
    const Eigen::Index count = shell.vertices.rows();
    const auto elements = make_skin_triangles(shell.vertices, shell.triangles);
    const VertexLists rings = vertex_rings(shell.triangles, count);
    const Points change =
        curvature_change(elements, shell.triangles, make_frames(elements, shell.triangles, count), rings);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, 3 * count);
    for (int v = 0; v < count; ++v) {
        for (int i = rings.start[v]; i < rings.start[v + 1]; ++i) {
            rows.block<1, 3>(v, 3 * rings.vertex[i]) = change.row(i);
        }
    }
    const Eigen::VectorXd flexures = Eigen::VectorXd::LinSpaced(count, 1, 2);
    BlockRows nodal(second_rings(rings));
    add_bending(change, flexures, rings, nodal);
    const Eigen::MatrixXd expected = rows.transpose() * flexures.asDiagonal() * rows;
    EXPECT_LT((dense(nodal) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
    EXPECT_GT(expected.cwiseAbs().maxCoeff(), 0);
}

TEST(GalerkinProduct, IsTheProductOfThreeMatrices) {
    const Shell shell = make_pebble(2);
    const Eigen::Index count = shell.vertices.rows();
    const auto elements = make_skin_triangles(shell.vertices, shell.triangles);
    const SkinMaterials materials = make_materials(count);
    const VertexFrames frames = make_frames(elements, shell.triangles, count);
    const VertexLists rings = vertex_rings(shell.triangles, count);
    BlockRows nodal(second_rings(rings));
    add_membrane(elements, shell.triangles, materials, nodal);
    add_bending(curvature_change(elements, shell.triangles, frames, rings),
                flexure(materials, frames, std::vector<bool>(static_cast<std::size_t>(count), false)), rings,
                nodal);
    SparseRows basis(count, count / 3);  // some vertices are held, others follow three unknowns each
    std::vector<Eigen::Triplet<double>> entries;
    for (int vertex = 0; vertex < count; ++vertex) {
        for (int k = 0; k < vertex % 4; ++k) {
            entries.emplace_back(vertex, (7 * vertex + 5 * k) % static_cast<int>(basis.cols()),
                                 0.3 + 0.1 * k);
        }
    }
    basis.setFromTriplets(entries.begin(), entries.end());
    const Columns interleaved = interleave(basis);
    const Eigen::MatrixXd expected = interleaved.transpose() * dense(nodal) * interleaved;
    const Eigen::MatrixXd product = galerkin_product(nodal, basis);
    EXPECT_LT((product - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
    EXPECT_GT(expected.cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace mimetic
