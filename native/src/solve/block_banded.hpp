// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <string>
#include <vector>

namespace mimetic {

/// Symmetric positive definite matrix of n x n blocks, each coupled to the next two by diagonal blocks.
struct BlockBanded {
    std::vector<Eigen::MatrixXd> diagonal;
    std::vector<Eigen::VectorXd> first;   ///< of (t + 1, t)
    std::vector<Eigen::VectorXd> second;  ///< of (t + 2, t)

    /// Information of small second differences: 1/2 sum over 0 < t < last of weights (x_t-1 - 2 x_t +
    /// x_t+1)^2.
    void add_second_differences(const Eigen::VectorXd& weights);
};

/// Its Cholesky factor.
class BlockBandedFactor {
public:
    /// Throws InvalidInput if the matrix is not positive definite.
    explicit BlockBandedFactor(const BlockBanded& matrix);
    void solve(std::vector<Eigen::VectorXd>& blocks) const;  ///< in place
    std::vector<Eigen::MatrixXd> inverse_diagonal() const;   ///< diagonal blocks of the inverse

private:
    std::vector<Eigen::MatrixXd> diagonal_, first_, second_;  // lower; first_[t] is block (t + 1, t)
};

}  // namespace mimetic
