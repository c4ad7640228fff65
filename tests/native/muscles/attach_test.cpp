// SPDX-License-Identifier: GPL-3.0-or-later
// A patch of skin like a mask: 20 x 20 quads of 8 mm, bulging forwards, held at its rim.
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/muscles/attach.hpp>
#include <mimetic/muscles/skin_modes.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_check.hpp>

namespace mimetic {
namespace {

constexpr int kSide = 20;
constexpr double kStep = 0.008;

Points make_mask(double size = 1) {
    Points vertices((kSide + 1) * (kSide + 1), 3);
    for (int v = 0; v < vertices.rows(); ++v) {
        const double x = kStep * (v % (kSide + 1) - kSide / 2);
        const double y = kStep * (v / (kSide + 1) - kSide / 2);
        vertices.row(v) << size * x, size * y, size * (0.08 - 2 * (x * x + y * y));
    }
    return vertices;
}

Quads make_quads() {
    Quads quads(kSide * kSide, 4);
    for (int f = 0; f < quads.rows(); ++f) {
        const int a = f / kSide * (kSide + 1) + f % kSide;
        quads.row(f) << a, a + 1, a + kSide + 2, a + kSide + 1;
    }
    return quads;
}

int at(int column, int row) { return (row + kSide / 2) * (kSide + 1) + column + kSide / 2; }

std::shared_ptr<const TemplateSkin> make_template() {
    TemplateMesh mesh;
    mesh.vertices = make_mask();
    mesh.faces = make_quads();
    mesh.num_skin_vertices = static_cast<int>(mesh.vertices.rows());
    mesh.num_skin_faces = static_cast<int>(mesh.faces.rows());
    mesh.part = Eigen::VectorXi::Zero(mesh.faces.rows());
    mesh.part_names = {"skin"};
    mesh.region = Eigen::VectorXi::Zero(mesh.num_skin_vertices);
    mesh.region_names = {"cheek"};
    mesh.landmark_vertices = Eigen::Vector3i(at(0, 0), at(5, 2), at(-5, 2));
    mesh.landmark_names = {"nose_tip", "ala.L", "ala.R"};
    mesh.eye_centers = mesh.jaw_hinge = Points::Zero(2, 3);
    return std::make_shared<TemplateSkin>(mesh);
}

SkinMesh make_mesh(double size = 1) { return {make_template(), make_mask(size)}; }

AttachedSkin attach_mask(const SkinMesh& mesh) {
    const auto all = [&](double value) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(mesh.vertices().rows(), value);
    };
    Flags free(mesh.neutral().rows());
    for (int v = 0; v < free.size(); ++v) {
        const int column = v % (kSide + 1);
        const int row = v / (kSide + 1);
        free[v] = std::min({column, row, kSide - column, kSide - row}) > 1;
    }
    return {mesh.vertices(),
            mesh.triangles(),
            {all(4e4), all(0.49), all(1.5e-3), all(2e4), all(1e5), all(1e6)},
            mesh.stencils(),
            free};
}

MuscleEntry make_entry() {
    MuscleEntry entry;
    entry.name = "puller";
    entry.insertion = {{"ala", 0, 0, 0}};
    entry.origin = {"ala", 10, 20, 3};
    entry.measured_at = {"ala", 1, 1, 0};
    entry.excursion = 5;
    return entry;
}

TEST(SkinMesh, QuadsAreCutAlongTheirShorterDiagonal) {
    Points vertices(4, 3);
    vertices << 0, 0, 0, 2, 0.5, 0, 2, 2, 0, 0.5, 2, 0;
    Quads quad(1, 4);
    quad << 0, 1, 2, 3;
    Triangles expected(2, 3);
    expected << 0, 1, 3, 1, 2, 3;
    EXPECT_EQ(split_quads(vertices, quad), expected);
    vertices.row(0) << 1, 1, 0;
    expected << 0, 1, 2, 0, 2, 3;
    EXPECT_EQ(split_quads(vertices, quad), expected);
}

TEST(SkinMesh, LengthsAndPlacesGrowWithTheHead) {
    const SkinMesh usual = make_mesh();
    const SkinMesh large = make_mesh(1.25);
    EXPECT_TRUE((usual.local_scale().array() == 1).all());
    EXPECT_TRUE((large.local_scale().array() - 1.25).abs().maxCoeff() < 1e-12);
    EXPECT_NEAR(large.size(), 1.25, 1e-12);
    const Place place = find_place(usual, {"ala", 3, -4, 2}, 'L');
    const Eigen::RowVector3d ala = usual.landmark_place("ala.L");
    const Eigen::RowVector3d position = place.position(usual);
    EXPECT_NEAR((place.position(large) - 1.25 * position).norm(), 0, 1e-12);
    // 3 mm outwards and 4 mm down as seen from the front, then 2 mm along the normal
    const Eigen::RowVector3d on_skin = position + 2e-3 * usual.normals().row(place.vertex);
    EXPECT_NEAR(on_skin[0] - ala[0], 3e-3, 1e-12);
    EXPECT_NEAR(on_skin[1] - ala[1], -4e-3, 1e-12);
    const Place other = find_place(usual, {"ala", 3, -4, 2}, 'R');
    EXPECT_NEAR((other.position(usual).array() * Eigen::Array3d(-1, 1, 1).transpose() - position.array())
                    .matrix()
                    .norm(),
                0, 1e-12);
}

TEST(SkinMesh, WhatTheTemplateHasNotIsNamed) {
    const SkinMesh mesh = make_mesh();
    EXPECT_THROW(mesh.landmark("third_eye"), InvalidInput);
    EXPECT_THROW(mesh.shared().in_region("beak"), InvalidInput);
    EXPECT_THROW(SkinMesh(make_template(), make_mask().topRows(9)), InvalidInput);
    Points broken = make_mask();
    broken(7, 1) = std::nan("");
    EXPECT_THROW(SkinMesh(make_template(), broken), InvalidInput);
}

TEST(SkinMesh, FacesThatLieTurnedOverAreSmoothedAndNamed) {
    Points folded = make_mask();
    folded(at(0, 0), 0) += 3 * kStep;
    const SkinMesh mesh(make_template(), folded);
    EXPECT_FALSE(mesh.inverted_faces().empty());
    EXPECT_GT(mesh.smoothed_by(), 1e-3);
    EXPECT_TRUE(inverted_faces(mesh.vertices(), mesh.triangles()).empty());
    EXPECT_TRUE(make_mesh().inverted_faces().empty());
}

TEST(AttachedSkin, RespondsAsItsModelAndHoldsWhatIsHeld) {
    const SkinMesh mesh = make_mesh();
    const AttachedSkin skin = attach_mask(mesh);
    MatrixRows forces = MatrixRows::Random(2, 3 * mesh.vertices().rows());
    const MatrixRows response = skin.respond(forces);
    const Eigen::MatrixXd expected = skin.model().solve(forces.transpose());
    Eigen::Index unknown = 0;
    for (Eigen::Index v = 0; v < skin.free().size(); ++v) {
        const MatrixRows own = response.middleCols<3>(3 * v);
        if (skin.free()[v]) {
            EXPECT_EQ(own, expected.middleRows<3>(3 * unknown++).transpose());
        } else {
            EXPECT_TRUE((own.array() == 0).all());
        }
    }
}

TEST(AttachedSkin, MatricesKeepTheRowsAndColumnsAskedFor) {
    SparseRows matrix(2, 3);
    matrix.insert(0, 0) = 1;
    matrix.insert(0, 2) = 2;
    matrix.insert(1, 1) = 3;
    const Flags kept = (Flags(3) << false, true, true).finished();
    EXPECT_EQ(Eigen::MatrixXd(keep_columns(matrix, kept)), (Eigen::Matrix2d() << 0, 2, 3, 0).finished());
    EXPECT_EQ(Eigen::MatrixXd(keep_rows(matrix, {1})), Eigen::MatrixXd(Eigen::RowVector3d(0, 3, 0)));
    EXPECT_THROW(keep_rows(matrix, {2}), InvalidInput);
}

TEST(Pull, EachMuscleMovesItsPlaceByItsExcursion) {
    for (const double size : {1.0, 1.25}) {
        const SkinMesh mesh = make_mesh(size);
        const AttachedSkin skin = attach_mask(mesh);
        const auto placed = place_muscles(make_mesh(), mesh, {make_entry()}, Points2::Zero(2, 2));
        const SparseRows measured = measured_rows(mesh, placed);
        const Pulled pulled = pull(skin, mesh.surface(), placed, measured);
        for (int i = 0; i < 2; ++i) {
            const Eigen::RowVector3d moved =
                pulled.strengths[i] * motion_at(measured, i, pulled.responses.row(i));
            EXPECT_NEAR(moved.norm(), size * 5e-3, 1e-12);
            EXPECT_GT(moved[1], 0);
            EXPECT_GT(i == 0 ? moved[0] : -moved[0], 0);
        }
    }
}

TEST(Pull, APlaceThatDoesNotMoveIsNamed) {
    const SkinMesh mesh = make_mesh();
    const AttachedSkin skin = attach_mask(mesh);
    const auto placed = place_muscles(mesh, mesh, {make_entry()}, Points2::Zero(2, 2));
    try {
        pull(skin, mesh.surface(), placed, SparseRows(2, skin.free().size()));
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("puller is measured, by ala, does not move"),
                  std::string::npos);
    }
    EXPECT_THROW(place_muscles(mesh, mesh, {make_entry()}, Points2::Zero(3, 2)), InvalidInput);
}

