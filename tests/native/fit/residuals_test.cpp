// SPDX-License-Identifier: GPL-3.0-or-later
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

/// Largest difference between the derivatives and central differences, relative to the largest derivative.
double derivative_error(const ceres::CostFunction& cost, std::vector<std::vector<double>> parameters) {
    const auto evaluate = [&](std::vector<MatrixRows>* jacobians) {
        std::vector<const double*> blocks;
        for (const auto& block : parameters) blocks.push_back(block.data());
        std::vector<double*> derivatives;
        if (jacobians != nullptr) {
            for (const auto& block : parameters) {
                jacobians->emplace_back(cost.num_residuals(), static_cast<Eigen::Index>(block.size()));
            }
            for (auto& jacobian : *jacobians) derivatives.push_back(jacobian.data());
        }
        Eigen::VectorXd residuals(cost.num_residuals());
        EXPECT_TRUE(cost.Evaluate(blocks.data(), residuals.data(),
                                  jacobians != nullptr ? derivatives.data() : nullptr));
        return residuals;
    };
    std::vector<MatrixRows> jacobians;
    evaluate(&jacobians);
    double worst = 0;
    constexpr double kStep = 1e-6;
    for (std::size_t b = 0; b < parameters.size(); ++b) {
        const double scale = jacobians[b].cwiseAbs().maxCoeff();
        EXPECT_GT(scale, 0);
        for (std::size_t k = 0; k < parameters[b].size(); ++k) {
            const double value = parameters[b][k];
            parameters[b][k] = value + kStep;
            const Eigen::VectorXd above = evaluate(nullptr);
            parameters[b][k] = value - kStep;
            const Eigen::VectorXd below = evaluate(nullptr);
            parameters[b][k] = value;
            const Eigen::VectorXd difference = (above - below) / (2 * kStep);
            const double off =
                (difference - jacobians[b].col(static_cast<Eigen::Index>(k))).cwiseAbs().maxCoeff();
            worst = std::max(worst, off / scale);
        }
    }
    return worst;
}

const std::vector<double> kPose = {2.8, 0.3, -0.4, 0.03, -0.02, 0.7};
const std::vector<double> kLogFocal = {std::log(600.0)};
const std::vector<double> kIdentity = {0.3, -0.2, 0.5, 0.1, -0.7};

TEST(ProjectionResidual, DerivativesMeetFiniteDifferences) {
    const fit::ProjectionResidual point({0.02, -0.03, 0.09}, some_modes(), {320, 200},
                                        2 * Eigen::Matrix2d::Identity(), {319.5, 239.5});
    EXPECT_LT(derivative_error(point, {kPose, kLogFocal, kIdentity}), 1e-6);
    const fit::ProjectionResidual along_normal({0.02, -0.03, 0.09}, some_modes(), {320, 200},
                                               Eigen::RowVector2d(0.6, 0.8), {319.5, 239.5});
    EXPECT_LT(derivative_error(along_normal, {kPose, kLogFocal, kIdentity}), 1e-6);
}

TEST(MotionResidual, DerivativesMeetFiniteDifferences) {
    const fit::MotionResidual cost({0.02, -0.03, 0.08}, some_modes(), {12, -7}, 0.4, {320, 240});
    const std::vector<double> turned = {2.7, 0.5, -0.3, 0.02, -0.01, 0.68};
    EXPECT_LT(derivative_error(cost, {kPose, turned, kLogFocal, kIdentity}), 1e-6);
}

TEST(IdentityResidual, DerivativesMeetFiniteDifferences) {
    const fit::IdentityResidual residual(Eigen::VectorXd::Constant(kModes, 0.4), {0.06, 0.001, 0},
                                         some_modes(), 0.063, 1e-3);
    EXPECT_LT(derivative_error(residual, {kIdentity}), 1e-6);
}

}  // namespace
}  // namespace mimetic
