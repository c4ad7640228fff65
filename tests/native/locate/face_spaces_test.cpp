// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/locate/face_spaces.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

#include "../sanitized.hpp"

namespace mimetic {
namespace {

constexpr int kSide = 24;
constexpr double kWidth = 60;  // of the drawn face's window, pixels
const Eigen::Vector2d kLeft(0.22, -0.25), kRight(-0.22, -0.25), kMouth(0, 0.28);

double blob(const Eigen::Vector2d& p, const Eigen::Vector2d& at, double across, double down) {
    return std::exp(-0.5 * (std::pow((p.x() - at.x()) / across, 2) + std::pow((p.y() - at.y()) / down, 2)));
}

struct Image {
    int rows, cols;
    std::vector<std::uint8_t> pixels;

    Image(int rows_in, int cols_in, unsigned seed) : rows(rows_in), cols(cols_in) {
        std::mt19937 random(seed);
        std::normal_distribution<double> noise(0, 4);
        for (int i = 0; i < rows * cols; ++i)
            pixels.push_back(static_cast<std::uint8_t>(std::clamp(150 + noise(random), 0.0, 255.0)));
    }
    GrayView view() const { return {pixels.data(), rows, cols, cols}; }

    /// Two dark eyes and a mouth, in a shade that falls off to one side.
    void put(const Eigen::Vector2d& center, double width, double roll, double strength) {
        const Eigen::Vector2i reach = Eigen::Vector2i::Constant(static_cast<int>(0.8 * width));
        const Eigen::Vector2i from = (center.cast<int>() - reach).cwiseMax(0),
                              to = (center.cast<int>() + reach)
                                       .cwiseMin(Eigen::Vector2i(cols, rows) - Eigen::Vector2i::Ones());
        for (int y = from.y(); y <= to.y(); ++y) {
            for (int x = from.x(); x <= to.x(); ++x) {
                const Eigen::Vector2d p =
                    Eigen::Rotation2Dd(-roll) * (Eigen::Vector2d(x, y) - center) / width;
                const double dark =
                    blob(p, kLeft, 0.06, 0.05) + blob(p, kRight, 0.06, 0.05) + blob(p, kMouth, 0.14, 0.04);
                auto& pixel = pixels[static_cast<std::size_t>(y * cols + x)];
                pixel = static_cast<std::uint8_t>(std::clamp(pixel - strength * dark, 0.0, 255.0));
            }
        }
    }
};

Eigen::VectorXd row_of(const MatrixRows& window) {
    return Eigen::Map<const Eigen::VectorXd>(window.data(), window.size());
}

/// Windows of drawn faces cut at a place of the face, in its widths, with a little scatter.
MatrixRows windows(const Eigen::Vector2d& at, double width, int cols, int rows, double ipd_px, double away) {
    constexpr int kCount = test::repeats(120, 50), kMiddle = 60;
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> angle(0, 6.28);
    MatrixRows made(kCount, cols * rows);
    for (int i = 0; i < kCount; ++i) {
        Image image(2 * kMiddle, 2 * kMiddle, static_cast<unsigned>(i));
        image.put({kMiddle, kMiddle}, kWidth * std::exp(0.06 * normal(random)), 0.08 * normal(random),
                  70 + 15 * normal(random));
        const double turn = angle(random);
        const Eigen::Vector2d off = away * Eigen::Vector2d(std::cos(turn), std::sin(turn));
        const Eigen::Vector2d shake(normal(random), normal(random));
        const Eigen::Vector2d center = Eigen::Vector2d(kMiddle, kMiddle) + kWidth * (at + off + 0.01 * shake);
        made.row(i) = row_of(flat_window(image.view(), center, kWidth * width, 0, cols, rows, ipd_px));
    }
    return made;
}

FaceSpaces drawn_spaces() {
    const MatrixRows faces = windows({0, 0}, 1, kSide, kSide, 12, 0);
    const MatrixRows others = windows({0, 0}, 1, kSide, kSide, 12, 0.4);
    FaceSpaces spaces;
    ViewSpace view;
    view.filter = (faces.colwise().mean() - others.colwise().mean()).normalized();
    view.threshold = (faces * view.filter).minCoeff();
    view.space = train_eigenspace(faces, kSide, kSide, 6, 0.02);
    view.places.resize(6);
    view.places << kLeft, kRight, kMouth;
    view.covariance = 0.002 * MatrixRows::Identity(6, 6);
    spaces.views = {view};
    spaces.other = train_eigenspace(others, kSide, kSide, 12, 0.02);
    const auto module = [&](const char* name, const Eigen::Vector2d& at, int cols, int rows) {
        const double width = cols / 40.0;
        return ModuleSpace{name, train_eigenspace(windows(at, width, cols, rows, 20, 0), cols, rows, 5, 0.02),
                           train_eigenspace(windows(at, width, cols, rows, 20, 0.12), cols, rows, 8, 0.02),
                           width};
    };
    spaces.modules = {module("eye.L", kLeft, 14, 12), module("eye.R", kRight, 14, 12),
                      module("mouth", kMouth, 20, 12)};
    spaces.weights = Eigen::VectorXd::Zero(spaces.evidence_size() + 1);
    spaces.weights(1) = 0.05;  // of the ratio of likelihoods alone
    return spaces;
}

const FaceFinder& drawn_finder() {
    static const FaceFinder finder(drawn_spaces());
    return finder;
}

Eigen::Vector2d turned(const Eigen::Vector2d& p, double roll) { return Eigen::Rotation2Dd(roll) * p; }

struct Place {
    double x, y, width, roll;
};

class FindFace : public testing::TestWithParam<Place> {};

TEST_P(FindFace, PlaceSizeTurnAndPartsAreRight) {
    const auto [x, y, width, roll] = GetParam();
    Image image(240, 320, 99);
    image.put({x, y}, width, roll, 75);
    FaceSearch options;
    options.roll = std::abs(roll) > 0.3 ? roll : 0;
    const auto found = drawn_finder().find(image.view(), options);
    ASSERT_FALSE(found.empty());
    EXPECT_LT((found[0].center - Eigen::Vector2d(x, y)).norm(), 0.06 * width);
    EXPECT_NEAR(found[0].width, width, 0.16 * width);
    EXPECT_NEAR(found[0].roll, roll, 0.13);
    const Eigen::Vector2d center(x, y);
    EXPECT_LT((found[0].places.row(0).transpose() - center - width * turned(kLeft, roll)).norm(),
              0.035 * width);
    EXPECT_LT((found[0].places.row(2).transpose() - center - width * turned(kMouth, roll)).norm(),
              0.04 * width);
}

INSTANTIATE_TEST_SUITE_P(Places, FindFace,
                         testing::Values(Place{100, 90, 60, 0}, Place{210, 140, 110, 0},
                                         Place{160, 120, 84, 0.17}, Place{160, 120, 75, -0.5}));

TEST(FaceFinder, FindsTwoAndNoneInNoise) {
    Image image(240, 320, 5);
    FaceSearch options;
    options.least_probability = 0.9;
    EXPECT_TRUE(drawn_finder().find(image.view(), options).empty());
    image.put({80, 110}, 60, 0, 75);
    image.put({220, 120}, 90, 0, 75);
    EXPECT_EQ(drawn_finder().find(image.view(), options).size(), 2u);
}

TEST(FaceFinder, ShadeAndGainDoNotMatter) {
    Image image(240, 320, 5);
    image.put({150, 110}, 70, 0, 75);
    const auto before = drawn_finder().find(image.view());
    for (int i = 0; i < 240 * 320; ++i) {
        auto& pixel = image.pixels[static_cast<std::size_t>(i)];
        pixel = static_cast<std::uint8_t>((0.35 + 0.6 * (i % 320) / 320.0) * pixel);
    }
    const auto after = drawn_finder().find(image.view());
    ASSERT_FALSE(before.empty());
    ASSERT_FALSE(after.empty());
    EXPECT_LT((before[0].center - after[0].center).norm(), 3);
}

TEST(FaceFinder, FollowsAFaceIntoTheNextFrame) {
    Image first(240, 320, 5), second(240, 320, 6), empty(240, 320, 7);
    first.put({150, 110}, 100, -0.45, 75);
    second.put({160, 118}, 106, -0.4, 75);
    FaceSearch options;
    options.roll = -0.45;
    const auto before = drawn_finder().find(first.view(), options);
    ASSERT_FALSE(before.empty());
    const auto after = drawn_finder().find_near(second.view(), before[0]);
    ASSERT_EQ(after.size(), 1u);
    EXPECT_LT((after[0].center - Eigen::Vector2d(160, 118)).norm(), 7);
    EXPECT_NEAR(after[0].roll, -0.4, 0.15);
    EXPECT_TRUE(drawn_finder().find_near(empty.view(), before[0], 0.9).empty());
}

TEST(FaceFinder, LooksWhereAHintPoints) {
    Image image(240, 320, 5);
    image.put({100, 110}, 36, 0, 75);  // below the sizes of the search
    FaceSearch options;
    options.smallest = 70;
    const auto near_it = [](const auto& found) {
        return std::any_of(found.begin(), found.end(), [](const FoundFace& face) {
            return (face.center - Eigen::Vector2d(100, 110)).norm() < 4 && face.width < 45;
        });
    };
    EXPECT_FALSE(near_it(drawn_finder().find(image.view(), options)));
    EXPECT_TRUE(near_it(drawn_finder().find(image.view(), options, {{{103, 108}, 38, 5}})));
}

TEST(FaceSpacesInput, IsRefusedWithTheReason) {
    const FaceSpaces& good = drawn_finder().spaces();
    EXPECT_NO_THROW(good.check());
    FaceSpaces bad = good;
    bad.weights.conservativeResize(3);
    EXPECT_THROW(bad.check(), InvalidInput);
    bad = good;
    bad.views[0].covariance *= -1;
    EXPECT_THROW(bad.check(), InvalidInput);
    bad = good;
    bad.modules[1].width *= 2;
    EXPECT_THROW(bad.check(), InvalidInput);
    bad = good;
    bad.views[0].filter.conservativeResize(7);
    EXPECT_THROW(FaceFinder{bad}, InvalidInput);
    EXPECT_THROW(good.module("ear"), InvalidInput);
    const Image image(60, 60, 1);
    FaceSearch options;
    options.smallest = 2;
    EXPECT_THROW(drawn_finder().find(image.view(), options), InvalidInput);
    EXPECT_THROW(drawn_finder().find_near(image.view(), FoundFace{}), InvalidInput);
    EXPECT_THROW(flat_window(image.view(), {9, 9}, 1, 0, 8, 8, 4), InvalidInput);
}

}  // namespace
}  // namespace mimetic
