// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <mimetic/muscles/skin_modes.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kSweeps = 3;

/// The same space; by Cholesky, a fifth of the time of a QR, unless columns are nearly dependent.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    products.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
    const Eigen::LLT<Eigen::MatrixXd> root(products);
    constexpr double kLeastCondition = 1e-12;
    if (root.info() == Eigen::Success && root.rcond() > kLeastCondition) {
        return root.matrixU().solve<Eigen::OnTheRight>(columns);
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns);
    return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
}

/// The weights of the unknowns: B^T W B.
Eigen::SparseMatrix<double> weights_of_unknowns(const SkinModel& model, PointsIn weight) {
    const Eigen::Map<const Eigen::VectorXd> weights(weight.data(), weight.size());
    const Eigen::SparseMatrix<double> weighted = weights.cwiseSqrt().asDiagonal() * model.basis();
    return weighted.transpose() * weighted;
}

}  // namespace

SkinModes low_energy_modes(const AttachedSkin& skin, PointsIn weight,
                           const Eigen::Ref<const Eigen::MatrixXd>& start, int count, double unit) {
    const SkinModel& model = skin.model();
    if (weight.rows() != model.num_vertices() || start.rows() != 3 * model.num_unknowns() || count < 1 ||
        start.cols() < count || start.cols() > start.rows()) {
        throw InvalidInput("weight is " + std::to_string(weight.rows()) + " x 3 and start " +
                           std::to_string(start.rows()) + " x " + std::to_string(start.cols()) +
                           ", which do not fit " + std::to_string(count) + " modes of a skin of " +
                           std::to_string(model.num_vertices()) + " vertices");
    }
    const Eigen::SparseMatrix<double> weights = weights_of_unknowns(model, weight);
    Eigen::MatrixXd basis = start;
    Eigen::MatrixXd loads;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        basis = orthonormal(basis);
        loads = weights * basis;
        basis = model.solve_loads(loads);
    }
    const Eigen::MatrixXd seen = basis.transpose() * (weights * basis);
    const Eigen::MatrixXd energy = basis.transpose() * loads;
    const Eigen::LLT<Eigen::MatrixXd> root((energy + energy.transpose()) / 2);
    const Eigen::MatrixXd half = root.matrixL().solve((seen + seen.transpose()) / 2);
    const Eigen::MatrixXd inner = root.matrixL().solve(half.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen((inner + inner.transpose()) / 2);
    const Eigen::VectorXd compliance = eigen.eigenvalues().reverse().head(count);
    const Eigen::MatrixXd vectors = eigen.eigenvectors().rowwise().reverse().leftCols(count);
    // A mode of unit energy moves the skin by the root of its compliance, root mean square
    const Eigen::MatrixXd chosen =
        basis * root.matrixU().solve(vectors) * (unit * compliance.cwiseSqrt().cwiseInverse()).asDiagonal();
    return {skin.on_control_vertices(chosen), compliance};
}

}  // namespace mimetic
