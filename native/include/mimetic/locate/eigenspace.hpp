// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Gaussian density of image patches in their principal subspace and its complement [Moghaddam and Pentland
/// 1997]. A patch is width x height grey values, row by row, shifted and scaled to mean 0 and variance 1.
struct Eigenspace {
    int width = 0;
    int height = 0;
    Eigen::VectorXd mean;         ///< N = width * height
    MatrixRows basis;             ///< M x N, orthonormal rows
    Eigen::VectorXd eigenvalues;  ///< M, falling, above 0
    double rho = 0;               ///< mean of the N - M eigenvalues that are left out, above 0
    void check() const;           ///< throws InvalidInput: field, value, limit
};

/// Distance of a patch from an eigenspace; smaller is more alike.
struct SpaceDistance {
    double within = 0;          ///< distance in feature space: sum of y_i^2 / lambda_i
    double from = 0;            ///< distance from feature space: squared residual of the projection
    double log_likelihood = 0;  ///< of the whole density; -infinity for a patch without contrast
};

/// Principal components of patches.
/// patches: K x N, K above num_modes; grey values of any gain and offset, at least 1e-6 of deviation each.
/// shrinkage: share of every eigenvalue that is replaced by their mean [Ledoit and Wolf 2004], 0 to 1.
Eigenspace train_eigenspace(MatrixIn patches, int width, int height, int num_modes, double shrinkage = 0.01);

/// patch: N grey values, row by row. Throws InvalidInput for another number of values.
SpaceDistance distance(const Eigenspace& space, VectorIn patch);

}  // namespace mimetic
