// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/register/foreign_skin.hpp>
#include <mimetic/register/loose_parts.hpp>
#include <mimetic/register/registration.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// A flat sheet of (count + 1)^2 points in x and y that looks along z, metres; triangles from `first` on.
struct Sheet {
    Points vertices;
    Triangles triangles;
};

Sheet sheet(int count, double side, double height) {
    const int row = count + 1;
    Sheet made{Points(row * row, 3), Triangles(2 * count * count, 3)};
    for (int y = 0; y < row; ++y) {
        for (int x = 0; x < row; ++x) {
            made.vertices.row(y * row + x) << side * x / count, side * y / count, height;
        }
    }
    for (int y = 0, t = 0; y < count; ++y) {
        for (int x = 0; x < count; ++x) {
            const int a = y * row + x;
            made.triangles.row(t++) << a, a + 1, a + row + 1;
            made.triangles.row(t++) << a, a + row + 1, a + row;
        }
    }
    return made;
}

LippedSurface lipped(const Sheet& from) {
    const MuscleSurface surface(from.vertices, from.triangles,
                                std::vector<bool>(static_cast<std::size_t>(from.triangles.rows()), true));
    Points lips(2, 3);
    lips << from.vertices.row(from.vertices.rows() - 1), from.vertices.row(0);
    return LippedSurface(from.vertices, from.triangles, surface, lips);
}

TEST(CarrierRows, APlaceMovesWithItsCornersTheLessTheFartherOffItIs) {
    SkinPlaces places{Triangles(3, 3), Points(3, 3), Eigen::Vector3d(.001, .0075, .02)};
    places.corners << 0, 1, 2, 0, 1, 2, 0, 1, 2;
    places.weights << .5, .25, .25, .5, .25, .25, .5, .25, .25;
    SparseRows stencils(3, 2);
    stencils.insert(0, 0) = 1;
    stencils.insert(1, 1) = 1;
    stencils.insert(2, 0) = .5;
    stencils.insert(2, 1) = .5;
    const Eigen::MatrixXd rows = carrier_rows(places, stencils, .01);
    EXPECT_TRUE(rows.row(0).isApprox(Eigen::RowVector2d(.625, .375)));
    EXPECT_TRUE(rows.row(1).isApprox(.5 * Eigen::RowVector2d(.625, .375)));
    EXPECT_TRUE(rows.row(2).isZero(0));
    places.corners(0, 0) = 3;
    EXPECT_THROW(carrier_rows(places, stencils, .01), InvalidInput);
}

TEST(CutFaces, AQuadIsCutAlongItsShorterDiagonal) {
    Points points(4, 3);
    points << 0, 0, 0, 3, 1, 0, 4, 4, 0, 1, 3, 0;
    LongQuads faces(2, 4);
    faces << 0, 1, 2, 3, 0, 1, 2, -1;
    const CutFaces cut = cut_faces(points, faces);
    Triangles expected(3, 3);
    expected << 0, 1, 2, 0, 1, 3, 1, 2, 3;
    EXPECT_TRUE(cut.triangles == expected);
    EXPECT_TRUE(cut.face == Eigen::Vector3i(1, 0, 0));
    faces(1, 2) = 9;
    EXPECT_THROW(cut_faces(points, faces), InvalidInput);
}

TEST(CutPolygons, TheFanStartsWhereNoTriangleIsASliver) {
    Points points(5, 3);
    points << 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0;  // the second lies on a straight edge
    const PolygonPieces pieces = cut_polygons(points, {0}, {0, 1, 2, 3, 4});
    ASSERT_EQ(pieces.faces.rows(), 3);
    EXPECT_EQ(pieces.faces(0, 0), 1);
    EXPECT_TRUE((pieces.faces.col(3).array() == -1).all());
    EXPECT_THROW(cut_polygons(points, {0}, {0, 1}), InvalidInput);
    EXPECT_THROW(cut_polygons(points, {0}, {0, 1, 5}), InvalidInput);
    EXPECT_THROW(cut_polygons(points, {}, {}), InvalidInput);
}

