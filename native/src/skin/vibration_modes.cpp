// SPDX-License-Identifier: GPL-3.0-or-later
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <numbers>
#include <string>

#include "cholesky.hpp"

namespace mimetic {
namespace {

/// Product with the inverse of the stiffness, as Spectra asks for it; the shift is always zero.
class InverseStiffness {
public:
    using Scalar = double;
    explicit InverseStiffness(const Cholesky& factor, Eigen::Index size) : factor_(factor), size_(size) {}
    Eigen::Index rows() const { return size_; }
    Eigen::Index cols() const { return size_; }
    void set_shift(double) {}
    void perform_op(const double* in, double* out) const {
        Eigen::Map<Eigen::VectorXd>(out, size_) =
            factor_.solve(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(in, size_)));
    }

private:
    const Cholesky& factor_;
    Eigen::Index size_;
};

}  // namespace

VibrationModes vibration_modes(const Eigen::SparseMatrix<double>& stiffness,
                               const Eigen::SparseMatrix<double>& mass, int num_modes) {
    const Eigen::Index size = stiffness.rows();
    if (mass.rows() != size) {
        throw InvalidInput("stiffness has " + std::to_string(size) + " rows, mass has " +
                           std::to_string(mass.rows()));
    }
    check_range("num_modes", num_modes, 1, static_cast<double>(size - 1));
    Cholesky factor;
    factor.compute(stiffness);
    if (factor.info() != Eigen::Success) {
        throw InvalidInput("the skin can move freely: attach it to bone or hold some of its vertices");
    }
    InverseStiffness inverse(factor, size);
    Spectra::SparseSymMatProd<double> product(mass);
    // Twice as many Lanczos vectors as modes, and some for the few-mode case
    const Eigen::Index num_vectors = std::min<Eigen::Index>(size, 2 * num_modes + 20);
    Spectra::SymGEigsShiftSolver<InverseStiffness, decltype(product), Spectra::GEigsMode::ShiftInvert> solver(
        inverse, product, num_modes, num_vectors, 0.0);
    solver.init();
    solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-10, Spectra::SortRule::SmallestAlge);
    if (solver.info() != Spectra::CompInfo::Successful) {
        throw InvalidInput("the modes did not converge: stiffness or mass is badly scaled");
    }
    VibrationModes modes;
    modes.frequencies = solver.eigenvalues().array().sqrt() / (2 * std::numbers::pi);
    modes.shapes = solver.eigenvectors();
    return modes;
}

}  // namespace mimetic
