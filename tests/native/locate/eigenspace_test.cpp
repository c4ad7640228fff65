// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/eigenspace.hpp>
#include <mimetic/error.hpp>
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

struct Image {
    int rows, cols;
    std::vector<std::uint8_t> pixels;

    Image(int rows_in, int cols_in, unsigned seed) : rows(rows_in), cols(cols_in) {
        std::mt19937 random(seed);
        std::uniform_int_distribution<int> level(90, 165);
        for (int i = 0; i < rows * cols; ++i) pixels.push_back(static_cast<std::uint8_t>(level(random)));
    }
    std::uint8_t& at(int y, int x) { return pixels[static_cast<std::size_t>(y * cols + x)]; }
    GrayView view() const { return {pixels.data(), rows, cols, cols}; }

    /// The drawing, its centre here, `scale` times as large and turned clockwise.
    void put(const Eigen::Vector2d& center, double scale, double roll) {
        std::mt19937 random(1);
        const Eigen::RowVectorXd patch = draw_patch(random, 0);
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < cols; ++x) {
                const Eigen::Vector2d from =
                    Eigen::Rotation2Dd(-roll) * (Eigen::Vector2d(x, y) - center) / scale;
                const double u = from.x() + 0.5 * (kSide - 1);
                const double v = from.y() + 0.5 * (kSide - 1);
                if (u < 0 || v < 0 || u > kSide - 1 || v > kSide - 1) continue;
                const int left = std::min(static_cast<int>(u), kSide - 2);
                const int top = std::min(static_cast<int>(v), kSide - 2);
                const double a = u - left, b = v - top;
                const auto of = [&](int dy, int dx) { return patch((top + dy) * kSide + left + dx); };
                at(y, x) = static_cast<std::uint8_t>(std::lround(
                    (1 - b) * ((1 - a) * of(0, 0) + a * of(0, 1)) + b * ((1 - a) * of(1, 0) + a * of(1, 1))));
            }
        }
    }
};

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

TEST(Eigenspace, MapIsTheDistanceOfEveryPatch) {
    const Eigenspace space = train_eigenspace(draw_patches(60, 3), kSide, kSide, 5);
    Image image(33, 41, 5);
    image.put({20, 14}, 1, 0);
    for (int y = 20; y < 33; ++y) {
        for (int x = 0; x < 12; ++x) image.at(y, x) = 77;
    }
    const MatrixRows map = likelihood_map(space, image.view());
    ASSERT_EQ(map.rows(), 26);
    ASSERT_EQ(map.cols(), 34);
    EXPECT_EQ(map(22, 2), -std::numeric_limits<double>::infinity());
    int compared = 0;
    for (int top = 0; top < map.rows(); ++top) {
        for (int left = 0; left < map.cols(); ++left) {
            if (!std::isfinite(map(top, left))) continue;
            Eigen::VectorXd patch(kSide * kSide);
            for (int i = 0; i < patch.size(); ++i) patch(i) = image.at(top + i / kSide, left + i % kSide);
            const double expected = distance(space, patch).log_likelihood;
            EXPECT_NEAR(map(top, left), expected, 1e-4 * std::abs(expected) + 1e-2);
            ++compared;
        }
    }
    EXPECT_GT(compared, 800);
}

struct Place {
    double scale, roll;
};
class SearchSpaces : public testing::TestWithParam<Place> {};

TEST_P(SearchSpaces, FindsPlaceSizeTurnAndView) {
    const Eigenspace drawn = train_eigenspace(draw_patches(80, 3), kSide, kSide, 5);
    MatrixRows upside_down = draw_patches(80, 3).rowwise().reverse();
    const Eigenspace other = train_eigenspace(upside_down, kSide, kSide, 5);
    const auto [scale, roll] = GetParam();
    Image image(90, 110, 8);
    const Eigen::Vector2d center(61.3, 42.6);
    image.put(center, scale, roll);
    SpaceSearchOptions options;
    options.smallest = 16;
    options.largest_roll = 0.35;
    const auto found = search_spaces({other, drawn}, image.view(), options);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].view, 1);
    EXPECT_LT((found[0].center - center).norm(), 0.06 * scale * kSide);
    EXPECT_NEAR(found[0].roll, roll, 1e-9);
    EXPECT_NEAR(std::log2(found[0].width / (scale * kSide)), 0, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Places, SearchSpaces,
                         testing::Values(Place{2.5, 0}, Place{4, 0}, Place{3.2, 0.35}, Place{5, -0.35}));