TEST(PlaceMesh, AMirroredObjectIsTurnedOver) {
    Points points(3, 3);
    points << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    LongQuads faces(1, 4);
    faces << 0, 1, 2, -1;
    Eigen::Matrix4d mirror = Eigen::Vector4d(-2, 2, 2, 1).asDiagonal();
    const PlacedMesh placed = place_mesh(points, faces, mirror);
    EXPECT_EQ(placed.vertices(1, 0), -2);
    EXPECT_EQ(placed.faces(0, 0), 2);
    EXPECT_EQ(placed.faces(0, 3), -1);
    mirror(0, 0) = 0;
    EXPECT_THROW(place_mesh(points, faces, mirror), InvalidInput);
}

TEST(Warp, LandmarksGoWhereTheyShallAndWhatIsFarIsNotSheared) {
    Points source(3, 3), target(3, 3);
    source << 0, 0, 0, .1, 0, 0, 0, .1, 0;
    target << 0, 0, .01, .1, 0, .02, 0, .1, .01;
    EXPECT_TRUE(warp_points(source, source, target).isApprox(target, 1e-12));
    Points far(2, 3);
    far << 100, 0, 0, 101, 0, 0;
    const Points moved = warp_points(far, source, target);
    EXPECT_NEAR(moved(1, 0) - moved(0, 0), 1, 1e-4);
    source.row(1) = source.row(0);
    EXPECT_THROW(warp_points(far, source, target), InvalidInput);
}

TEST(LippedSurface, BackToBackSkinIsToldByItsNormal) {
    Sheet both = sheet(10, .1, 0);
    Sheet back = sheet(10, .1, .001);
    const Eigen::Index count = both.vertices.rows();
    back.triangles.col(1).swap(back.triangles.col(2));
    Points vertices(2 * count, 3);
    vertices << both.vertices, back.vertices;
    Triangles triangles(2 * both.triangles.rows(), 3);
    triangles << both.triangles, (back.triangles.array() + static_cast<int>(count)).matrix();
    const LippedSurface surface = lipped({vertices, triangles});
    Points point(1, 3), normal(1, 3);
    point << .05, .05, .0008;  // nearer to the back
    normal << 0, 0, 1;
    const SkinPlaces front = surface.find(point, normal, Eigen::VectorXd::Zero(1));
    EXPECT_LT(front.corners.maxCoeff(), count);
    EXPECT_NEAR(front.gaps[0], .0008, 1e-12);
}

TEST(DrawToSurface, ASheetComesToLieOnAnotherOne) {
    const Sheet own = sheet(8, .08, 0), other = sheet(12, .12, .004);
    Sheet shifted = other;
    shifted.vertices.leftCols(2).array() -= .02;
    const Eigen::Index count = own.vertices.rows();
    SparseRows identity(count, count);
    identity.setIdentity();
    LaidTemplate laid{own.vertices, lipped(own), std::vector<bool>(static_cast<std::size_t>(count), true),
                      identity,     {40},        {{{0, 1}, {80}}}};
    Points target = own.vertices.row(40);
    target(0, 2) = .004;
    const Points drawn = draw_to_surface(laid, target, lipped(shifted), .03);
    EXPECT_NEAR(drawn(40, 2), .004, 1e-4);
    EXPECT_NEAR(drawn(20, 2), .004, 1e-4);
    EXPECT_NEAR(drawn(80, 2), .008, 2e-4);  // itself drawn, and carried with the first two
}

