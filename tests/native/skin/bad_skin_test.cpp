// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_check.hpp>

#include "shapes.hpp"

namespace mimetic {
namespace {

std::string message_of(const Shell& shell, const SkinMaterials& materials) {
    try {
        const SkinModel skin(shell.vertices, shell.triangles, materials, make_basis(shell.vertices.rows()));
        skin.solve(Eigen::MatrixXd::Zero(3 * shell.vertices.rows(), 1));
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

class BadSkin : public testing::Test {
protected:
    void expect_message(const std::string& part) {
        const std::string message = message_of(shell, make_materials(shell.vertices.rows()));
        EXPECT_NE(message.find(part), std::string::npos) << message;
    }
    void append(int a, int b, int c) {
        shell.triangles.conservativeResize(shell.triangles.rows() + 1, 3);
        shell.triangles.bottomRows<1>() << a, b, c;
    }

    Shell shell = make_rectangle(1, 1, 2, 2);
};

TEST_F(BadSkin, NoFaces) {
    shell.triangles.resize(0, 3);
    expect_message("no faces");
}

TEST_F(BadSkin, FaceWithoutArea) {
    shell.vertices.row(4) = (shell.vertices.row(0) + shell.vertices.row(1)) / 2;
    expect_message("face 0 has no area");
}

TEST_F(BadSkin, VertexOutOfRange) {
    shell.triangles(3, 1) = 9;
    expect_message("face 3 names vertex 9");
}

TEST_F(BadSkin, NotFinite) {
    shell.vertices(5, 2) = std::numeric_limits<double>::quiet_NaN();
    expect_message("vertex 5 is not finite");
}

TEST_F(BadSkin, LoosePart) {
    shell.vertices.conservativeResize(12, 3);
    shell.vertices.bottomRows<3>() << 5, 5, 0, 6, 5, 0, 5, 6, 0;
    append(9, 10, 11);
    expect_message("face 8 is a loose part");
}

TEST_F(BadSkin, EdgeOfThreeFaces) {
    shell.vertices.conservativeResize(10, 3);
    shell.vertices.row(9) << 0.5, 0.5, 1;
    append(0, 4, 9);
    expect_message("more than two faces");
}

TEST_F(BadSkin, FlippedFace) {
    std::swap(shell.triangles(0, 1), shell.triangles(0, 2));
    expect_message("flip one");
}

TEST_F(BadSkin, PartsThatTouchInAPoint) {
    shell = make_rectangle(1, 1, 3, 3);  // without the quads on both sides of vertex 5
    Triangles kept(14, 3);
    kept << shell.triangles.middleRows<6>(2), shell.triangles.bottomRows<8>();
    shell.triangles = kept;
    expect_message("at vertex 5 only");
}

TEST_F(BadSkin, FaceTurnedOver) {
    shell = make_rectangle(1, 1, 4, 4);
    shell.vertices.row(12) << 0.85, 0.45, 0;  // past its neighbour
    expect_message("is turned over");
}

TEST_F(BadSkin, CreaseIsNotTurnedOver) {
    Shell sheet = make_rectangle(1, 1, 4, 4);
    for (int v = 0; v < sheet.vertices.rows(); ++v) {  // folded in half, but for a hair
        const double x = sheet.vertices(v, 0);
        sheet.vertices.row(v) << std::min(x, 1 - x), sheet.vertices(v, 1), x > 0.5 ? 0.01 * (x - 0.5) : 0;
    }
    EXPECT_TRUE(inverted_faces(sheet.vertices, sheet.triangles).empty());
}

TEST_F(BadSkin, HoleWhereNoneBelongs) {
    shell = make_rectangle(1, 1, 4, 4);
    EXPECT_NO_THROW(check_openings(shell.triangles, 1));
    EXPECT_THROW(check_openings(shell.triangles, 0), InvalidInput);
    Triangles torn(31, 3);
    torn << shell.triangles.topRows(10), shell.triangles.bottomRows(21);
    try {
        check_openings(torn, 1, 2);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("has 3 edges and lies at face"), std::string::npos)
            << error.what();
    }
    const Shell pebble = make_pebble(1);
    EXPECT_NO_THROW(check_openings(pebble.triangles, 0));
}

TEST_F(BadSkin, LooseVertex) {
    shell.vertices.conservativeResize(10, 3);
    shell.vertices.row(9) << 5, 5, 5;
    expect_message("vertex 9 belongs to no face");
}

TEST_F(BadSkin, NothingHoldsIt) { expect_message("move freely"); }

TEST_F(BadSkin, MaterialOutOfRange) {
    SkinMaterials materials = make_materials(9);
    materials.thickness[4] = -1;
    EXPECT_NE(message_of(shell, materials).find("thickness at vertex 4"), std::string::npos);
    materials = make_materials(8);
    EXPECT_NE(message_of(shell, materials).find("young has 8 values"), std::string::npos);
}

}  // namespace
}  // namespace mimetic
