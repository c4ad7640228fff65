// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/retarget/response.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

TEST(Response, ScalesShiftsAndCuts) {
    const Eigen::Vector3d played = played_values(Eigen::Vector3d(0, .5, 1), {1.3, -.1, 0, .9});
    EXPECT_TRUE(played.isApprox(Eigen::Vector3d(0, .55, .9)));
}

TEST(Response, ACurveBendsBetweenTheEndsOfTheRange) {
    Response response{1, 0, -2, .5};
    response.curve = 2;
    const Eigen::VectorXd fitted = Eigen::VectorXd::LinSpaced(11, -2, .5);
    const Eigen::VectorXd played = played_values(fitted, response);
    EXPECT_DOUBLE_EQ(played(0), -2);
    EXPECT_DOUBLE_EQ(played(8), 0);
    EXPECT_DOUBLE_EQ(played(10), .5);
    EXPECT_NEAR(played(4), -.5, 1e-12);   // half of the way down, squared
    EXPECT_NEAR(played(9), .125, 1e-12);  // and up
    response.curve = .5;
    EXPECT_NEAR(played_values(played, response).cwiseAbs().sum(), fitted.cwiseAbs().sum(), 1e-9);
}

TEST(Response, WhereTheRangeEndsAtNothingIsNoCurve) {
    Response response;
    response.curve = 3;
    response.offset = .2;
    EXPECT_DOUBLE_EQ(played_values(Eigen::VectorXd::Constant(1, -.1), response)(0), .1);
    response.lowest = .2;  // all above 0
    EXPECT_DOUBLE_EQ(played_values(Eigen::VectorXd::Constant(1, -.1), response)(0), .2);
}

TEST(Response, RefusesWhatIsNone) {
    Response response;
    response.curve = 0;
    EXPECT_THROW(played_values(Eigen::VectorXd::Zero(1), response), InvalidInput);
    response = {1, 0, 1, .5};
    EXPECT_THROW(played_values(Eigen::VectorXd::Zero(1), response), InvalidInput);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(played_values(Eigen::VectorXd::Constant(1, nan), {}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
