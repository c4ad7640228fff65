// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/retarget/control_fit.hpp>
#include <mimetic/retarget/touching_rims.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kAlong = 5;

/// Strips of skin above and below a slit of 1 cm, quads a centimetre wide, joined by a column at its left
/// end; a third strip, of another piece, lies where the upper one's rim comes to.
struct Slit {
    Points points{4 * kAlong + 2, 3};
    Points offsets;
    std::vector<int> starts, corners;

    Slit() {
        for (int row = 0; row < 4; ++row) {
            const double height = row < 2 ? .01 * (row + 1) : -.01 * (row - 2);
            for (int i = 0; i < kAlong; ++i) {
                points.row(row * kAlong + i) << .01 * i, height, 0;
            }
        }
        points.row(4 * kAlong) << -.01, .01, 0;
        points.row(4 * kAlong + 1) << -.01, 0, 0;
        for (int i = 0; i + 1 < kAlong; ++i) {
            add(i, i + 1, kAlong + i + 1, kAlong + i);
            add(3 * kAlong + i, 3 * kAlong + i + 1, 2 * kAlong + i + 1, 2 * kAlong + i);
        }
        add(4 * kAlong + 1, 2 * kAlong, 0, 4 * kAlong);
        offsets = Points::Zero(points.rows(), 3);
        offsets.topRows(2 * kAlong).col(1).setConstant(-.01);  // the upper strip shuts the slit
        offsets.row(0) *= .2;                                  // but for the corner
        offsets.row(kAlong) *= .2;
    }

    void add(int a, int b, int c, int d) {
        starts.push_back(static_cast<int>(corners.size()));
        corners.insert(corners.end(), {a, b, c, d});
    }

    Eigen::VectorXd areas() const { return Eigen::VectorXd::Constant(points.rows(), 1e-4); }
};

TEST(TouchingRims, AreWhereASourceShutsThem) {
    const Slit slit;
    const TiedVertices tied =
        touching_rims(slit.points, slit.starts, slit.corners, slit.areas(), slit.offsets, RimMotion::shuts);
    ASSERT_EQ(tied.pairs.rows(), kAlong - 1);
    for (int i = 1; i < kAlong; ++i) {
        EXPECT_EQ(tied.pairs(i - 1, 0), i);
        EXPECT_EQ(tied.pairs(i - 1, 1), 2 * kAlong + i);
        EXPECT_TRUE(tied.ways.row(i - 1).isApprox(Eigen::RowVector3d(0, 1, 0)));
        EXPECT_NEAR(tied.open[i - 1], .01, 1e-12);
    }
    EXPECT_NEAR(tied.weights.sum(), 10 * (2 * kAlong - 2) * 1e-4, 1e-12);
}

TEST(TouchingRims, AreWhereASourcePartsThem) {
    Slit slit;
    slit.points.topRows(2 * kAlong).col(1).array() -= .01;  // shut at rest
    const TiedVertices tied =
        touching_rims(slit.points, slit.starts, slit.corners, slit.areas(), -slit.offsets, RimMotion::parts);
    EXPECT_EQ(tied.pairs.rows(), kAlong - 1);
    EXPECT_EQ(tied.open.cwiseAbs().maxCoeff(), 0);
    const TiedVertices twice = joined({tied, {}, tied});
    EXPECT_EQ(twice.rims[0], 0);
    EXPECT_EQ(twice.rims[twice.rims.size() - 1], 1);
}

TEST(TouchingRims, ASourceThatMovesNothingHasNone) {
    const Slit slit;
    const Points none = Points::Zero(slit.points.rows(), 3);
    EXPECT_EQ(touching_rims(slit.points, slit.starts, slit.corners, slit.areas(), none, RimMotion::shuts)
                  .pairs.rows(),
              0);
    EXPECT_THROW(touching_rims(slit.points, slit.starts, slit.corners, slit.areas(), none.topRows(3),
                               RimMotion::shuts),
                 InvalidInput);
    EXPECT_THROW(touching_rims(slit.points, {0}, {0, 1, 999}, slit.areas(), slit.offsets, RimMotion::shuts),
                 InvalidInput);
}

TEST(TouchingRims, TiedRimsMeetThoughMostOfTheSkinWouldRatherNot) {
    // One bone takes the upper rim half as far as the skin above it, as automatic weights do
    const Slit slit;
    const TiedVertices tied =
        touching_rims(slit.points, slit.starts, slit.corners, slit.areas(), slit.offsets, RimMotion::shuts);
    Points bone = slit.offsets;
    bone.topRows(kAlong) *= .5;
    const MatrixRows controls = Eigen::Map<const MatrixRows>(bone.data(), 1, bone.size());
    const MatrixRows sources = Eigen::Map<const MatrixRows>(slit.offsets.data(), 1, slit.offsets.size());
    const MatrixRows control_range{{-3, 3}}, source_range{{0, 1}};
    ControlFitOptions options;
    options.unmatched_motion = 1;
    options.hold_shut = 0;
    const auto gap = [&](const TiedVertices& how) {
        const ControlFit fit(controls, sources, slit.areas(), control_range, source_range, options, how);
        const double value = fit.frames(MatrixRows{{1}}, MatrixRows::Zero(1, 1))(0, 0);
        return .01 * (1 - .5 * value);
    };
    EXPECT_GT(gap({}), .004);
    EXPECT_LT(gap(tied), .7 * gap({}));
    EXPECT_EQ(joined({tied, {}, tied}).pairs.rows(), 2 * (kAlong - 1));
    const double tied_alone = gap(tied);
    options.hold_shut = 10;
    EXPECT_LT(gap(tied), .3 * tied_alone);
    TiedVertices wrong = tied;
    wrong.pairs(0, 1) = 999;
    EXPECT_THROW(gap(wrong), InvalidInput);
    wrong = tied;
    wrong.ways.row(0) *= 2;
    EXPECT_THROW(gap(wrong), InvalidInput);
    wrong = tied;
    wrong.rims.resize(0);
    EXPECT_THROW(gap(wrong), InvalidInput);
}

}  // namespace
}  // namespace mimetic
