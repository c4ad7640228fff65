// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <mimetic/locate/eigenspace.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <random>

namespace mimetic {
namespace {

constexpr int kSide = 8;

/// Drawn "faces": a bar and a dot of random strength on noise, in a patch of kSide squared.
Eigen::RowVectorXd draw_patch(std::mt19937& random, double noise) {
    std::normal_distribution<double> normal;
    const double bar = 1 + 0.2 * normal(random);
    const double dot = 1 + 0.2 * normal(random);
    Eigen::RowVectorXd patch(kSide * kSide);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const double round = std::exp(-0.5 * (std::pow(x - 4.6, 2) + std::pow(y - 5.2, 2)));
            const double flat = std::exp(-0.5 * std::pow((y - 1.8) / 0.7, 2)) * (x < 6);
            patch(y * kSide + x) = 128 + 60 * (bar * flat - dot * round) + noise * normal(random);
        }
    }
    return patch;
}

MatrixRows draw_patches(int count, unsigned seed, double noise = 6) {
    std::mt19937 random(seed);
    MatrixRows patches(count, kSide * kSide);
    for (int i = 0; i < count; ++i) patches.row(i) = draw_patch(random, noise);
    return patches;
}

Eigen::VectorXd normalized(Eigen::VectorXd x) {
    x.array() -= x.mean();
    return x / std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

TEST(Eigenspace, LikelihoodIsThatOfTheGaussianWrittenOut) {
    const MatrixRows patches = draw_patches(60, 3);
    const Eigenspace space = train_eigenspace(patches, kSide, kSide, 5);
    const Eigen::Index n = kSide * kSide;
    const Eigen::MatrixXd modes = space.basis.transpose();
    const Eigen::MatrixXd covariance =
        modes * space.eigenvalues.asDiagonal() * modes.transpose() +
        space.rho * (Eigen::MatrixXd::Identity(n, n) - modes * modes.transpose());
    const Eigen::VectorXd patch = draw_patches(1, 99).row(0);
    const Eigen::VectorXd off = normalized(patch) - space.mean;
    const double exponent = off.dot(covariance.ldlt().solve(off));
    const Eigen::MatrixXd lower = covariance.llt().matrixL();
    const double log_determinant = 2 * lower.diagonal().array().log().sum();
    const double expected =
        -0.5 * (exponent + log_determinant + static_cast<double>(n) * std::log(2 * std::numbers::pi));
    const SpaceDistance away = distance(space, patch);
    EXPECT_NEAR(away.log_likelihood, expected, 1e-8 * std::abs(expected));
    EXPECT_NEAR(away.within + away.from / space.rho, exponent, 1e-8 * exponent);
}

TEST(Eigenspace, TrainingFindsTheComponentsAndKeepsTheVariance) {
    const MatrixRows patches = draw_patches(200, 4);
    const Eigenspace space = train_eigenspace(patches, kSide, kSide, 6, 0);
    MatrixRows x = patches;
    for (Eigen::Index i = 0; i < x.rows(); ++i) x.row(i) = normalized(patches.row(i).transpose()).transpose();
    x.rowwise() -= Eigen::RowVectorXd(x.colwise().mean());
    const double total = x.squaredNorm() / static_cast<double>(x.rows() - 1);
    const double rest = static_cast<double>(kSide * kSide - 6);
    EXPECT_NEAR(space.eigenvalues.sum() + rest * space.rho, total, 1e-9 * total);
    for (int i = 0; i < 6; ++i) {
        const double variance =
            (x * space.basis.row(i).transpose()).squaredNorm() / static_cast<double>(x.rows() - 1);
        EXPECT_NEAR(variance, space.eigenvalues(i), 1e-9 * variance);
    }
    for (int i = 1; i < 6; ++i) EXPECT_LE(space.eigenvalues(i), space.eigenvalues(i - 1));
    const Eigenspace shrunken = train_eigenspace(patches, kSide, kSide, 6, 1);
    EXPECT_NEAR(shrunken.rho, total / (kSide * kSide), 1e-9);
}

TEST(Eigenspace, GainAndOffsetDoNotMatter) {
    const Eigenspace space = train_eigenspace(draw_patches(60, 3), kSide, kSide, 5);
    const Eigen::VectorXd patch = draw_patches(1, 7).row(0);
    const Eigen::VectorXd other = 0.3 * patch.array() + 40;
    EXPECT_NEAR(distance(space, patch).log_likelihood, distance(space, other).log_likelihood, 1e-6);
    EXPECT_EQ(distance(space, Eigen::VectorXd::Constant(64, 9)).log_likelihood,
              -std::numeric_limits<double>::infinity());
}

TEST(EigenspaceInput, IsRefusedWithTheReason) {
    const MatrixRows patches = draw_patches(20, 3);
    EXPECT_THROW(train_eigenspace(patches, kSide, 7, 3), InvalidInput);
    EXPECT_THROW(train_eigenspace(patches, kSide, kSide, 19), InvalidInput);
    EXPECT_THROW(train_eigenspace(MatrixRows::Ones(20, 64), kSide, kSide, 3), InvalidInput);
    Eigenspace space = train_eigenspace(patches, kSide, kSide, 3);
    EXPECT_THROW(distance(space, Eigen::VectorXd::Zero(5)), InvalidInput);
    space.basis.row(0) *= 2;
    EXPECT_THROW(space.check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