class ForeignSkinTest : public testing::Test {
protected:
    void SetUp() override {
        const Sheet skin = sheet(10, .1, 0), patch = sheet(2, .004, .002);
        const Eigen::Index count = skin.vertices.rows();
        points.resize(count + patch.vertices.rows() + 1, 3);
        points << skin.vertices, patch.vertices, skin.vertices.row(7);  // the last one lies on the skin
        triangles.resize(skin.triangles.rows() + patch.triangles.rows(), 3);
        triangles << skin.triangles, (patch.triangles.array() + static_cast<int>(count)).matrix();
        triangles(0, 1) = 1;
        for (int& corner : triangles.reshaped()) {
            corner = corner == 7 && ++seen > 1 ? static_cast<int>(points.rows()) - 1 : corner;
        }
        face = Eigen::VectorXi::LinSpaced(triangles.rows(), 0, static_cast<int>(triangles.rows()) - 1);
        marks.names = {"nose", "chin"};
        marks.places.resize(2, 3);
        marks.places << .05, .05, 0, .05, .02, 0;
        marks.front = {0, 1};
    }

    Points points;
    Triangles triangles;
    Eigen::VectorXi face;
    NamedPlaces marks;
    int seen = 0;
};

TEST_F(ForeignSkinTest, WhatLiesAtOnePlaceIsOneAndTheRestIsLoose) {
    const ForeignSkin skin = read_foreign_skin(points, {triangles, face}, marks, {});
    EXPECT_EQ(skin.vertices.rows(), 121);
    EXPECT_EQ(skin.skin_vertex[7], skin.skin_vertex[points.rows() - 1]);
    EXPECT_EQ(skin.loose[7], -1);
    EXPECT_EQ(skin.skin_vertex[121], -1);
    EXPECT_EQ(skin.loose[121], skin.loose[129]);
    const LooseParts sorted = sort_loose_parts(skin, skin.vertices, std::vector<TemplatePart>(121));
    EXPECT_EQ(sorted.following.size(), 9u);
    const LooseParts on_jaw =
        sort_loose_parts(skin, skin.vertices, std::vector<TemplatePart>(121, TemplatePart::lower_jaw));
    EXPECT_TRUE(on_jaw.on_jaw[121]);
    EXPECT_FALSE(on_jaw.on_jaw[7]);
    EXPECT_TRUE(on_jaw.following.empty());
}

/// Points of a sphere, ring by ring from pole to pole.
Points ball(int rings, int around, double radius, const Eigen::RowVector3d& centre) {
    Points points(static_cast<Eigen::Index>(rings) * around, 3);
    for (int i = 0; i < rings; ++i) {
        const double down = M_PI * (i + .5) / rings;
        for (int j = 0; j < around; ++j) {
            const double side = 2 * M_PI * j / around;
            points.row(static_cast<Eigen::Index>(i) * around + j) =
                centre + radius * Eigen::RowVector3d(std::sin(down) * std::cos(side),
                                                     std::sin(down) * std::sin(side), std::cos(down));
        }
    }
    return points;
}

/// Quads of a grid of rings x around points that closes on itself, as triangles from a first vertex on.
Triangles strips_of(int rings, int around, int first) {
    Triangles strips(2 * (rings - 1) * around, 3);
    Eigen::Index row = 0;
    for (int i = 0; i + 1 < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const int a = first + i * around + j, b = first + i * around + (j + 1) % around;
            strips.row(row++) << a, a + around, b;
            strips.row(row++) << b, a + around, b + around;
        }
    }
    return strips;
}