TEST(SkinModes, MoveTheSkinByTheUnitAndFallInCompliance) {
    const SkinMesh mesh = make_mesh();
    const AttachedSkin skin = attach_mask(mesh);
    const Points weight =
        Points::Constant(mesh.vertices().rows(), 3, 1.0 / static_cast<double>(mesh.vertices().rows()));
    std::srand(1);
    const Eigen::MatrixXd start = Eigen::MatrixXd::Random(3 * skin.model().num_unknowns(), 16);
    const SkinModes skin_modes = low_energy_modes(skin, weight, start, 6, 1e-3);
    Eigen::MatrixXd moved(mesh.vertices().size(), 6);
    for (int i = 0; i < 6; ++i) {
        const Eigen::Map<const Points> mode(skin_modes.modes.row(i).data(), skin.free().size(), 3);
        const Points refined = mesh.stencils() * mode;
        moved.col(i) = Eigen::Map<const Eigen::VectorXd>(refined.data(), refined.size());
        EXPECT_LE(skin_modes.compliance[i], i == 0 ? skin_modes.compliance[0] : skin_modes.compliance[i - 1]);
    }
    const Eigen::MatrixXd gram = moved.transpose() * moved / static_cast<double>(mesh.vertices().rows());
    EXPECT_LT((gram - 1e-6 * Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_THROW(low_energy_modes(skin, weight, start, 17, 1e-3), InvalidInput);
}

TEST(Articulators, RotationIsTakenInFull) {
    Points points(1, 3);
    points << 2, 0, 5;
    const Points turned = rotate(points, Eigen::RowVector3d(1, 0, 0), Eigen::RowVector3d(0, 0, 1),
                                 Eigen::VectorXd::Constant(1, std::acos(0.0)));
    EXPECT_LT((turned - Points(Eigen::RowVector3d(1, 1, 5))).norm(), 1e-12);
    EXPECT_EQ(smooth_step(-1), 0);
    EXPECT_EQ(smooth_step(0.5), 0.5);
    EXPECT_EQ(smooth_step(2), 1);
    EXPECT_THROW(jaw_motion("jaw_shut"), InvalidInput);
}

}  // namespace
}  // namespace mimetic
