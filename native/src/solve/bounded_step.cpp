// SPDX-License-Identifier: GPL-3.0-or-later
#include "bounded_step.hpp"

#include <Eigen/Cholesky>

namespace mimetic {

namespace {

constexpr int kFixed = 2;

/// Step of the free coordinates, the others kept at `at`.
Eigen::VectorXd solve_free(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                           const Eigen::VectorXd& at, const std::vector<int>& free) {
    const Eigen::VectorXd pull = gradient - information * at;
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd block(count, count);
    Eigen::VectorXd wanted(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const int row = free[static_cast<std::size_t>(i)];
        wanted[i] = pull[row];
        for (Eigen::Index j = 0; j <= i; ++j) {
            block(i, j) = information(row, free[static_cast<std::size_t>(j)]);
        }
    }
    const Eigen::VectorXd solved = block.selfadjointView<Eigen::Lower>().llt().solve(wanted);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(at.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        step[free[static_cast<std::size_t>(i)]] = solved[i];
    }
    return step;
}

/// The fixed coordinate whose multiplier most violates optimality, -1 when none does.
int most_wanted(const Eigen::VectorXd& pull, const std::vector<int>& side) {
    int best = -1;
    double strongest = 1e-9 * (1 + pull.cwiseAbs().maxCoeff());
    for (int i = 0; i < pull.size(); ++i) {
        const double inward = side[i] == -1 ? pull[i] : side[i] == 1 ? -pull[i] : 0;
        if (inward > strongest) {
            strongest = inward;
            best = i;
        }
    }
    return best;
}

}  // namespace

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                             const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
    const auto size = static_cast<int>(gradient.size());
    Eigen::VectorXd at = Eigen::VectorXd::Zero(size);
    std::vector<int> side(size, 0);  // -1 held at lower, 1 held at upper, kFixed for good
    for (int i = 0; i < size; ++i) {
        if (lower[i] >= upper[i]) {
            side[i] = kFixed;
        } else if (lower[i] >= 0 && gradient[i] < 0) {
            side[i] = -1;
        } else if (upper[i] <= 0 && gradient[i] > 0) {
            side[i] = 1;
        }
        at[i] = side[i] < 0 ? lower[i] : side[i] > 0 ? upper[i] : 0;
    }
    std::vector<int> free;
    for (int round = 0; round < 6 * size; ++round) {
        free.clear();
        for (int i = 0; i < size; ++i) {
            if (side[i] == 0) {
                free.push_back(i);
            }
        }
        const Eigen::VectorXd step = solve_free(information, gradient, at, free);
        double share = 1;
        int blocking = -1;
        for (const int i : free) {
            const double target = at[i] + step[i];
            const double bound = target < lower[i] ? lower[i] : target > upper[i] ? upper[i] : target;
            if (bound != target && (bound - at[i]) / step[i] < share) {
                share = std::max(0., (bound - at[i]) / step[i]);
                blocking = i;
            }
        }
        at += share * step;
        if (blocking >= 0) {
            side[blocking] = step[blocking] < 0 ? -1 : 1;
            at[blocking] = step[blocking] < 0 ? lower[blocking] : upper[blocking];
            continue;
        }
        const int released = most_wanted(gradient - information * at, side);
        if (released < 0) {
            break;
        }
        side[released] = 0;
    }
    return at;
}

}  // namespace mimetic
