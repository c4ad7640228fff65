// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/CholmodSupport>

namespace mimetic {

/// CHOLMOD's supernodal factor, set up for these meshes and silent.
class Cholesky : public Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> {
public:
    Cholesky() {
        cholmod().print = 0;     // CHOLMOD writes warnings to the terminal by default
        cholmod().nmethods = 1;  // trying the other orderings costs more than the best of them saves
        cholmod().method[0].ordering = CHOLMOD_AMD;
    }
};

/// The same for a matrix over points, whose entries come in whole 3 x 3 blocks. What is ordered is the
/// points, a ninth of the graph, by nested dissection: that leaves less to compute than AMD does, and would
/// cost more than it saves on the whole graph.
class BlockCholesky : public Cholesky {
public:
    /// matrix: 3C x 3C, symmetric, xyz interleaved, both triangles.
    void compute_blocks(const Eigen::SparseMatrix<double>& matrix);
};

}  // namespace mimetic