TEST(LoosePartsTest, ADenseEyeballIsOneThoughTheTemplatesSocketLiesNearer) {
    const Sheet sheet_ahead = sheet(10, .1, 0);
    const Eigen::RowVector3d centre(.05, .05, -.016);
    const int rings = 60, around = 90;
    const Points own = ball(rings, around, .0155, centre);
    const Eigen::Index count = sheet_ahead.vertices.rows();
    Points points(count + own.rows(), 3);
    points << sheet_ahead.vertices, own;
    const Triangles strips = strips_of(rings, around, static_cast<int>(count));
    Triangles triangles(sheet_ahead.triangles.rows() + strips.rows(), 3);
    triangles << sheet_ahead.triangles, strips;
    NamedPlaces marks;
    marks.names = {"nose", "chin"};
    marks.places.resize(2, 3);
    marks.places << .05, .05, 0, .05, .02, 0;
    marks.front = {0, 1};
    const Eigen::VectorXi face =
        Eigen::VectorXi::LinSpaced(triangles.rows(), 0, static_cast<int>(triangles.rows()) - 1);
    const ForeignSkin skin = read_foreign_skin(points, {triangles, face}, marks, {});
    const Points eye = ball(5, 8, .0158, centre), socket = ball(20, 30, .0162, centre);
    Points laid(eye.rows() + socket.rows(), 3);
    laid << eye, socket;
    std::vector<TemplatePart> parts(static_cast<std::size_t>(laid.rows()), TemplatePart::other);
    std::fill_n(parts.begin(), eye.rows(), TemplatePart::right_eye);
    const LooseParts sorted = sort_loose_parts(skin, laid, parts);
    EXPECT_TRUE(sorted.on_eye[1][static_cast<std::size_t>(count) + 100]);
    EXPECT_FALSE(sorted.on_eye[0][static_cast<std::size_t>(count) + 100]);
    EXPECT_FALSE(sorted.on_eye[1][7]);
    EXPECT_TRUE(sorted.following.empty());
    // A lash, which lies at the eyeball's front and not around it, is none
    const Points lash = ball(60, 90, .002, centre + Eigen::RowVector3d(0, 0, .0165));
    points.bottomRows(own.rows()) = lash;
    const ForeignSkin with_lash = read_foreign_skin(points, {triangles, face}, marks, {});
    EXPECT_FALSE(sort_loose_parts(with_lash, laid, parts).on_eye[1][static_cast<std::size_t>(count) + 100]);
}

TEST(LoosePartsTest, AShellBeforeAnEyeIsOfTheEyeAndARingOfLashesIsNot) {
    const Sheet sheet_ahead = sheet(10, .1, 0);
    const Eigen::RowVector3d centre(.05, .05, -.016);
    const int rings = 12, around = 16;
    const auto count = static_cast<int>(sheet_ahead.vertices.rows());
    NamedPlaces marks;
    marks.names = {"nose", "chin"};
    marks.places.resize(2, 3);
    marks.places << .05, .05, 0, .05, .02, 0;
    marks.front = {0, 1};
    // The template's socket lies nearer to a shell than the few points of its eyeball do
    const Points eye = ball(5, 8, .0158, centre), socket = ball(20, 30, .0195, centre);
    Points laid(eye.rows() + socket.rows(), 3);
    laid << eye, socket;
    std::vector<TemplatePart> parts(static_cast<std::size_t>(laid.rows()), TemplatePart::other);
    std::fill_n(parts.begin(), eye.rows(), TemplatePart::left_eye);
    const auto is_eye = [&](int first_ring, int num_rings) -> bool {
        // The shell is a little larger than the template's eyeball and a little before it
        const Points whole = ball(2 * rings, around, 1.23 * .0158, centre + Eigen::RowVector3d(0, 0, .004));
        const Points own =
            whole.middleRows(Eigen::Index{first_ring} * around, Eigen::Index{num_rings} * around);
        Points points(count + own.rows(), 3);
        points << sheet_ahead.vertices, own;
        const Triangles strips = strips_of(num_rings, around, count);
        Triangles triangles(sheet_ahead.triangles.rows() + strips.rows(), 3);
        triangles << sheet_ahead.triangles, strips;
        const Eigen::VectorXi face =
            Eigen::VectorXi::LinSpaced(triangles.rows(), 0, static_cast<int>(triangles.rows()) - 1);
        const ForeignSkin skin = read_foreign_skin(points, {triangles, face}, marks, {});
        return sort_loose_parts(skin, laid, parts).on_eye[0][static_cast<std::size_t>(count) + 3];
    };
    EXPECT_TRUE(is_eye(0, rings));
    EXPECT_TRUE(is_eye(0, 2 * rings / 3));
    EXPECT_FALSE(is_eye(rings / 2, 3));
    EXPECT_FALSE(is_eye(rings, rings)) << "a socket that is seen from within";
}

