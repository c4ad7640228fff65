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

}  // namespace mimetic
