// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/locate/rest.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

FaceFeatures some_face() {
    FaceFeatures face;
    face.likelihood = 1;
    face.box << 40, 30, 120, 120;
    for (const auto& [name, x, y] :
         {std::tuple{"pupil.R", 70., 70.}, std::tuple{"pupil.L", 130., 70.}, std::tuple{"ala.R", 90., 105.},
          std::tuple{"ala.L", 110., 105.}, std::tuple{"mouth_corner.R", 80., 135.},
          std::tuple{"mouth_corner.L", 120., 135.}, std::tuple{"lip_upper", 100., 130.},
          std::tuple{"lip_lower", 100., 142.}}) {
        face.features.push_back({name, {x, y}});
    }
    face.curves.push_back({"brow.L", (Points2(2, 2) << 120, 50, 140, 52).finished(), {}, {}});
    return face;
}

/// Grey everywhere but for dark pupils.
std::vector<std::uint8_t> drawn(bool has_open_mouth) {
    std::vector<std::uint8_t> image(3 * 200 * 200, 150);
    const auto darken = [&](int left, int top, int right, int bottom) {
        for (int y = top; y < bottom; ++y) {
            for (int i = 3 * (200 * y + left); i < 3 * (200 * y + right); ++i) {
                image[static_cast<std::size_t>(i)] = 20;
            }
        }
    };
    darken(62, 62, 78, 78);
    darken(122, 62, 138, 78);
    if (has_open_mouth) {
        darken(85, 128, 115, 150);
    }
    return image;
}

const MatrixRows kNoLids(0, 2);

TEST(Rest, AnOpenMouthIsNone) {
    const FaceFeatures face = some_face();
    const auto closed = drawn(false), open = drawn(true);
    const RestSigns at_rest = rest_signs({closed.data(), 200, 200, 600}, face);
    const Eigen::VectorXd scores =
        rest_scores({at_rest, at_rest, rest_signs({open.data(), 200, 200, 600}, face)});
    EXPECT_GT(scores[0], .9);
    EXPECT_LT(scores[2], .2 * scores[0]);
    FaceFeatures less = face;
    less.features.erase(less.features.begin() + 2);
    EXPECT_THROW(rest_signs({closed.data(), 200, 200, 600}, less), InvalidInput);
}

/// As a face at rest and one that laughs are seen, with all contrasts multiplied as sharpening does.
std::vector<RestSigns> sharpened(double by) {
    const auto seen = [by](double mouth, double edges, double cheek) {
        return RestSigns{.9, by * mouth, by * edges, by * cheek, .3};
    };
    const RestSigns at_rest = seen(.13, .09, .09), laughing = seen(.2, .13, .15);
    return {laughing, at_rest, at_rest, laughing, at_rest, laughing};
}

TEST(Rest, IsToldInSharpenedFootage) {
    EXPECT_EQ(rest_scores({}).size(), 0);
    for (const double by : {.8, 1., 1.25, 2.5}) {
        const Eigen::VectorXd scores = rest_scores(sharpened(by));
        EXPECT_GT(scores[1], .2) << by;
        EXPECT_LT(scores[0], .5 * scores[1]) << by;
    }
}

TEST(Rest, ASmileThatLastsAndOneContrastAloneAreNotSharpening) {
    const RestSigns smiling = sharpened(1.2)[1], bearded{.9, .13, .09, .3, .3};
    for (const RestSigns& signs : {smiling, bearded}) {
        const double beside_smooth_frames = rest_scores({signs, {}, {}})[0];
        EXPECT_NEAR(rest_scores({signs, signs, signs})[0], beside_smooth_frames, 1e-12);
    }
}

/// Beside dark skin open eyes are as bright as half-shut ones are beside fair skin.
TEST(Rest, OpenEyesAreToldBesideDarkSkin) {
    const auto with_pupils = [](double brightness) { return RestSigns{.9, .13, .09, .09, brightness}; };
    const RestSigns open = with_pupils(.55), shut = with_pupils(.85), dark = with_pupils(.3);
    const Eigen::VectorXd scores = rest_scores({open, shut, open, shut, open, shut});
    EXPECT_GT(scores[0], .5);
    EXPECT_LT(scores[1], .01 * scores[0]);
    const Eigen::VectorXd beside_dark_pupils = rest_scores({open, dark, dark});
    EXPECT_LT(beside_dark_pupils[0], .1 * beside_dark_pupils[1]);
}

TEST(Rest, ExpressionIsMeasuredInPupilDistances) {
    const Expression values = expression_of(some_face());
    EXPECT_NEAR(values[0], -19. / 60, 1e-12);  // the left brow's median
    EXPECT_TRUE(std::isnan(values[1]));        // no right one
    EXPECT_NEAR(values[2], 65. / 60, 1e-12);
    EXPECT_NEAR(values[4], 12. / 60, 1e-12);
    EXPECT_NEAR(values[5], 40. / 60, 1e-12);
}