TEST_F(ForeignSkinTest, BadMeshesAreNamed) {
    const CutFaces cut{triangles, face};
    NamedPlaces off = marks;
    off.places(1, 2) = .05;
    EXPECT_THROW(read_foreign_skin(points, cut, off, {}), InvalidInput);
    Triangles inwards = triangles;
    inwards.col(1).swap(inwards.col(2));
    EXPECT_THROW(read_foreign_skin(points, {inwards, face}, marks, {}), InvalidInput);
    points.row(triangles(4, 1)) = (points.row(triangles(4, 0)) + points.row(triangles(4, 2))) / 2;
    EXPECT_THROW(read_foreign_skin(points, cut, marks, {}), InvalidInput);
}

TEST_F(ForeignSkinTest, AHoleIsFoundUnlessItBelongsThere) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        if (t != 88 && t != 89) {
            kept.push_back(t);
        }
    }
    const Triangles open = triangles(kept, Eigen::all);
    const Eigen::VectorXi own = face(kept);
    const ForeignSkin skin = read_foreign_skin(points, {open, own}, marks, {});
    const std::vector<bool> free(static_cast<std::size_t>(skin.vertices.rows()), true);
    Points far(1, 3);
    far << 1, 1, 1;
    const Eigen::VectorXd reach = Eigen::VectorXd::Constant(1, .02);
    EXPECT_EQ(find_holes(skin, free, far, reach).size(), 1u);
    far << .045, .045, 0;
    EXPECT_TRUE(find_holes(skin, free, far, reach).empty());
}

TEST(Seam, IsFoundWhereLipsAreOneSurface) {
    const Sheet skin = sheet(40, .1, 0);
    Points inner(2, 3), corners(2, 3);
    inner << .05, .0525, 0, .05, .0475, 0;
    corners << .075, .05, 0, .025, .05, 0;
    const std::vector<bool> seam = find_seam(skin.vertices, skin.triangles, inner, corners);
    EXPECT_GT(std::count(seam.begin(), seam.end(), true), 5);
    EXPECT_FALSE(seam[0]);
    std::vector<Eigen::Index> kept;  // cut open between the lips
    for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
        const Eigen::Index y = t / 80, x = (t % 80) / 2;
        if (y != 20 || x < 8 || x > 31) {
            kept.push_back(t);
        }
    }
    const Triangles cut = skin.triangles(kept, Eigen::all);
    inner(1, 1) = .05;
    const std::vector<bool> open = find_seam(skin.vertices, cut, inner, corners);
    EXPECT_EQ(std::count(open.begin(), open.end(), true), 0);
}

TEST(GuessPlaces, AUsualHeadMovedAndScaledFindsItsOwnPlaces) {
    Points head(200, 3);
    for (int i = 0; i < 200; ++i) {
        const double up = .2 * i / 199, turn = 2.4 * i;
        head.row(i) << .07 * std::cos(turn), .09 * std::sin(turn), up;
    }
    head.row(100) << 0, -.11, .1;
    Points places(2, 3);
    places << head.row(100), head.row(120);
    const Eigen::RowVector3d shift(.3, .1, -.4);
    const Points moved = (1.2 * head).rowwise() + shift;
    const Points guessed = guess_places(moved, head, places, 0);
    EXPECT_LT((guessed.row(0) - moved.row(100)).norm(), 1e-12);
    EXPECT_THROW(guess_places(Points(0, 3), head, places, 0), InvalidInput);
}

}  // namespace
}  // namespace mimetic
