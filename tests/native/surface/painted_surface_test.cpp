// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/painted_surface.hpp>

namespace mimetic {
namespace {

const Camera kCamera{100, 100, 49.5, 39.5, 100, 80};

Paint plain(std::uint8_t red, std::uint8_t green, std::uint8_t blue, std::uint8_t opacity = 255) {
    Paint paint{16, 16, {}};
    for (int i = 0; i < 16 * 16; ++i) {
        paint.pixels.insert(paint.pixels.end(), {red, green, blue, opacity});
    }
    return paint;
}

/// Squares that face the camera, each behind the one before and twice as wide, with a picture of its own.
/// Their limit has two thirds of their width.
struct Squares {
    Points vertices{8, 3};
    Quads faces{2, 4};
    Paints paints;
    PaintedOptions options;

    Squares() {
        for (int i = 0; i < 2; ++i) {
            const double half = .1 * (i + 1), z = 1 + .2 * i;
            vertices.middleRows(4 * i, 4) << -half, half, z, half, half, z, half, -half, z, -half, -half, z;
            faces.row(i) << 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3;
        }
        paints.pictures = {plain(200, 0, 0), plain(0, 0, 200)};
        paints.picture_of_face = Eigen::Vector2i(0, 1);
        paints.corners.resize(8, 2);
        paints.corners << 0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1;
        paints.brightness = Eigen::VectorXd::Ones(8);
        options.relief = 0;
        options.levels = 0;
        options.ground = 50;
    }

    Eigen::VectorXd light;

    Eigen::Vector3i pixel(int x, int y) const {
        const ColorImage picture = PaintedSurface(faces, paints, options).draw(kCamera, vertices, light);
        const std::uint8_t* level = picture.pixels.data() + 3 * (y * picture.cols + x);
        return {level[0], level[1], level[2]};
    }
};

TEST(PaintedSurface, TheNearerFaceIsSeenThenTheFartherThenTheGround) {
    const Squares squares;
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(200, 0, 0));
    EXPECT_EQ(squares.pixel(59, 40), Eigen::Vector3i(0, 0, 200));
    EXPECT_EQ(squares.pixel(90, 40), Eigen::Vector3i(50, 50, 50));
}

TEST(PaintedSurface, PicturesLieOnTheirFacesUpright) {
    Squares squares;
    for (int row = 0; row < 8; ++row) {  // the upper half is green
        for (int col = 0; col < 16; ++col) {
            squares.paints.pictures[0].pixels[static_cast<std::size_t>(4 * (16 * row + col) + 1)] = 200;
        }
    }
    EXPECT_EQ(squares.pixel(50, 36), Eigen::Vector3i(200, 200, 0));
    EXPECT_EQ(squares.pixel(50, 43), Eigen::Vector3i(200, 0, 0));
}

TEST(PaintedSurface, SeeThroughPicturesLieOverWhatIsBehind) {
    Squares squares;
    squares.paints.pictures[0] = plain(200, 0, 0, 51);
    const Eigen::Vector3i mixed = squares.pixel(50, 40);
    EXPECT_NEAR(mixed[0], 40, 1);
    EXPECT_NEAR(mixed[2], 160, 1);
    std::swap(squares.paints.picture_of_face[0], squares.paints.picture_of_face[1]);  // now it is behind
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(0, 0, 200));
}

TEST(PaintedSurface, WhatIsTurnedAwayIsNotDrawn) {
    Squares squares;
    squares.faces.row(0).reverseInPlace();
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(0, 0, 200));
}

TEST(PaintedSurface, LittleLightMakesItDarkerAndSoDoesATurnFromTheLamp) {
    Squares squares;
    squares.paints.brightness.head<4>().setConstant(.5);
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(100, 0, 0));
    squares.options.relief = 1;
    EXPECT_LT(squares.pixel(50, 40)[0], 95);  // the lamp is above the camera
}

TEST(PaintedSurface, PicturesHaveTheirOwnLight) {
    Squares squares;
    squares.light = Eigen::Vector2d(.25, 1);
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(50, 0, 0));
    EXPECT_EQ(squares.pixel(59, 40), Eigen::Vector3i(0, 0, 200));
    squares.light = Eigen::VectorXd::Ones(1);
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
}

TEST(PaintedSurface, AFineSurfaceLooksAsItsControlMeshWhereThatIsFlat) {
    Squares squares;
    squares.options.levels = 2;
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(200, 0, 0));
}

TEST(PaintedSurface, WhatIsOutsideOrBehindTheCameraIsLeftOut) {
    Squares squares;
    squares.vertices.col(0).array() += 100;
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(50, 50, 50));
    squares.vertices.col(0).array() -= 100;
    squares.vertices.col(2).array() -= 2;
    EXPECT_EQ(squares.pixel(50, 40), Eigen::Vector3i(50, 50, 50));
}

TEST(PaintedSurface, WrongInputIsRefused) {
    Squares squares;
    squares.vertices(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
    squares = Squares();
    squares.vertices.conservativeResize(7, 3);
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
    squares = Squares();
    squares.paints.picture_of_face[1] = 2;
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
    squares = Squares();
    squares.paints.pictures[0].pixels.pop_back();
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
    squares = Squares();
    squares.options.finer = 9;
    EXPECT_THROW(squares.pixel(0, 0), InvalidInput);
}

}  // namespace
}  // namespace mimetic