TEST(SearchSpacesOf, TwoFacesAreTwoMatches) {
    const Eigenspace space = train_eigenspace(draw_patches(80, 3), kSide, kSide, 5);
    Image image(80, 120, 9);
    image.put({30, 40}, 3, 0);
    image.put({88, 36}, 4, 0);
    SpaceSearchOptions options;
    options.smallest = 16;
    options.num_matches = 2;
    const auto found = search_spaces({space}, image.view(), options);
    ASSERT_EQ(found.size(), 2u);
    const auto& left = found[0].center.x() < 60 ? found[0] : found[1];
    const auto& right = found[0].center.x() < 60 ? found[1] : found[0];
    EXPECT_LT((left.center - Eigen::Vector2d(30, 40)).norm(), 2);
    EXPECT_LT((right.center - Eigen::Vector2d(88, 36)).norm(), 2);
    options.least_likelihood = found[0].log_likelihood + 1;
    EXPECT_TRUE(search_spaces({space}, image.view(), options).empty());
}

TEST(PlaceModules, PriorChoosesBetweenTwoThatLookAlike) {
    const Eigenspace space = train_eigenspace(draw_patches(80, 3), kSide, kSide, 5);
    Image image(120, 160, 10);
    SpaceMatch face;
    face.center << 80, 60;
    face.width = 80;
    face.roll = 0.15;
    const auto in_image = [&](const Eigen::Vector2d& place) -> Eigen::Vector2d {
        return face.center + Eigen::Rotation2Dd(face.roll) * (face.width * place);
    };
    const Eigen::Vector2d eye(-0.21, -0.1), wrong(-0.02, 0.02), mouth(0.24, 0.24);
    for (const auto& place : {eye, wrong, mouth}) image.put(in_image(place), 2, face.roll);
    std::vector<FaceModule> modules = {{"eye", space, 0.2, {-0.2, -0.12}},
                                       {"mouth", space, 0.2, {0.25, 0.25}}};
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(4, 4) * 0.004;
    const ModulePlaces found = place_modules(modules, covariance, image.view(), face);
    EXPECT_LT((found.positions.row(0).transpose() - in_image(eye)).norm(), 1.5);
    EXPECT_LT((found.positions.row(1).transpose() - in_image(mouth)).norm(), 1.5);
    EXPECT_LT(found.prior, 1.5);
    // Places that go together: the mean alone would have taken the nearer one
    modules[0].place = {-0.1, -0.03};
    Eigen::MatrixXd together = Eigen::MatrixXd::Identity(4, 4) * 0.006;
    together(0, 2) = together(2, 0) = together(1, 3) = together(3, 1) = 0.0057;
    modules[1].place = mouth - (eye - modules[0].place);
    const ModulePlaces joint = place_modules(modules, together, image.view(), face);
    EXPECT_LT((joint.positions.row(0).transpose() - in_image(eye)).norm(), 1.5);
}

TEST(EigenspaceInput, IsRefusedWithTheReason) {
    const MatrixRows patches = draw_patches(20, 3);
    EXPECT_THROW(train_eigenspace(patches, kSide, 7, 3), InvalidInput);
    EXPECT_THROW(train_eigenspace(patches, kSide, kSide, 19), InvalidInput);
    EXPECT_THROW(train_eigenspace(MatrixRows::Ones(20, 64), kSide, kSide, 3), InvalidInput);
    Eigenspace space = train_eigenspace(patches, kSide, kSide, 3);
    EXPECT_THROW(distance(space, Eigen::VectorXd::Zero(5)), InvalidInput);
    const Image image(40, 40, 1);
    SpaceSearchOptions options;
    options.num_rolls = 2;
    EXPECT_THROW(search_spaces({space}, image.view(), options), InvalidInput);
    EXPECT_THROW(search_spaces({}, image.view()), InvalidInput);
    SpaceMatch face;
    face.width = 20;
    EXPECT_THROW(
        place_modules({{"eye", space, 0.2, {0, 0}}}, -Eigen::MatrixXd::Identity(2, 2), image.view(), face),
        InvalidInput);
    space.basis.row(0) *= 2;
    EXPECT_THROW(space.check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
