// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/surface/edge_loop.hpp>
#include <mimetic/surface/ways.hpp>

namespace mimetic {
namespace {

struct Grid {
    Quads quads{9, 4};
    Points vertices{16, 3};

    Grid() {
        for (int v = 0; v < 16; ++v) {
            vertices.row(v) << v % 4, v / 4, 0;
        }
        for (int f = 0; f < 9; ++f) {
            const int at = 4 * (f / 3) + f % 3;
            quads.row(f) << at, at + 1, at + 5, at + 4;
        }
    }
};

TEST(ShortestWay, GoesRoundWhatIsFarAndThroughItsStops) {
    Grid grid;
    grid.vertices(5, 2) = 9;  // a hill
    grid.vertices(6, 2) = 9;
    EXPECT_EQ(shortest_way(grid.quads, grid.vertices, {4, 7}), (std::vector<int>{4, 0, 1, 2, 3, 7}));
    EXPECT_EQ(shortest_way(grid.quads, grid.vertices, {0, 3, 15}), (std::vector<int>{0, 1, 2, 3, 7, 11, 15}));
    EXPECT_EQ(shortest_way(grid.quads, grid.vertices, {2}), (std::vector<int>{2}));
}

TEST(ShortestWay, RefusesWhereThereIsNone) {
    const Grid grid;
    Points more(17, 3);
    more << grid.vertices, Points::Constant(1, 3, 5);
    EXPECT_THROW(shortest_way(grid.quads, more, {0, 16}), InvalidInput);
    EXPECT_THROW(shortest_way(grid.quads, grid.vertices, {0, 16}), InvalidInput);
    EXPECT_THROW(shortest_way(grid.quads, grid.vertices, {}), InvalidInput);
}

TEST(EdgeLoop, GoesStraightOnToTheBorder) {
    const Grid grid;
    EXPECT_EQ(edge_loop(grid.quads, 4, 5), (std::vector<int>{4, 5, 6, 7}));
    EXPECT_EQ(edge_loop(grid.quads, 14, 10), (std::vector<int>{14, 10, 6, 2}));
    EXPECT_THROW(edge_loop(grid.quads, 4, 6), InvalidInput);
}

TEST(NearestSphere, IsFoundFromAPartOfIt) {
    Points points(40, 3);
    for (int i = 0; i < 40; ++i) {
        const double up = .02 * i, round = 2.4 * i;
        points.row(i) << .03 + .012 * std::sin(up) * std::cos(round),
            .01 + .012 * std::sin(up) * std::sin(round), .05 + .012 * std::cos(up);
    }
    const Sphere sphere = nearest_sphere(points);
    EXPECT_LT((sphere.centre - Eigen::Vector3d(.03, .01, .05)).norm(), 1e-9);
    EXPECT_NEAR(sphere.radius, .012, 1e-9);
    EXPECT_THROW(nearest_sphere(points.topRows(3)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
