// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/raster/texture.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// A square before the camera that fills its picture, red on the left and blue on the right; its texture's
/// left three quarters are laid out.
class TextureTest : public testing::Test {
protected:
    void SetUp() override {
        points << -.1, -.1, 1, .1, -.1, 1, .1, .1, 1, -.1, .1, 1;
        faces << 0, 3, 2, 1;
        layout = {faces, Points2(4, 2), 32};
        layout.corners << 0, 1, 0, 0, .75, 0, .75, 1;
        pixels.assign(32 * 32 * 3, 0);
        for (int i = 0; i < 32 * 32; ++i) {
            pixels[static_cast<std::size_t>(3 * i + (i % 32 < 16 ? 0 : 2))] = 200;
        }
    }

    ColorView image() const { return {pixels.data(), 32, 32, 96}; }

    Camera camera{160, 160, 15.5, 15.5, 32, 32};
    Points points{4, 3};
    Points normals = Eigen::RowVector3d(0, 0, -1).replicate(4, 1);
    Quads faces{1, 4};
    TextureLayout layout;
    std::vector<std::uint8_t> pixels;
};

TEST_F(TextureTest, ValuesAreInterpolatedAcrossAFace) {
    const MatrixRows picture = unwrap_values(layout, points.leftCols(2));
    EXPECT_NEAR(picture(32 * 16 + 12, 0), -.1 + .2 * 12.5 / 24, .002);
    EXPECT_NEAR(picture(32 * 16 + 12, 1), -.1 + .2 * 16.5 / 32, .002);
    EXPECT_NEAR(picture(24, 0), .1, 1e-12);  // the face's edge reaches into it
    EXPECT_EQ(picture(25, 0), 0);            // no face is there
    layout.corners(2, 0) = 1.5;
    EXPECT_THROW(unwrap_values(layout, points), InvalidInput);
    layout.corners(2, 0) = .75;
    layout.faces(0, 0) = 4;
    EXPECT_THROW(unwrap_values(layout, points), InvalidInput);
}

TEST_F(TextureTest, ColoursComeFromTheFrameAndGoOnWhereNoneIsSeen) {
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(4);
    const ProjectedTexture projected = project_texture(camera, image(), points, normals, layout, one);
    const auto colour = [&](int row, int col) { return &projected.texture.pixels[3 * (32 * row + col)]; };
    EXPECT_EQ(colour(16, 4)[0], 200);
    EXPECT_EQ(colour(16, 4)[2], 0);
    EXPECT_EQ(colour(16, 20)[2], 200);
    EXPECT_GT(colour(16, 27)[2], 100);  // beyond the face
}

TEST_F(TextureTest, WhatIsTurnedAwayOrOutOfThePictureIsRefused) {
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(4);
    Points aside = points;
    aside.col(0).array() += 5;
    EXPECT_THROW(project_texture(camera, image(), aside, normals, layout, one), InvalidInput);
    EXPECT_THROW(project_texture(camera, image(), points, normals, layout, 0 * one), InvalidInput);
    EXPECT_THROW(project_texture(camera, image(), points, -normals, layout, one), InvalidInput);
    layout.size = 24;
    EXPECT_THROW(project_texture(camera, image(), points, normals, layout, one), InvalidInput);
}

}  // namespace
}  // namespace mimetic
