// SPDX-License-Identifier: GPL-3.0-or-later
#include "block_banded.hpp"

#include <mimetic/shared/error.hpp>

namespace mimetic {

void BlockBanded::add_second_differences(const Eigen::VectorXd& weights) {
    for (std::size_t t = 1; t + 1 < diagonal.size(); ++t) {
        diagonal[t - 1].diagonal() += weights;
        diagonal[t].diagonal() += 4 * weights;
        diagonal[t + 1].diagonal() += weights;
        first[t - 1] -= 2 * weights;
        first[t] -= 2 * weights;
        second[t - 1] += weights;
    }
}

BlockBandedFactor::BlockBandedFactor(const BlockBanded& matrix) {
    const std::size_t count = matrix.diagonal.size();
    diagonal_.resize(count);
    first_.resize(count);
    second_.resize(count);
    for (std::size_t t = 0; t < count; ++t) {
        Eigen::MatrixXd block = matrix.diagonal[t];
        if (t >= 1) {
            block -= first_[t - 1] * first_[t - 1].transpose();
        }
        if (t >= 2) {
            block -= second_[t - 2] * second_[t - 2].transpose();
        }
        const Eigen::LLT<Eigen::MatrixXd> factor(block);
        if (factor.info() != Eigen::Success) {
            throw InvalidInput("smooth: the measurements of frame " + std::to_string(t + 1) +
                               " of the clip are not positive semidefinite");
        }
        diagonal_[t] = factor.matrixL();
        const auto lower = diagonal_[t].triangularView<Eigen::Lower>();
        if (t + 1 < count) {
            Eigen::MatrixXd coupling = matrix.first[t].asDiagonal();
            if (t >= 1) {
                coupling -= second_[t - 1] * first_[t - 1].transpose();
            }
            first_[t] = lower.solve(coupling.transpose()).transpose();
        }
        if (t + 2 < count) {
            second_[t] = lower.solve(Eigen::MatrixXd(matrix.second[t].asDiagonal())).transpose();
        }
    }
}

void BlockBandedFactor::solve(std::vector<Eigen::VectorXd>& blocks) const {
    const std::size_t count = diagonal_.size();
    for (std::size_t t = 0; t < count; ++t) {
        if (t >= 1) {
            blocks[t].noalias() -= first_[t - 1] * blocks[t - 1];
        }
        if (t >= 2) {
            blocks[t].noalias() -= second_[t - 2] * blocks[t - 2];
        }
        diagonal_[t].triangularView<Eigen::Lower>().solveInPlace(blocks[t]);
    }
    for (std::size_t t = count; t-- > 0;) {
        if (t + 1 < count) {
            blocks[t].noalias() -= first_[t].transpose() * blocks[t + 1];
        }
        if (t + 2 < count) {
            blocks[t].noalias() -= second_[t].transpose() * blocks[t + 2];
        }
        diagonal_[t].triangularView<Eigen::Lower>().transpose().solveInPlace(blocks[t]);
    }
}

std::vector<Eigen::MatrixXd> BlockBandedFactor::inverse_diagonal() const {
    // Takahashi's recursion: only the inverse's own band is needed.
    const std::size_t count = diagonal_.size();
    std::vector<Eigen::MatrixXd> inverse(count);
    Eigen::MatrixXd below;  // block (t + 2, t + 1) of the inverse
    for (std::size_t t = count; t-- > 0;) {
        const Eigen::Index size = diagonal_[t].rows();
        const Eigen::MatrixXd root =
            diagonal_[t].triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size));
        inverse[t] = root.transpose() * root;
        Eigen::MatrixXd next;  // block (t + 1, t)
        if (t + 1 < count) {
            const Eigen::MatrixXd first = first_[t] * root;
            next = -inverse[t + 1] * first;
            if (t + 2 < count) {
                const Eigen::MatrixXd second = second_[t] * root;
                next -= below.transpose() * second;
                const Eigen::MatrixXd far = -below * first - inverse[t + 2] * second;
                inverse[t] -= second.transpose() * far;
            }
            inverse[t] -= first.transpose() * next;
        }
        // Rounding leaves the two halves a little apart; unchecked, the recursion doubles that every few
        // frames.
        inverse[t] = (0.5 * (inverse[t] + inverse[t].transpose())).eval();
        below = next;
    }
    return inverse;
}

}  // namespace mimetic
