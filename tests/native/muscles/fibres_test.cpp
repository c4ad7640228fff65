// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/muscles/fibres.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

Muscle sheet() {
    Muscle muscle;
    muscle.type = MuscleType::sheet;
    muscle.insertion.resize(3, 3);
    muscle.insertion << 0, 0, 0, .012, 0, 0, .012, .012, 0;  // 24 mm along, round a corner
    muscle.origin << .006, .05, .01;
    return muscle;
}

TEST(Fibres, ASheetsEndsLieEvenlyAlongItsEdge) {
    const Points nodes = insertion_nodes(sheet());
    ASSERT_EQ(nodes.rows(), 6);
    Points expected(6, 3);
    expected << 0, 0, 0, .0048, 0, 0, .0096, 0, 0, .012, .0024, 0, .012, .0072, 0, .012, .012, 0;
    EXPECT_TRUE(nodes.isApprox(expected, 1e-9));
}

TEST(Fibres, OfASheetAreParallelAndStartOnTheBone) {
    const std::vector<Points> fibres = muscle_fibres(sheet(), 5);
    ASSERT_EQ(fibres.size(), 6u);
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const Points& fibre : fibres) {
        const Eigen::RowVector3d along = fibre.row(4) - fibre.row(0);
        EXPECT_TRUE(along.isApprox(fibres[0].row(4) - fibres[0].row(0), 1e-9));
        middle += fibre.row(0) / 6;
    }
    EXPECT_TRUE(middle.isApprox(sheet().origin.transpose(), 1e-9));
    EXPECT_THROW(muscle_fibres(sheet(), 1), InvalidInput);
}

TEST(Fibres, OfARingAreHalfEllipsesOnItsOwnSide) {
    Muscle ring;
    ring.type = MuscleType::sphincter;
    ring.insertion.resize(2, 3);
    ring.insertion << .02, 0, 0, -.02, 0, 0;
    ring.width = .01;
    for (const Points& fibre : muscle_fibres(ring, 9)) {
        EXPECT_GE(fibre.col(0).minCoeff(), -1e-12);
        const Eigen::VectorXd lengths = (fibre.rowwise() - ring.insertion.row(0)).rowwise().norm() +
                                        (fibre.rowwise() - ring.insertion.row(1)).rowwise().norm();
        EXPECT_LT(lengths.maxCoeff() - lengths.minCoeff(), 1e-12);
    }
}

TEST(MuscleLines, GoWithBoneAtTheirStartAndWithSkinAtTheirEnd) {
    Points skin(3, 3);
    skin << 0, 0, 0, .1, 0, 0, 0, .1, 0;
    Triangles corners(2, 3);
    corners << 0, 1, 2, 0, 1, 2;
    Points weights(2, 3);
    weights << 1, 0, 0, 0, 1, 0;
    MuscleLines lines{
        {corners, weights, Eigen::VectorXd::Zero(2)}, {}, MatrixRows(1, 6), Eigen::Vector2d(0, 1)};
    lines.rest = lines.places.positions(skin, .001);
    lines.bone << 0, -.02, 0, 0, -.02, 0;
    const Points moved = skin.rowwise() + Eigen::RowVector3d(0, 0, .005);
    const Points at = lines.positions(moved, Eigen::VectorXd::Constant(1, .5), .001);
    EXPECT_TRUE(at.row(0).isApprox(Eigen::RowVector3d(0, -.01, .001), 1e-9));
    EXPECT_TRUE(at.row(1).isApprox(Eigen::RowVector3d(.1, 0, .006), 1e-9));
    EXPECT_THROW(lines.positions(moved, Eigen::VectorXd::Zero(2), .001), InvalidInput);
}

}  // namespace
}  // namespace mimetic
