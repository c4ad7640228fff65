// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/raster/shaded.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kDistance = 2;
const Camera kCamera{100, 100, 49.5, 39.5, 100, 80};
const Eigen::Vector3d kFront = Eigen::Vector3d::UnitZ();

/// A square in the plane z = `depth`, and a smaller one in front of its right half.
ShadedMesh two_squares() {
    ShadedMesh mesh;
    mesh.vertices.resize(8, 3);
    mesh.vertices << -.5, -.5, 0, .5, -.5, 0, .5, .5, 0, -.5, .5, 0,  //
        .1, -.1, .4, .3, -.1, .4, .3, .1, .4, .1, .1, .4;
    mesh.triangles.resize(4, 3);
    mesh.triangles << 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7;
    mesh.normals = vertex_normals(mesh.vertices, mesh.triangles);
    mesh.colours = Points::Constant(4, 3, 200);
    mesh.colours.bottomRows(2).setConstant(100);
    return mesh;
}

int red(const ShadedPicture& shaded, int x, int y) {
    return shaded.picture.pixels[3 * shaded.raster.index(x, y)];
}

TEST(Shaded, ShowsTheNearestAndWhereItIs) {
    const ShadedMesh mesh = two_squares();
    const ShadedPicture shaded = draw_shaded(kCamera, mesh, kDistance, kFront);
    const Eigen::Vector3d point(.2, .05, .4);
    const Eigen::Vector2d pixel = kCamera.project({point.x(), -point.y(), kDistance - point.z()});
    EXPECT_LT((shown_point(kCamera, mesh, kDistance, shaded.raster, pixel) - point).norm(), 1e-12);
    EXPECT_EQ(red(shaded, static_cast<int>(pixel.x() + .5), static_cast<int>(pixel.y() + .5)), 100);
    EXPECT_EQ(red(shaded, 40, 40), 200);
    EXPECT_FALSE(shown_point(kCamera, mesh, kDistance, shaded.raster, {2, 2}).allFinite());
    EXPECT_FALSE(shown_point(kCamera, mesh, kDistance, shaded.raster, {-9, 200}).allFinite());
}

TEST(Shaded, LightsBothSidesAlike) {
    ShadedMesh mesh = two_squares();
    const ShadedPicture outside = draw_shaded(kCamera, mesh, kDistance, kFront);
    mesh.triangles.col(1).swap(mesh.triangles.col(2));
    mesh.normals = vertex_normals(mesh.vertices, mesh.triangles);
    EXPECT_EQ(draw_shaded(kCamera, mesh, kDistance, kFront).picture.pixels, outside.picture.pixels);
    const Eigen::Vector3d aside = Eigen::Vector3d(1, 0, 1).normalized();
    EXPECT_LT(red(draw_shaded(kCamera, mesh, kDistance, aside), 40, 40), red(outside, 40, 40));
}

TEST(Shaded, RefusesWhatIsNoMesh) {
    ShadedMesh mesh = two_squares();
    mesh.triangles(0, 0) = 8;
    EXPECT_THROW(draw_shaded(kCamera, mesh, kDistance, kFront), InvalidInput);
    mesh = two_squares();
    mesh.vertices(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(draw_shaded(kCamera, mesh, kDistance, kFront), InvalidInput);
    mesh = two_squares();
    mesh.colours.conservativeResize(3, 3);
    EXPECT_THROW(draw_shaded(kCamera, mesh, kDistance, kFront), InvalidInput);
}

}  // namespace
}  // namespace mimetic
