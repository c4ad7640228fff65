// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/still_cover.hpp>
#include <mimetic/shared/error.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace mimetic {
namespace {

constexpr int kCols = 320, kRows = 240;
const Eigen::Vector2d kMiddle(160, 120);  // of the face where it has not moved
const Eigen::Vector2d kAside(75, 0);
const Eigen::Vector2d kBar(150, 140);  // middle of what stands still

/// A face's edges at a place of it, grey levels: an eye each, a mouth, and cheeks without any.
double face_at(const Eigen::Vector2d& at) {
    const auto blot = [&](double x, double y, double width, double height) {
        return std::exp(-std::pow((at.x() - x) / width, 2) - std::pow((at.y() - y) / height, 2));
    };
    return 150 - 90 * (blot(-22, -12, 7, 3) + blot(22, -12, 7, 3) + blot(0, 34, 14, 3));
}

class StillCoverTest : public ::testing::Test {
protected:
    bool has_bar = true;
    bool are_two = false;  // faces, to both sides of the middle
    double scale = 1;      // of the picture

    /// A frame in which the face has moved, or one of two that do not.
    void add(const Eigen::Vector2d& moved) {
        std::vector<std::uint8_t> drawn;
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kCols; ++x) {
                const Eigen::Vector2d at(x, y);
                const Eigen::Array2d from_bar = (at - kBar).array().abs();
                const bool is_bar = has_bar && from_bar.x() < 16 && from_bar.y() < 5;
                double grey = is_bar ? 240 : face_at(at - kMiddle - moved);
                if (are_two) {
                    const Eigen::Vector2d other = at - kMiddle - kAside;
                    grey = std::min(face_at(at - kMiddle + kAside), face_at({.8 * other.x(), -other.y()}));
                }
                drawn.push_back(static_cast<std::uint8_t>(std::lround(grey)));
            }
        }
        const int rows = static_cast<int>(kRows * scale), cols = static_cast<int>(kCols * scale);
        std::vector<std::uint8_t> pixels;
        for (int y = 0; y < rows; ++y) {
            const std::uint8_t* row = &drawn[static_cast<std::size_t>(y / scale) * kCols];
            for (int x = 0; x < cols; ++x) {
                pixels.insert(pixels.end(), 3, row[static_cast<std::size_t>(x / scale)]);
            }
        }
        FaceFeatures face;
        const Eigen::Vector2d middle = (kMiddle + moved) * scale;
        face.box << middle.x() - 50 * scale, middle.y() - 50 * scale, 100 * scale, 100 * scale;
        for (const auto& [name, x, y] :
             {std::tuple("pupil.L", 22., -12.), {"pupil.R", -22., -12.}, {"lip_line", 0., 34.}}) {
            face.features.push_back({name, middle + scale * Eigen::Vector2d(x, y), 1, 1});
        }
        watch.add({pixels.data(), rows, cols, std::ptrdiff_t{3} * cols}, face);
    }

    void add_moving(int frames, double reach) {
        for (int i = 0; i < frames; ++i) {
            add(reach * Eigen::Vector2d(std::sin(1.9 * i), .6 * std::cos(1.3 * i)));
        }
    }

    StillCoverWatch watch;
};

TEST_F(StillCoverTest, IsFoundBeforeAFaceThatMoves) {
    add_moving(12, 8);
    const StillCover found = watch.found();
    ASSERT_TRUE(found.any());
    for (const double x : {-14., 0., 14.}) {
        EXPECT_TRUE(found.at(kBar + Eigen::Vector2d(x, 0))) << x;
    }
    for (const auto& [x, y] : {std::pair(-22., -12.), {22., -12.}, {-45., 20.}, {0., -30.}}) {
        EXPECT_FALSE(found.at(kMiddle + Eigen::Vector2d(x, y))) << x << ", " << y;
    }
}

TEST_F(StillCoverTest, IsFoundAtTheSamePlaceInALargePicture) {
    scale = 3.5;
    add_moving(6, 8);
    const StillCover found = watch.found();
    EXPECT_TRUE(found.at(scale * kBar));
    EXPECT_FALSE(found.at(scale * (kMiddle + Eigen::Vector2d(0, -30))));
    EXPECT_GT(found.cell, 5);
    EXPECT_NO_THROW(found.check());
}

TEST_F(StillCoverTest, IsFoundWhereManyPixelsMakeOneOfTheGrid) {
    scale = 6.5;
    add_moving(6, 8);
    const StillCover found = watch.found();
    EXPECT_TRUE(found.at(scale * kBar));
    // Both ends of the bar are in, and what is well beside it is not
    for (const auto& [x, is_in] : {std::pair(-15., true), {15., true}, {-30., false}, {30., false}}) {
        EXPECT_EQ(found.at(scale * (kBar + Eigen::Vector2d(x, 0))), is_in) << x;
    }
}

TEST_F(StillCoverTest, IsNoneOfAFaceAlone) {
    has_bar = false;
    add_moving(12, 8);
    EXPECT_FALSE(watch.found().any());
}

TEST_F(StillCoverTest, CannotBeToldFromAFaceThatStandsStill) {
    add_moving(12, 0);
    EXPECT_FALSE(watch.found().any());
}

TEST_F(StillCoverTest, IsNoneOfTwoFacesThatAreFoundInTurn) {
    has_bar = false;
    are_two = true;
    for (int i = 0; i < 16; ++i) {
        add(i % 3 == 0 ? kAside : -kAside);
    }
    EXPECT_FALSE(watch.found().any());
}

TEST_F(StillCoverTest, NeedsSixFrames) {
    add_moving(5, 8);
    EXPECT_FALSE(watch.found().any());
    add({5, -4});
    EXPECT_TRUE(watch.found().any());
}

TEST_F(StillCoverTest, AFaceBesideThePictureTellsNothing) {
    add_moving(12, 8);
    add({900, 0});
    EXPECT_TRUE(watch.found().at(kBar));
}

TEST_F(StillCoverTest, IsAtThePixelsOfItsCells) {
    StillCover cover{{10, 20}, 4, StillCover::Cells::Constant(2, 3, true)};
    cover.cells(1, 2) = false;
    EXPECT_TRUE(cover.at({10, 20}) && cover.at({21.9, 23.9}) && cover.at({17.9, 27.9}));
    for (const auto& [x, y] : {std::pair(9.9, 21.), {19., 25.}, {22.1, 21.}, {11., 28.1}, {NAN, 21.}}) {
        EXPECT_FALSE(cover.at({x, y})) << x << ", " << y;
    }
    EXPECT_FALSE(StillCover{}.at({0, 0}));
}

TEST_F(StillCoverTest, SaysWhatIsWrong) {
    add({0, 0});
    scale = .5;
    EXPECT_THROW(add({0, 0}), InvalidInput);
    const auto cells = StillCover::Cells::Constant(2, 2, true);
    EXPECT_THROW((StillCover{{NAN, 0}, 4, cells}).check(), InvalidInput);
    EXPECT_THROW((StillCover{{0, 0}, 0, cells}).check(), InvalidInput);
    EXPECT_THROW((StillCover{{0, 0}, 4, StillCover::Cells::Constant(1, 500, true)}).check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
