// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

#include "shared/bilinear.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

TEST(Checks, SayTheNameTheNumberAndTheLimits) {
    EXPECT_NO_THROW(check_range("width", 1e-4, 1e-4, 1));
    try {
        check_range_at("width", 7, 0, 1e-4, 1);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_STREQ(error.what(), "width at vertex 7 is 0; it must be 0.0001 to 1");
    }
    EXPECT_THROW(check_range("width", std::numeric_limits<double>::quiet_NaN(), 0, 1), InvalidInput);
    EXPECT_THROW(require(false, "no"), InvalidInput);
}

TEST(Robust, TukeysWeightFallsFromOneToNothingAtTheCut) {
    EXPECT_EQ(tukey_weight(0.), 1);
    EXPECT_NEAR(tukey_weight(.5), .5625, 1e-12);
    EXPECT_EQ(tukey_weight(1.f), 0);
    EXPECT_EQ(tukey_weight(3.), 0);
}

TEST(Robust, TheMedianOfAnEvenNumberIsTheUpper) {
    std::vector<double> values{3, 1, 4, 2};
    EXPECT_EQ(upper_median(values), 3);
    values.clear();
    EXPECT_EQ(upper_median(values, 7.), 7);
}

TEST(Bilinear, IsLinearBetweenPixels) {
    const cv::Mat1b image = (cv::Mat1b(2, 3) << 0, 10, 20, 100, 110, 120);
    EXPECT_NEAR(bilinear(image, 1.25, .5), 62.5, 1e-12);
    EXPECT_NEAR(bilinear(cv::Mat1f(image), 0.f, 0.f), 0, 1e-6);
}

TEST(Rotations, VectorsGoToRotationsAndBackAndTurnsAreLimited) {
    const Eigen::Vector3d vector(.3, -.5, .2);
    EXPECT_LT((rotation_vector(rotation_from_vector(vector)) - vector).norm(), 1e-12);
    EXPECT_LT((rotation_vector(rotation_from_vector(vector, .1)) - .1 * vector.normalized()).norm(), 1e-12);
    EXPECT_TRUE(rotation_vector(Eigen::Matrix3d::Identity()).isZero(1e-12));
}

}  // namespace
}  // namespace mimetic
