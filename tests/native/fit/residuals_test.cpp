// SPDX-License-Identifier: GPL-3.0-or-later
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "../../../native/src/fit/residuals.hpp"

namespace mimetic {
namespace {

constexpr int kModes = 5;

Eigen::Matrix3Xd some_modes() {
    Eigen::Matrix3Xd modes(3, kModes);
    for (int i = 0; i < modes.size(); ++i) modes.data()[i] = 0.01 * std::sin(1.0 + 3 * i);
    return modes;
}

bool agrees(const ceres::CostFunction& cost, const std::vector<const double*>& parameters) {
    ceres::NumericDiffOptions options;
    const ceres::GradientChecker checker(
        &cost, static_cast<const std::vector<const ceres::Manifold*>*>(nullptr), options);
    ceres::GradientChecker::ProbeResults results;
    const bool good = checker.Probe(parameters.data(), 1e-6, &results);
    EXPECT_TRUE(good) << results.error_log;
    return good;
}

TEST(ProjectionResidual, DerivativesMeetFiniteDifferences) {
    const double pose[] = {2.8, 0.3, -0.4, 0.03, -0.02, 0.7};
    const double log_focal = std::log(600.0);
    const double identity[kModes] = {0.3, -0.2, 0.5, 0.1, -0.7};
    const fit::ProjectionResidual point({0.02, -0.03, 0.09}, some_modes(), {320, 200},
                                        2 * Eigen::Matrix2d::Identity(), {319.5, 239.5});
    EXPECT_TRUE(agrees(point, {pose, &log_focal, identity}));
    const fit::ProjectionResidual along_normal({0.02, -0.03, 0.09}, some_modes(), {320, 200},
                                               Eigen::RowVector2d(0.6, 0.8), {319.5, 239.5});
    EXPECT_TRUE(agrees(along_normal, {pose, &log_focal, identity}));
}

TEST(IdentityResidual, DerivativesMeetFiniteDifferences) {
    const double identity[kModes] = {0.3, -0.2, 0.5, 0.1, -0.7};
    const fit::IdentityResidual residual(Eigen::VectorXd::Constant(kModes, 0.4), {0.06, 0.001, 0},
                                         some_modes(), 0.063, 1e-3);
    EXPECT_TRUE(agrees(residual, {identity}));
}

}  // namespace
}  // namespace mimetic
