// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/surface.hpp>
#include <set>

namespace mimetic {
namespace {

struct Mesh {
    Points vertices;
    Quads faces;
};

Mesh make_cube() {
    Mesh cube{Points(8, 3), Quads(6, 4)};
    for (int i = 0; i < 8; ++i) {
        cube.vertices.row(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
    }
    cube.faces << 0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5;
    return cube;
}

/// A plane of n x n unit faces with a hole: interior, boundary and corner vertices.
Mesh make_plane(int n) {
    Mesh plane{Points((n + 1) * (n + 1), 3), Quads(n * n - 1, 4)};
    for (int i = 0; i < plane.vertices.rows(); ++i) {
        plane.vertices.row(i) << i % (n + 1), i / (n + 1), 0;
    }
    int row = 0;
    for (int f = 0; f < n * n; ++f) {
        if (f == (n / 2) * n + n / 2) {
            continue;
        }
        const int corner = f / n * (n + 1) + f % n;
        plane.faces.row(row++) << corner, corner + 1, corner + n + 2, corner + n + 1;
    }
    return plane;
}

/// `side` x `side` places on each face, none on an edge.
LimitSurface sample(const Mesh& mesh, int side) {
    const int count = static_cast<int>(mesh.faces.rows()) * side * side;
    Eigen::VectorXi face(count);
    Points2 st(count, 2);
    for (int i = 0; i < count; ++i) {
        face[i] = i / (side * side);
        st.row(i) << (i % side + 0.5) / side, (i / side % side + 0.5) / side;
    }
    return {mesh.faces, static_cast<int>(mesh.vertices.rows()), face, st};
}

TEST(LimitSurface, ConstantsReproduce) {
    const Mesh cube = make_cube();
    const LimitSurface surface = sample(cube, 3);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(8);
    EXPECT_LT((surface.position_stencils() * ones - Eigen::VectorXd::Ones(54)).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((surface.s_tangent_stencils() * ones).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((surface.t_tangent_stencils() * ones).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(LimitSurface, LinearFieldsReproduceOnARegularPlane) {
    const Mesh plane = make_plane(7);
    Eigen::VectorXi face(4);
    face << 8, 9, 12, 35;  // all their vertices have four faces
    Points2 st(4, 2);
    st << 0.1, 0.9, 0.5, 0.5, 0, 1, 0.3, 0.7;
    const LimitSurface surface(plane.faces, static_cast<int>(plane.vertices.rows()), face, st);
    const Points positions = surface.positions(plane.vertices);
    for (int i = 0; i < 4; ++i) {
        const Eigen::RowVector3d corner = plane.vertices.row(plane.faces(face[i], 0));
        EXPECT_LT((positions.row(i) - corner - Eigen::RowVector3d(st(i, 0), st(i, 1), 0)).norm(), 1e-9);
    }
}

TEST(LimitSurface, StaysInThePlaneAroundAHole) {
    const Mesh plane = make_plane(5);
    const LimitSurface surface = sample(plane, 4);
    EXPECT_LT(surface.positions(plane.vertices).col(2).cwiseAbs().maxCoeff(), 1e-12);
    const Points normals = surface.normals(plane.vertices);
    EXPECT_LT((normals.col(2).array() - 1).abs().maxCoeff(), 1e-9);
}

TEST(LimitSurface, CubeCornerMeetsTheLimitMask) {
    // Halstead, Kass & DeRose 1993: limit = (n^2 v + 4 sum of edge neighbours + sum of face neighbours) / (n
    // (n + 5))
    const Mesh cube = make_cube();
    const Points limits = SubdividedMesh(cube.faces, 8, 0).positions(cube.vertices);
    for (int i = 0; i < 8; ++i) {
        // neighbours of (1, 1, 1): edges sum to (1, 1, 1), face diagonals to (-1, -1, -1); n = 3
        const Eigen::RowVector3d expected = (9.0 + 4.0 - 1.0) / 24.0 * cube.vertices.row(i);
        EXPECT_LT((limits.row(i) - expected).norm(), 1e-6) << "corner " << i;
    }
}

TEST(LimitSurface, TangentsMeetFiniteDifferences) {
    const Mesh cube = make_cube();
    constexpr double kStep = 1e-5;
    const std::array<Eigen::RowVector2d, 3> places{Eigen::RowVector2d(0.4, 0.3), {0.9, 0.2}, {0.07, 0.95}};
    for (const Eigen::RowVector2d& place : places) {
        Points2 st(5, 2);
        st << place, place.x() + kStep, place.y(), place.x() - kStep, place.y(), place.x(), place.y() + kStep,
            place.x(), place.y() - kStep;
        const LimitSurface surface(cube.faces, 8, Eigen::VectorXi::Constant(5, 2), st);
        const Points p = surface.positions(cube.vertices);
        const Points ds = surface.s_tangent_stencils() * cube.vertices;
        const Points dt = surface.t_tangent_stencils() * cube.vertices;
        EXPECT_LT((ds.row(0) - (p.row(1) - p.row(2)) / (2 * kStep)).norm(), 1e-5);
        EXPECT_LT((dt.row(0) - (p.row(3) - p.row(4)) / (2 * kStep)).norm(), 1e-5);
        const Eigen::RowVector3d normal = surface.normals(cube.vertices).row(0);
        EXPECT_NEAR(normal.norm(), 1, 1e-12);
        EXPECT_GT(normal.dot(p.row(0)), 0) << "outwards";
    }
}

TEST(LimitSurface, IgnoresVerticesThatNoFaceUses) {
    const Mesh cube = make_cube();
    Points vertices = Points::Constant(10, 3, 1e9);
    vertices.topRows(8) = cube.vertices;
    const LimitSurface surface(cube.faces, 10, Eigen::VectorXi::Zero(1), Points2::Constant(1, 2, 0.5));
    EXPECT_LT(surface.positions(vertices).norm(), 2);
}

TEST(LimitSurface, NamesTheBadFaceOrPoint) {
    Mesh cube = make_cube();
    const Points2 centre = Points2::Constant(1, 2, 0.5);
    const auto message = [&](int face, const Points2& st) -> std::string {
        try {
            LimitSurface(cube.faces, 8, Eigen::VectorXi::Constant(1, face), st);
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message(6, centre).find("face 6"), std::string::npos);
    EXPECT_NE(message(0, Points2::Constant(1, 2, NAN)).find("point 0"), std::string::npos);
    cube.faces(3, 1) = cube.faces(3, 0);
    EXPECT_NE(message(0, centre).find("face 3"), std::string::npos);
    cube.faces(3, 1) = 8;
    EXPECT_NE(message(0, centre).find("vertex 8"), std::string::npos);
}

TEST(SubdividedMesh, LevelsNestOnTheSameSurface) {
    const Mesh cube = make_cube();
    const SubdividedMesh one(cube.faces, 8, 1);
    const SubdividedMesh two(cube.faces, 8, 2);
    EXPECT_EQ(one.num_refined(), 26);
    EXPECT_EQ(one.faces().rows(), 24);
    EXPECT_EQ(two.num_refined(), 98);
    EXPECT_EQ(two.faces().rows(), 96);
    // The first face's corner child shares its first vertex and, at (1/2, 1/2), a vertex two columns on.
    const Points coarse = one.positions(cube.vertices);
    const Points fine = two.positions(cube.vertices);
    EXPECT_LT((coarse.topRows(8) - fine.topRows(8)).norm(), 1e-9);
    EXPECT_LT((coarse.row(one.faces()(0, 2)) - fine.row(two.faces()(5, 2))).norm(), 1e-9);
}

TEST(SubdividedMesh, IsClosedAndOrientedAsItsParents) {
    const Mesh cube = make_cube();
    const SubdividedMesh mesh(cube.faces, 8, 3);
    std::set<std::pair<int, int>> directed;
    double volume = 0;
    const Points p = mesh.positions(cube.vertices);
    for (int f = 0; f < mesh.faces().rows(); ++f) {
        EXPECT_EQ(mesh.parent_face()[f], f / 64);
        for (int k = 0; k < 4; ++k) {
            EXPECT_TRUE(directed.emplace(mesh.faces()(f, k), mesh.faces()(f, (k + 1) % 4)).second);
        }
        for (int k = 1; k < 3; ++k) {
            const Eigen::Vector3d a = p.row(mesh.faces()(f, 0));
            const Eigen::Vector3d b = p.row(mesh.faces()(f, k));
            volume += a.dot(b.cross(Eigen::Vector3d(p.row(mesh.faces()(f, k + 1))))) / 6;
        }
    }
    for (const auto& [from, to] : directed) {
        EXPECT_TRUE(directed.count({to, from})) << from << " " << to;
    }
    EXPECT_GT(volume, 0.5);
    EXPECT_LT(volume, 8);
}

TEST(SubdividedMesh, RejectsLooseVerticesAndTooManyLevels) {
    const Mesh cube = make_cube();
    EXPECT_THROW(SubdividedMesh(cube.faces, 9, 1), InvalidInput);
    EXPECT_THROW(SubdividedMesh(cube.faces, 8, 6), InvalidInput);
    EXPECT_THROW(SubdividedMesh(Quads(0, 4), 0, 1), InvalidInput);
}

}  // namespace
}  // namespace mimetic
