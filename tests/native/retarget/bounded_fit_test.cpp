// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <mimetic/retarget/bounded_fit.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

BoundedProblem random_problem(int count, unsigned seed, int rank) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](Eigen::Index rows, Eigen::Index cols) {
        return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }));
    };
    const Eigen::MatrixXd factor = draw(rank, count);
    BoundedProblem problem;
    problem.hessian = factor.transpose() * factor;
    problem.linear = factor.transpose() * draw(rank, 1);
    problem.sparsity = .3 * draw(count, 1).cwiseAbs();
    problem.lowest = -.4 * draw(count, 1).cwiseAbs();
    problem.lowest.head(count / 2).setZero();
    problem.highest = .5 * draw(count, 1).cwiseAbs();
    return problem;
}

/// The least value over every choice of unknowns at 0, at either bound, or free with either sign.
double brute_force(const BoundedProblem& problem) {
    const auto count = static_cast<int>(problem.linear.size());
    const int choices = static_cast<int>(std::pow(5, count));
    double least = std::numeric_limits<double>::infinity();
    for (int choice = 0; choice < choices; ++choice) {
        Eigen::VectorXd at = Eigen::VectorXd::Zero(count);
        std::vector<Eigen::Index> free;
        Eigen::VectorXd slope = problem.linear;
        for (int k = 0, rest = choice; k < count; ++k, rest /= 5) {
            const int kind = rest % 5;
            at[k] = kind == 1 ? problem.lowest[k] : kind == 2 ? problem.highest[k] : 0;
            if (kind >= 3) {
                free.push_back(k);
                slope[k] -= kind == 3 ? problem.sparsity[k] : -problem.sparsity[k];
            }
        }
        if (!free.empty()) {
            const Eigen::VectorXd rest = (slope - problem.hessian * at)(free);
            const Eigen::MatrixXd block = problem.hessian(free, free);
            at(free) = block.fullPivLu().solve(rest);
        }
        if ((at.array() >= problem.lowest.array() - 1e-12).all() &&
            (at.array() <= problem.highest.array() + 1e-12).all()) {
            least = std::min(least, problem.value(at));
        }
    }
    return least;
}

TEST(BoundedFit, FindsTheLeastValueOfAllChoicesOfBounds) {
    for (unsigned seed = 0; seed < 30; ++seed) {
        const BoundedProblem problem = random_problem(5, seed, 7);
        const Eigen::VectorXd fitted = fit_bounded(problem, Eigen::VectorXd::Zero(5));
        EXPECT_NEAR(problem.value(fitted), brute_force(problem), 1e-9) << seed;
    }
}

TEST(BoundedFit, MeetsTheConditionsOfAMinimumInManyUnknowns) {
    for (unsigned seed = 0; seed < 5; ++seed) {
        const BoundedProblem problem = random_problem(80, seed, 120);
        const Eigen::VectorXd fitted = fit_bounded(problem, Eigen::VectorXd::Zero(80));
        EXPECT_LT(problem.violation(fitted).maxCoeff(), 1e-8);
        EXPECT_TRUE((fitted.array() >= problem.lowest.array()).all());
        EXPECT_TRUE((fitted.array() <= problem.highest.array()).all());
    }
}

TEST(BoundedFit, DoesNotDependOnItsStart) {
    const BoundedProblem problem = random_problem(20, 3, 30);
    const Eigen::VectorXd from_rest = fit_bounded(problem, Eigen::VectorXd::Zero(20));
    EXPECT_TRUE(fit_bounded(problem, problem.highest).isApprox(from_rest, 1e-7));
    EXPECT_TRUE(fit_bounded(problem, Eigen::VectorXd::Constant(20, 9)).isApprox(from_rest, 1e-7));
}

TEST(BoundedFit, SparsityLeavesOutWhatSavesLessThanItCosts) {
    BoundedProblem problem;
    problem.hessian = Eigen::MatrixXd::Identity(3, 3);
    problem.linear = Eigen::Vector3d(.05, .5, -.5);
    problem.sparsity = Eigen::Vector3d::Constant(.1);
    problem.lowest = Eigen::Vector3d(0, 0, -1);
    problem.highest = Eigen::Vector3d::Ones();
    EXPECT_TRUE(fit_bounded(problem, Eigen::Vector3d::Zero()).isApprox(Eigen::Vector3d(0, .4, -.4), 1e-12));
}

TEST(BoundedFit, OfControlsThatDoTheSameNoneGoesAstray) {
    const BoundedProblem problem = random_problem(30, 1, 4);  // rank 4: most combinations are undetermined
    const Eigen::VectorXd fitted = fit_bounded(problem, Eigen::VectorXd::Zero(30));
    EXPECT_LT(problem.violation(fitted).maxCoeff(), 1e-5);
}

TEST(BoundedFit, WhatMovesNothingStaysAtZero) {
    BoundedProblem problem = random_problem(4, 2, 6);
    problem.hessian.row(1).setZero();
    problem.hessian.col(1).setZero();
    problem.linear[1] = 0;
    EXPECT_EQ(fit_bounded(problem, Eigen::VectorXd::Constant(4, .1))[1], 0);
}

TEST(BoundedFit, NoUnknownsHaveNoValues) {
    EXPECT_EQ(fit_bounded(random_problem(0, 1, 3), Eigen::VectorXd(0)).size(), 0);
}

TEST(BoundedFit, WrongProblemsAreRefused) {
    BoundedProblem problem = random_problem(4, 2, 6);
    EXPECT_THROW(fit_bounded(problem, Eigen::VectorXd::Zero(3)), InvalidInput);
    problem.lowest[0] = .1;
    EXPECT_THROW(fit_bounded(problem, Eigen::VectorXd::Zero(4)), InvalidInput);
    problem = random_problem(4, 2, 6);
    problem.sparsity[2] = -1;
    EXPECT_THROW(fit_bounded(problem, Eigen::VectorXd::Zero(4)), InvalidInput);
    problem = random_problem(4, 2, 6);
    problem.linear[2] = std::nan("");
    EXPECT_THROW(fit_bounded(problem, Eigen::VectorXd::Zero(4)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
