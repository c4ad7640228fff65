// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/retarget/control_fit.hpp>
#include <mimetic/shared/error.hpp>
#include <random>
#include <utility>

namespace mimetic {
namespace {

constexpr int kVertices = 60;

MatrixRows drawn(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    return MatrixRows::NullaryExpr(rows, cols, [&] { return normal(random); });
}

MatrixRows ranges(Eigen::Index count, double lowest = 0, double highest = 1) {
    MatrixRows rows(count, 2);
    rows.col(0).setConstant(lowest);
    rows.col(1).setConstant(highest);
    return rows;
}

ControlFitOptions exact() {
    ControlFitOptions options;
    options.sparsity = options.ridge = 0;
    options.unmatched_motion = 1;
    return options;
}

const Eigen::VectorXd kEven = Eigen::VectorXd::Ones(kVertices);

TEST(ControlFit, KeysThatAreTheSourcesInAnotherOrderPlayTheirValues) {
    const MatrixRows sources = drawn(4, 3 * kVertices, 1);
    MatrixRows controls(4, 3 * kVertices);
    for (int k = 0; k < 4; ++k) {
        controls.row(k) = .5 * sources.row(3 - k);
    }
    const ControlFit fit(controls, sources, kEven, ranges(4), ranges(4), exact());
    const MatrixRows values = drawn(9, 4, 2).cwiseAbs().cwiseMin(.5);
    const MatrixRows fitted = fit.frames(values, MatrixRows::Zero(9, 4));
    EXPECT_TRUE(fitted.isApprox(2 * values.rowwise().reverse(), 1e-9));
    EXPECT_NEAR(fit.explained(values, fitted), 1, 1e-9);
    for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(fit.readings()(k, 3 - k), .5, .01);
        EXPECT_NEAR(fit.readable()[k], 1, 1e-4);
    }
}

TEST(ControlFit, OverlapsAreTakenTogether) {
    // A smile and a smile with the mouth open, as many rigs have them: neither is a source alone
    const MatrixRows sources = drawn(2, 3 * kVertices, 3);
    MatrixRows controls(2, 3 * kVertices);
    controls.row(0) = sources.row(0);
    controls.row(1) = .5 * sources.row(0) + sources.row(1);
    const ControlFit fit(controls, sources, kEven, ranges(2), ranges(2), exact());
    const MatrixRows fitted = fit.frames(MatrixRows{{.8, .6}, {.2, .6}}, MatrixRows::Zero(2, 2));
    EXPECT_NEAR(fitted(0, 0), .5, 1e-9);
    EXPECT_NEAR(fitted(0, 1), .6, 1e-9);
    EXPECT_EQ(fitted(1, 0), 0);  // less smile than the open mouth brings along; none is below 0
}

TEST(ControlFit, ValuesStayInTheSlidersRange) {
    const MatrixRows sources = MatrixRows::Identity(3, 3 * kVertices);
    const MatrixRows controls = -.25 * sources;
    const ControlFit fit(controls, sources, kEven, ranges(3, -2, 1), ranges(3), exact());
    const MatrixRows fitted = fit.frames(MatrixRows{{1, .25, 0}}, MatrixRows::Zero(1, 3));
    EXPECT_NEAR(fitted(0, 0), -2, 1e-12);
    EXPECT_NEAR(fitted(0, 1), -1, 1e-9);
    EXPECT_NEAR(fitted(0, 2), 0, 1e-9);
}

TEST(ControlFit, APlayedUnitIsPlayedInFullThoughItMovesMoreThanSourcesCan) {
    // Half of the control's motion is of a kind that no source makes
    const MatrixRows all = drawn(2, 3 * kVertices, 5);
    const MatrixRows sources = all.topRows(1);
    const MatrixRows controls = all.row(0) + all.row(1);
    const MatrixRows seen{{1.}};
    ControlFitOptions options = exact();
    const ControlFit nearest(controls, sources, kEven, ranges(1, 0, 2), ranges(1), options);
    options.unmatched_motion = 1e-12;
    const ControlFit whole(controls, sources, kEven, ranges(1, 0, 2), ranges(1), options);
    const MatrixRows none = MatrixRows::Zero(1, 1);
    EXPECT_LT(nearest.frames(seen, none)(0, 0), .7);
    const double along = all.row(0).dot(controls.row(0)) / all.row(0).squaredNorm();
    EXPECT_NEAR(whole.frames(seen, none)(0, 0), 1 / along, .01);
    EXPECT_LT(whole.readable()[0], .7);
}

TEST(ControlFit, AKeyThatGoesFurtherThanSourcesIsFullWhereTheyAre) {
    // A blink whose lid goes down 1.8 times as far as our own
    const MatrixRows sources = MatrixRows::Identity(2, 3 * kVertices);
    const MatrixRows controls = 1.8 * sources.topRows(1);
    ControlFitOptions options;
    options.sparsity = options.ridge = options.unmatched_motion = 1e-12;
    const ControlFit fit(controls, sources, kEven, ranges(1), ranges(2), options);
    const MatrixRows fitted = fit.frames(MatrixRows{{1, 0}, {.5, 0}}, MatrixRows::Zero(2, 1));
    EXPECT_NEAR(fitted(0, 0), 1, 1e-5);
    EXPECT_NEAR(fitted(1, 0), .5, 1e-5);
}

TEST(ControlFit, WhatIsMostlyAnotherMotionDoesNotTakePartOfIt) {
    // A lid that closes; a key for it, and one that turns the eyeball and takes the lid a little along
    MatrixRows sources = MatrixRows::Zero(1, 9), controls = MatrixRows::Zero(2, 9);
    sources(0, 0) = 1;
    controls(0, 0) = 1;
    controls(0, 1) = .8;
    controls(1, 0) = .4;
    controls(1, 4) = 1.2;
    const ControlFit fit(controls, sources, Eigen::Vector3d::Ones(), ranges(2), ranges(1));
    const MatrixRows fitted = fit.frames(MatrixRows{{1}}, MatrixRows::Zero(1, 2));
    EXPECT_GT(fitted(0, 0), .9);
    EXPECT_LT(fitted(0, 1), .1);
}

TEST(ControlFit, WeightsDecideWhichSurfaceCounts) {
    MatrixRows sources = MatrixRows::Zero(1, 6), controls = MatrixRows::Zero(1, 6);
    sources << 1, 0, 0, 1, 0, 0;
    controls << 1, 0, 0, 2, 0, 0;
    const MatrixRows seen{{1.}}, none = MatrixRows::Zero(1, 1);
    const auto fitted = [&](double first, double second) {
        return ControlFit(controls, sources, Eigen::Vector2d(first, second), ranges(1), ranges(1), exact())
            .frames(seen, none)(0, 0);
    };
    EXPECT_NEAR(fitted(1, 0), 1, 1e-9);
    EXPECT_NEAR(fitted(0, 1), .5, 1e-9);
    EXPECT_NEAR(fitted(3, 1), (3. + 2.) / (3. + 4.), 1e-9);
}

TEST(ControlFit, TheMappingHasEachSourceBothWays) {
    const MatrixRows sources = drawn(2, 3 * kVertices, 6);
    MatrixRows controls(2, 3 * kVertices);
    controls.row(0) = sources.row(0);   // closes
    controls.row(1) = -sources.row(0);  // opens wide
    MatrixRows source_range = ranges(2);
    source_range(0, 0) = -.5;
    const ControlFit fit(controls, sources, kEven, ranges(2), source_range, exact());
    const MatrixRows mapping = fit.mapping();
    ASSERT_EQ(mapping.rows(), 4);
    EXPECT_NEAR(mapping(0, 0), 1, 1e-9);
    EXPECT_NEAR(mapping(1, 1), 1, 1e-9);
    EXPECT_EQ(mapping.row(3).norm(), 0);  // the second goes one way alone
    const Eigen::VectorXd explained = fit.source_explained();
    EXPECT_NEAR(explained[0], 1, 1e-9);
    EXPECT_LT(explained[1], .2);
}

TEST(ControlFit, TwinsShareByWhatIsExpected) {
    const MatrixRows sources = drawn(1, 3 * kVertices, 7);
    const MatrixRows controls = sources.replicate(2, 1);
    ControlFitOptions options = exact();
    options.ridge = .01;
    const ControlFit fit(controls, sources, kEven, ranges(2), ranges(1), options);
    const MatrixRows fitted = fit.frames(MatrixRows{{.8}}, MatrixRows{{.8, 0}});
    EXPECT_NEAR(fitted(0, 0), .8, .01);
    EXPECT_NEAR(fitted(0, 1), 0, .01);
}

TEST(ControlFit, ASourceThatNoControlMakesHoldsNoneBack) {
    // A grin on a head whose jaw nothing opens; a jaw that opens takes the corners of the mouth down
    MatrixRows sources = drawn(2, 3 * kVertices, 9);
    const MatrixRows controls = sources.row(0);
    sources.row(1) = 3 * sources.row(1) - sources.row(0);
    ControlFitOptions options = exact();
    options.least_explained = 0;
    const MatrixRows values{{.6, .6}}, none = MatrixRows::Zero(1, 1);
    const auto grin = [&] {
        return ControlFit(controls, sources, kEven, ranges(1), ranges(2), options).frames(values, none)(0, 0);
    };
    EXPECT_LT(grin(), .2);
    options.least_explained = .1;
    EXPECT_NEAR(grin(), .6, 1e-9);
}

TEST(ControlFit, ValuesTellMusclesApartThatMoveTheSkinAlike) {
    // Two muscles that do nearly the same, and a key for each that goes a little with the other's
    const MatrixRows all = drawn(3, 3 * kVertices, 11);
    MatrixRows sources(2, 3 * kVertices);
    sources.row(0) = all.row(0) + .1 * all.row(1);
    sources.row(1) = all.row(0) - .1 * all.row(1);
    const MatrixRows controls = sources + .02 * drawn(2, 3 * kVertices, 12);
    ControlFitOptions options;
    const auto second = [&] {
        const ControlFit fit(controls, sources, kEven, ranges(2), ranges(2), options);
        return fit.frames(MatrixRows{{.6, 0}}, MatrixRows::Zero(1, 2));
    };
    options.value_match = 0;
    const MatrixRows by_skin = second();
    options.value_match = .1;
    const MatrixRows by_values = second();
    EXPECT_LT(std::abs(by_values(0, 0) - .6), std::abs(by_skin(0, 0) - .6));
    EXPECT_NEAR(by_values(0, 0), .6, .03);
    EXPECT_NEAR(by_values(0, 1), 0, .01);
}

TEST(ControlFit, AKeyThatPartsTheLipsIsReadAsWhatPartsThem) {
    // A pucker moves much skin; a funnel moves the same and parts two vertices that weigh next to nothing
    MatrixRows sources = MatrixRows::Zero(2, 9), controls = MatrixRows::Zero(1, 9);
    sources(0, 0) = 1;    // the lips' ring
    sources(1, 4) = 1;    // lowers the lower lip's rim
    sources(1, 0) = -.2;  // and takes skin back
    controls(0, 0) = 1;
    controls(0, 4) = 1;
    const Eigen::Vector3d weights(1, .01, .01);
    TiedVertices tied;
    tied.pairs = VertexPairs{{1, 2}};
    tied.ways = Points{{0, 1, 0}};
    tied.weights = Eigen::VectorXd::Constant(1, 10);
    tied.open = tied.pressed = Eigen::VectorXd::Zero(1);
    tied.rims = Eigen::VectorXi::Zero(1);
    ControlFitOptions options;
    const auto opened = [&](double tied_reading) {
        options.tied_reading = tied_reading;
        return ControlFit(controls, sources, weights, ranges(1), ranges(2), options, tied).readings()(0, 1);
    };
    EXPECT_LT(opened(0), .6);
    EXPECT_GT(opened(.1), .9);
}

TEST(ControlFit, LipsThatMusclesHoldShutStayShut) {
    // A ring that moves much skin and presses the lips, and what parts them; keys: a funnel that does nearly
    // what the ring does but parts the lips, and one that does little but shut them
    MatrixRows sources = MatrixRows::Zero(2, 9), controls = MatrixRows::Zero(2, 9);
    sources(0, 0) = 1;
    sources(0, 4) = -.1;
    sources(1, 4) = 1;
    controls(0, 0) = 1;
    controls(0, 4) = .8;
    controls(1, 1) = .1;
    controls(1, 4) = -1;
    const Eigen::Vector3d weights(1, .001, .001);
    TiedVertices tied;
    tied.pairs = VertexPairs{{1, 2}};
    tied.ways = Points{{0, 1, 0}};
    tied.weights = Eigen::VectorXd::Constant(1, .001);
    tied.open = Eigen::VectorXd::Zero(1);
    tied.pressed = Eigen::VectorXd::Constant(1, .05);
    tied.rims = Eigen::VectorXi::Zero(1);
    ControlFitOptions options = exact();
    const auto apart = [&](double ring, double parting, double hold_shut, double slack) {
        options.hold_shut = hold_shut;
        options.hold_slack = slack;
        const ControlFit fit(controls, sources, weights, ranges(2), ranges(2), options, tied);
        const MatrixRows values = fit.frames(MatrixRows{{ring, parting}}, MatrixRows::Zero(1, 2));
        EXPECT_NEAR(values(0, 0), ring, .05);
        return .8 * values(0, 0) - values(0, 1);
    };
    EXPECT_GT(apart(1, 0, 0, 20), .3);
    EXPECT_NEAR(apart(1, 0, 1000, 20), -.05, .02);  // pressed no further than rims are
    // Parted a little by muscles: with slack, lips may go as far as the keys take them
    EXPECT_NEAR(apart(1, .15, 1000, 20), apart(1, .15, 0, 20), 1e-9);
    EXPECT_NEAR(apart(1, .15, 1000, 0), .05, .02);
}

TEST(ControlFit, NoControlsAndNoSourcesPlayNothing) {
    for (const auto& [num_controls, num_sources] : {std::pair(0, 2), std::pair(2, 0), std::pair(0, 0)}) {
        const ControlFit fit(drawn(num_controls, 3 * kVertices, 1), drawn(num_sources, 3 * kVertices, 2),
                             kEven, ranges(num_controls), ranges(num_sources));
        const MatrixRows fitted =
            fit.frames(MatrixRows::Ones(3, num_sources), MatrixRows::Zero(3, num_controls));
        EXPECT_EQ(fitted.rows(), 3);
        EXPECT_EQ(fitted.cols(), num_controls);
        EXPECT_TRUE((fitted.array() == 0).all());
        EXPECT_EQ(fit.mapping().rows(), 2 * num_sources);
    }
}

TEST(ControlFit, WrongInputIsRefused) {
    const MatrixRows sources = drawn(2, 3 * kVertices, 8);
    EXPECT_THROW(ControlFit(sources.leftCols(9), sources, kEven, ranges(2), ranges(2)), InvalidInput);
    EXPECT_THROW(ControlFit(sources, sources, -kEven, ranges(2), ranges(2)), InvalidInput);
    EXPECT_THROW(ControlFit(sources, sources, kEven, ranges(2, .1), ranges(2)), InvalidInput);
    EXPECT_THROW(ControlFit(sources, sources, kEven, ranges(3), ranges(2)), InvalidInput);
    ControlFitOptions options;
    options.unmatched_motion = 2;
    EXPECT_THROW(ControlFit(sources, sources, kEven, ranges(2), ranges(2), options), InvalidInput);
    const ControlFit fit(sources, sources, kEven, ranges(2), ranges(2));
    EXPECT_THROW(fit.frames(MatrixRows::Zero(3, 5), MatrixRows::Zero(3, 2)), InvalidInput);
    EXPECT_THROW(fit.frames(MatrixRows::Zero(3, 2), MatrixRows::Zero(2, 2)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
