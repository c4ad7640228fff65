// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <mimetic/locate/eigenspace.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

namespace mimetic {
namespace {

constexpr double kLeastDeviation = 1e-6;

void refuse(const std::string& what) { throw InvalidInput("eigenspace: " + what); }

/// Mean 0 and variance 1 in place; false if there is no contrast.
bool normalize(Eigen::Ref<Eigen::RowVectorXd> patch) {
    patch.array() -= patch.mean();
    const double deviation = std::sqrt(patch.squaredNorm() / static_cast<double>(patch.size()));
    if (!(deviation >= kLeastDeviation)) return false;
    patch /= deviation;
    return true;
}

double log_normalizer(const Eigenspace& space) {
    const auto n = static_cast<double>(space.mean.size());
    const double rest = n - static_cast<double>(space.eigenvalues.size());
    return -0.5 * (n * std::log(2 * std::numbers::pi) + space.eigenvalues.array().log().sum() +
                   rest * std::log(space.rho));
}

}  // namespace

void Eigenspace::check() const {
    if (width < 2 || height < 2 || width > 256 || height > 256)
        refuse("a patch is " + std::to_string(width) + " x " + std::to_string(height) +
               "; sides from 2 to 256 pixels are needed");
    const Eigen::Index n = width * height;
    const Eigen::Index m = basis.rows();
    if (mean.size() != n || basis.cols() != n || m < 1 || m >= n || eigenvalues.size() != m)
        refuse("mean " + std::to_string(mean.size()) + ", basis " + std::to_string(m) + " x " +
               std::to_string(basis.cols()) + " and eigenvalues " + std::to_string(eigenvalues.size()) +
               " do not fit a patch of " + std::to_string(n) + " values");
    if (!mean.allFinite() || !basis.allFinite()) refuse("mean or basis is not finite");
    if (!eigenvalues.allFinite() || !(eigenvalues.minCoeff() > 0) || !std::isfinite(rho) || !(rho > 0))
        refuse("eigenvalues and rho must be finite and above 0");
    const Eigen::MatrixXd gram = basis * basis.transpose();
    if (!(gram - Eigen::MatrixXd::Identity(m, m)).isZero(1e-5)) refuse("the basis is not orthonormal");
}

Eigenspace train_eigenspace(MatrixIn patches, int width, int height, int num_modes, double shrinkage) {
    const Eigen::Index n = static_cast<Eigen::Index>(width) * height;
    if (width < 2 || height < 2 || width > 256 || height > 256 || patches.cols() != n)
        refuse("patches have " + std::to_string(patches.cols()) + " values; " + std::to_string(width) +
               " x " + std::to_string(height) + " of 2 to 256 each are needed");
    if (num_modes < 1 || num_modes >= n || patches.rows() <= num_modes + 1)
        refuse(std::to_string(num_modes) + " modes need more than " + std::to_string(num_modes + 1) +
               " patches of more values; there are " + std::to_string(patches.rows()));
    if (!(shrinkage >= 0 && shrinkage <= 1)) refuse("shrinkage must be 0 to 1");
    if (!patches.allFinite()) refuse("patches are not finite");
    MatrixRows x = patches;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (!normalize(x.row(i))) refuse("patch " + std::to_string(i) + " has no contrast");
    }
    Eigenspace space;
    space.width = width;
    space.height = height;
    space.mean = x.colwise().mean();
    x.rowwise() -= space.mean.transpose();
    const Eigen::MatrixXd covariance = x.transpose() * x / static_cast<double>(x.rows() - 1);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    // The eigenvalues rise
    Eigen::VectorXd all = solver.eigenvalues().cwiseMax(0);
    all = (1 - shrinkage) * all.array() + shrinkage * all.mean();
    space.basis = solver.eigenvectors().rightCols(num_modes).rowwise().reverse().transpose();
    space.eigenvalues = all.tail(num_modes).reverse();
    space.rho = all.head(n - num_modes).mean();
    if (!(space.rho > 1e-12 && space.eigenvalues.minCoeff() > 1e-12))
        refuse("patches vary in fewer than " + std::to_string(num_modes + 1) +
               " ways: take fewer modes or more shrinkage");
    return space;
}

SpaceDistance distance(const Eigenspace& space, VectorIn patch) {
    space.check();
    if (patch.size() != space.mean.size())
        refuse("a patch has " + std::to_string(patch.size()) + " values, the space " +
               std::to_string(space.mean.size()));
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Eigen::RowVectorXd x = patch.transpose();
    if (!normalize(x)) return {kInfinity, kInfinity, -kInfinity};
    const Eigen::VectorXd off = x.transpose() - space.mean;
    const Eigen::VectorXd y = space.basis * off;
    SpaceDistance away;
    away.within = (y.array().square() / space.eigenvalues.array()).sum();
    away.from = std::max(0.0, off.squaredNorm() - y.squaredNorm());
    away.log_likelihood = log_normalizer(space) - 0.5 * (away.within + away.from / space.rho);
    return away;
}

}  // namespace mimetic
