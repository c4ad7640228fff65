// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/skin/galerkin_product.hpp"

#include <gtest/gtest.h>

#include "../../../native/src/skin/skin_assembly.hpp"
#include "shapes.hpp"

namespace mimetic {
namespace {

TEST(GalerkinProduct, IsTheProductOfThreeMatrices) {
    const Shell shell = make_pebble(2);
    const Eigen::Index count = shell.vertices.rows();
    const auto elements = make_skin_triangles(shell.vertices, shell.triangles);
    const Columns nodal = assemble_membrane(elements, shell.triangles, make_materials(count));
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
    const Eigen::MatrixXd expected = interleaved.transpose() * nodal * interleaved;
    const Eigen::MatrixXd product = galerkin_product(nodal, basis);
    EXPECT_LT((product - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
    EXPECT_GT(expected.cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace mimetic
