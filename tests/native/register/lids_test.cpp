// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <mimetic/register/face_units.hpp>
#include <mimetic/register/lids.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

namespace mimetic {
namespace {

constexpr double kRadius = .012;

struct Ball {
    Points vertices;
    Triangles triangles;
};

/// A ball with its pole in front, outward.
Ball ball(const Eigen::RowVector3d& centre, double radius, int rings = 40) {
    const int around = 2 * rings;
    Ball made{Points((rings + 1) * around, 3), Triangles(2 * rings * around, 3)};
    for (int i = 0; i <= rings; ++i) {
        for (int k = 0; k < around; ++k) {
            const double down = std::numbers::pi * (i + 1e-3) / (rings + 2e-3),
                         turn = 2 * std::numbers::pi * k / around;
            made.vertices.row(i * around + k) =
                centre + radius * Eigen::RowVector3d(std::sin(down) * std::cos(turn),
                                                     std::sin(down) * std::sin(turn), std::cos(down));
        }
    }
    int row = 0;
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < around; ++k) {
            const int a = i * around + k, b = i * around + (k + 1) % around;
            made.triangles.row(row++) << a, a + around, b;
            made.triangles.row(row++) << b, a + around, b + around;
        }
    }
    return made;
}

/// A sheet in x and y with a slit along x, 2 mm wide, metres; an eye .3 mm under its middle.
class SlitTest : public testing::Test {
protected:
    static constexpr int kSide = 24, kRow = kSide + 1, kFirst = 7, kLast = 16;  // of the slit's cells

    void SetUp() override {
        vertices.resize(kRow * kRow, 3);
        for (int y = 0; y < kRow; ++y) {
            for (int x = 0; x < kRow; ++x) {
                vertices.row(y * kRow + x) << .001 * x, .001 * y + (y > kSide / 2 ? .001 : 0), 0;
            }
        }
        slit.upper = rim(kSide / 2 + 1);
        slit.lower = rim(kSide / 2);
        const Ball made = ball({.012, .0125, -kRadius - .0003}, kRadius);
        eye = EyeSurface({.012, .0125, -kRadius - .0003}, made.vertices, made.triangles);
    }

    MuscleSurface sheet(bool is_cut) const {
        std::vector<Eigen::RowVector3i> rows;
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const int a = y * kRow + x;
                if (!is_cut || y != kSide / 2 || x < kFirst || x > kLast) {
                    rows.emplace_back(a, a + 1, a + kRow + 1);
                    rows.emplace_back(a, a + kRow + 1, a + kRow);
                }
            }
        }
        Triangles triangles(rows.size(), 3);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            triangles.row(static_cast<Eigen::Index>(i)) = rows[i];
        }
        return {vertices, triangles, std::vector<bool>(rows.size(), true)};
    }

    static SkinPlaces rim(int y) {
        const Eigen::Index count = kLast - kFirst;
        SkinPlaces places{Triangles(count, 3), Points::Zero(count, 3), Eigen::VectorXd::Zero(count)};
        for (int i = 0; i < count; ++i) {
            places.corners.row(i).setConstant(y * kRow + kFirst + 1 + i);
            places.weights(i, 0) = 1;
        }
        return places;
    }

    static double least_turn(const MuscleSurface& surface, const Points& shape) {
        double least = std::numeric_limits<double>::infinity();
        for (Eigen::Index t = 0; t < surface.triangles().rows(); ++t) {
            const Eigen::RowVector3i c = surface.triangles().row(t);
            const Eigen::RowVector3d a = shape.row(c[1]) - shape.row(c[0]),
                                     b = shape.row(c[2]) - shape.row(c[0]);
            least = std::min(least, a.cross(b).z());
        }
        return least;
    }

    Points vertices;
    SlitPlaces slit;
    EyeSurface eye;
};

TEST_F(SlitTest, RimsMeetAndNoTriangleTurnsOver) {
    const MuscleSurface surface = sheet(true);
    const Points nothing = Points::Zero(vertices.rows(), 3);
    EXPECT_NEAR(rim_gaps(vertices, nothing, slit).maxCoeff(), .002, 1e-9);
    const Points closed = close_slit(surface, nothing, slit, {.9, .008, false});
    EXPECT_LT(rim_gaps(vertices, closed, slit).maxCoeff(), 1e-4);
    EXPECT_GT(least_turn(surface, vertices + closed), 0);
    EXPECT_LT(closed.row(0).norm(), 1e-12);  // beyond the reach
    const double upper = slit.upper.values(closed).rowwise().norm().mean(),
                 lower = slit.lower.values(closed).rowwise().norm().mean();
    EXPECT_NEAR(upper / (upper + lower), .9, .02);
}

TEST_F(SlitTest, RimsThatKeepTheirGapAreLeftAlone) {
    const Points nothing = Points::Zero(vertices.rows(), 3);
    EXPECT_LT(close_slit(sheet(true), nothing, slit, {.5, .008, true}).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(SlitTest, SkinStaysOutsideOfTheEye) {
    const MuscleSurface surface = sheet(true);
    Points sunk = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index v = 0; v < sunk.rows(); ++v) {
        const double from_rim = (vertices(v, 1) - .013) / .004;
        if (from_rim >= 0) {
            sunk(v, 2) = -.001 * std::exp(-from_rim * from_rim);
        }
    }
    const double before = largest_depth(surface, sunk, slit, eye, .008);
    const double after =
        largest_depth(surface, close_slit(surface, sunk, slit, {.9, .008, false}, eye), slit, eye, .008);
    EXPECT_GT(before, .0004);
    EXPECT_LT(after, 5e-5);
}

TEST_F(SlitTest, SkinOverASlitJoinsIt) {
    const Points top = slit.upper.values(vertices), bottom = slit.lower.values(vertices);
    EXPECT_FALSE(are_joined(sheet(true), top, bottom));
    EXPECT_TRUE(are_joined(sheet(false), top, bottom));
}

TEST(EyeSurface, DepthIsUnderTheOutermostShellAndOnlyInFront) {
    const Ball outer = ball({0, 0, 0}, kRadius), inner = ball({0, 0, 0}, .010);
    Points vertices(2 * outer.vertices.rows(), 3);
    vertices << outer.vertices, inner.vertices;
    Triangles triangles(2 * outer.triangles.rows(), 3);
    triangles << outer.triangles, inner.triangles.array() + static_cast<int>(outer.vertices.rows());
    const EyeSurface eye(Eigen::Vector3d::Zero(), vertices, triangles);
    Points points(3, 3);
    points << .003, .002, .009, 0, .005, .014, 0, 0, -.009;
    const Eigen::VectorXd depths = eye.depths(points);
    EXPECT_NEAR(depths[0], kRadius - points.row(0).norm(), 2e-5);
    EXPECT_NEAR(depths[1], kRadius - points.row(1).norm(), 2e-5);
    EXPECT_EQ(depths[2], -std::numeric_limits<double>::infinity());
    EXPECT_FALSE(EyeSurface().is_there());
    EXPECT_NEAR(eye.lifted(points, 1e-3).row(0).norm(), kRadius + 1e-3, 2e-5);
    triangles(0, 0) = static_cast<int>(vertices.rows());
    EXPECT_THROW(EyeSurface(Eigen::Vector3d::Zero(), vertices, triangles), InvalidInput);
}

}  // namespace
}  // namespace mimetic
