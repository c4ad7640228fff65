// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/raster/portrait.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Two squares of 2 cm, the second 1 cm behind the first and twice as wide.
struct Squares {
    Points vertices{8, 3};
    Quads faces{2, 4};
    Points colours{2, 3};
    Squares() {
        for (int i = 0; i < 2; ++i) {
            const double wide = .01 * (i + 1), z = -.01 * i;
            vertices.middleRows(4 * i, 4) << -wide, -.01, z, wide, -.01, z, wide, .01, z, -wide, .01, z;
            faces.row(i) << 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3;
        }
        colours << 1, 0, 0, 0, 0, 1;
    }
};

TEST(Portrait, TheNearerFaceIsSeenOnTransparentGround) {
    const Squares squares;
    PortraitOptions options;
    options.size = 40;
    options.height = .08;
    const auto picture = draw_portrait(squares.vertices, squares.faces, squares.colours, options);
    const auto pixel = [&](int x, int y, int k) {
        return picture[static_cast<std::size_t>(4 * (40 * y + x) + k)];
    };
    ASSERT_EQ(picture.size(), 40u * 40 * 4);
    EXPECT_GT(pixel(20, 20, 0), 150);  // the first in the middle
    EXPECT_EQ(pixel(20, 20, 2), 0);
    EXPECT_GT(pixel(12, 20, 2), 150);  // the second beside it
    EXPECT_EQ(pixel(12, 20, 0), 0);
    EXPECT_EQ(pixel(20, 20, 3), 255);
    EXPECT_EQ(pixel(2, 20, 3), 0);
}

TEST(Portrait, FacesWithoutAColourAreLeftOutAndWrongInputIsRefused) {
    Squares squares;
    squares.colours.row(0).setConstant(-1);
    PortraitOptions options;
    options.size = 40;
    options.height = .08;
    const auto picture = draw_portrait(squares.vertices, squares.faces, squares.colours, options);
    EXPECT_GT(picture[4 * (40 * 20 + 20) + 2], 150);
    EXPECT_THROW(draw_portrait(squares.vertices, squares.faces, squares.colours.topRows(1)), InvalidInput);
    squares.faces(0, 0) = 8;
    EXPECT_THROW(draw_portrait(squares.vertices, squares.faces, squares.colours), InvalidInput);
    options.size = 100000;
    EXPECT_THROW(options.check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