TEST(Rest, DetailIsWhatSmoothShadesLack) {
    const FaceFeatures face = some_face();
    std::vector<std::uint8_t> noisy, smooth;
    for (int i = 0; i < 200 * 200; ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            noisy.push_back(static_cast<std::uint8_t>(100 + 40 * (i % 200 % 2)));
            smooth.push_back(static_cast<std::uint8_t>(i % 200));
        }
    }
    EXPECT_NEAR(face_detail({noisy.data(), 200, 200, 600}, face), 80, 1e-9);
    EXPECT_NEAR(face_detail({smooth.data(), 200, 200, 600}, face), 0, 1e-9);
    FaceFeatures outside = face;
    outside.box << 500, 500, 20, 20;
    EXPECT_EQ(face_detail({noisy.data(), 200, 200, 600}, outside), 0);
}

TEST(Rest, FramesAlikeAreCountedWithTheFrameItself) {
    Expressions expressions = Expressions::Zero(4, 6);
    expressions.row(1).setConstant(.014);  // within what a still face seems to move
    expressions.row(2).setConstant(.016);
    expressions.row(3).setConstant(std::nan(""));
    EXPECT_EQ(num_alike(expressions, 0), 3);
    EXPECT_EQ(num_alike(expressions, 2), 3);
    EXPECT_THROW(num_alike(expressions, 4), InvalidInput);
}

TEST(Rest, OfFramesAlikeTheLikeliestComesFirstAndTheOthersLast) {
    Expressions expressions = Expressions::Zero(6, 6);
    expressions.row(1).setConstant(.2);
    expressions.row(3).setConstant(.2);
    expressions.row(4).setConstant(.201);
    expressions(5, 0) = std::nan("");  // otherwise as the first
    const Eigen::VectorXd chances = (Eigen::VectorXd(6) << .3, .5, .2, .9, .8, .1).finished();
    EXPECT_EQ(distinct_first(chances, expressions), (std::vector<int>{3, 0, 4, 1, 2, 5}));
    EXPECT_THROW(distinct_first(chances.head(5), expressions), InvalidInput);
}

TEST(Rest, CostsCountWhatIsAboveTheRelaxedFramesAndWhatDoesNotRecur) {
    MatrixRows values = MatrixRows::Zero(10, 2);
    values.col(0) << 0, 0, 0, 0, .9, .9, .9, .9, .45, 1.4;
    const Eigen::VectorXd all = Eigen::VectorXd::Ones(10);
    const MatrixRows open = MatrixRows::Zero(10, 2);
    const Eigen::VectorXd costs = costs_of_rest(values, open, all, all, kNoLids);
    EXPECT_NEAR(costs[4] - costs[0], 1.8, .05);  // .9 of a value at 2 each; both recur alike
    EXPECT_GT(costs[8] - costs[0], std::log(2.));
    EXPECT_THROW(costs_of_rest(values, open, all.head(9), all, kNoLids), InvalidInput);
}

TEST(Rest, ALidThatIsMoreShutThanUsualCostsALookAsideDoesNot) {
    const MatrixRows values = MatrixRows::Zero(10, 2);
    const Eigen::VectorXd all = Eigen::VectorXd::Ones(10);
    MatrixRows lids = MatrixRows::Constant(10, 2, -.4);  // as seen from a frame with half-shut eyes
    lids(3, 0) = .6;                                     // a wink
    lids.row(5).setConstant(-.2);
    lids.row(7).setConstant(-.9);  // wide open
    const Eigen::VectorXd costs = costs_of_rest(values, lids, all, all, kNoLids);
    EXPECT_GT(costs[3], costs[0] + 2);
    EXPECT_DOUBLE_EQ(costs[5], costs[0]);
    EXPECT_DOUBLE_EQ(costs[7], costs[0]);
    EXPECT_THROW(costs_of_rest(values, lids.topRows(9), all, all, kNoLids), InvalidInput);
    lids.setZero();  // shut in most frames, as of somebody who weeps
    lids.bottomRows(4).setConstant(-.9);
    const Eigen::VectorXd weeping = costs_of_rest(values, lids, all, all, kNoLids);
    EXPECT_GT(weeping[0], weeping[9] + 2);
}

TEST(Rest, EyesThatAreOpenBesideAHandTellThatOthersLookDown) {
    const MatrixRows values = MatrixRows::Zero(10, 2);
    const Eigen::VectorXd all = Eigen::VectorXd::Ones(10);
    MatrixRows lids = MatrixRows::Zero(10, 2);
    lids.row(9).setConstant(-.9);
    EXPECT_DOUBLE_EQ(costs_of_rest(values, lids, all, all, kNoLids)[0],
                     costs_of_rest(values, lids, all, all, kNoLids)[9]);
    const MatrixRows beside_a_hand = MatrixRows::Constant(6, 2, -.9);
    const Eigen::VectorXd costs = costs_of_rest(values, lids, all, all, beside_a_hand);
    EXPECT_GT(costs[0], costs[9] + 2);
    EXPECT_THROW(costs_of_rest(values, lids, all, all, beside_a_hand.leftCols(1)), InvalidInput);
}

TEST(Rest, ChancesNeedAnExpressionAFrame) {
    EXPECT_THROW(chances_of_rest(Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones(), Expressions::Zero(2, 6)),
                 InvalidInput);
}

}  // namespace
}  // namespace mimetic
