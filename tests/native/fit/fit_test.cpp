// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/error.hpp>
#include <mimetic/fit.hpp>
#include <random>

namespace mimetic {
namespace {

const Camera kCamera{700, 700, 319.5, 239.5, 640, 480};

/// A cloud of landmarks, the first two of them the eyes, with modes that bend it smoothly.
struct Cloud {
    FaceModel model;
    std::mt19937 random{7};

    Cloud() {
        constexpr int kPoints = 30;
        constexpr int kModes = 4;
        std::uniform_real_distribution<double> uniform(-1, 1);
        model.points.resize(kPoints, 3);
        model.points.row(0) << 0.0315, 0.03, 0.07;
        model.points.row(1) << -0.0315, 0.03, 0.07;
        for (int i = 2; i < kPoints; ++i) {
            const double x = 0.06 * uniform(random), y = 0.08 * uniform(random);
            model.points.row(i) << x, y, 0.1 - 8 * x * x - 3 * y * y;
        }
        model.modes.resize(kModes, 3 * kPoints);
        for (int i = 0; i < kPoints; ++i) {
            const Eigen::RowVector3d p = model.points.row(i);
            model.modes.row(0).segment<3>(3 * i) << 0, 0.1 * p.y(), 0;
            // The eyes stay 63 mm apart in every shape: that distance sets the scale
            model.modes.row(1).segment<3>(3 * i) << (i < 2 ? 0 : p.x() * p.y()), 0, 0;
            model.modes.row(2).segment<3>(3 * i) << 0, 0, 2 * p.x() * p.x();
            model.modes.row(3).segment<3>(3 * i) << 0, 2 * p.x() * p.x(), 0;
        }
        model.spread = Eigen::VectorXd::Ones(kModes);
        model.limits.resize(kModes, 2);
        model.limits.col(0).setConstant(-3);
        model.limits.col(1).setConstant(3);
        model.on_outline.assign(kPoints, false);
        model.landmark_weights.resize(kPoints, kPoints);
        model.landmark_weights.setIdentity();
        model.landmark_names = {"pupil.L", "pupil.R"};
        for (int i = 2; i < kPoints; ++i) model.landmark_names.push_back("point " + std::to_string(i));
    }

    FaceFeatures seen(const Eigen::Isometry3d& camera_from_head, const Eigen::VectorXd& identity,
                      double noise_px) {
        std::normal_distribution<double> normal(0, noise_px);
        FaceFeatures features;
        const Points points = model.shaped(identity);
        for (int i = 0; i < points.rows(); ++i) {
            Eigen::Vector2d pixel = kCamera.project(camera_from_head * points.row(i).transpose());
            pixel += Eigen::Vector2d(normal(random), normal(random));
            features.features.push_back({model.landmark_names[static_cast<std::size_t>(i)], pixel, 0.1, 1});
        }
        return features;
    }
};

Eigen::Isometry3d turned(double yaw, double pitch, double roll) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()))
                        .toRotationMatrix() *
                    Eigen::Vector3d(1, -1, -1).asDiagonal();
    pose.translation() = Eigen::Vector3d(0.05, -0.02, 0.7);
    return pose;
}

double angle_deg(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / M_PI;
}

TEST(FitFace, RecoversPoseWithinHalfADegreeAndTheProportions) {
    Cloud cloud;
    FitOptions options;
    options.gaze_spread = 0;
    options.pitch_spread = 1;
    Eigen::VectorXd identity(4);
    identity << 0.8, -1.2, 0.9, -0.7;
    for (const auto& [yaw, pitch, roll] :
         {std::tuple{0.0, 0.0, 0.0}, std::tuple{0.3, -0.1, 0.2}, std::tuple{-0.25, 0.15, -0.3}}) {
        const Eigen::Isometry3d pose = turned(yaw, pitch, roll);
        const FaceEstimate estimate =
            fit_face(cloud.model, cloud.seen(pose, identity, 0.05), kCamera, options);
        EXPECT_TRUE(estimate.converged);
        EXPECT_LT(angle_deg(estimate.camera_from_head, pose), 0.5);
        const Points fitted = cloud.model.shaped(estimate.identity);
        EXPECT_NEAR((fitted.row(0) - fitted.row(1)).norm(), 0.063, 1e-4);
        EXPECT_LT((fitted - cloud.model.shaped(identity)).rowwise().norm().maxCoeff(), 0.004);
    }
}

TEST(FitFace, OneFeatureFarOffHardlyTurnsTheHead) {
    Cloud cloud;
    const Eigen::Isometry3d pose = turned(0.1, 0, 0);
    FaceFeatures features = cloud.seen(pose, Eigen::VectorXd::Zero(4), 0.1);
    features.features[10].position.x() += 40;
    const FaceEstimate estimate = fit_face(cloud.model, features, kCamera);
    EXPECT_LT(angle_deg(estimate.camera_from_head, pose), 1.0);
}

TEST(FitFace, FreeFocalLengthMovesFromAWrongPriorTowardsTheTruth) {
    Cloud cloud;
    FitOptions options;
    options.focal_free = true;
    options.gaze_spread = 0;
    Camera guess = kCamera;
    guess.fx = guess.fy = 900;
    const Eigen::Isometry3d pose = turned(0.3, 0.1, 0);
    const FaceFeatures features = cloud.seen(pose, Eigen::VectorXd::Zero(4), 0);
    const FaceEstimate estimate = fit_face(cloud.model, features, guess, options);
    EXPECT_LT(std::abs(estimate.focal - 700), 100);
}

TEST(FitFace, ProjectedFeaturesFallOnTheSeenOnes) {
    Cloud cloud;
    const FaceFeatures features = cloud.seen(turned(0.2, 0.1, 0), Eigen::VectorXd::Zero(4), 0);
    const FaceEstimate estimate = fit_face(cloud.model, features, kCamera);
    const FaceFeatures again = project_features(cloud.model, estimate, kCamera);
    for (const auto& feature : features.features) {
        EXPECT_LT((again.find(feature.name)->position - feature.position).norm(), 0.5) << feature.name;
    }
}

TEST(FitFace, RefusesFeaturesWithoutPupilsAndModelsThatDoNotFit) {
    Cloud cloud;
    FaceFeatures features = cloud.seen(turned(0, 0, 0), Eigen::VectorXd::Zero(4), 0);
    FaceFeatures blind = features;
    blind.features.erase(blind.features.begin());
    EXPECT_THROW(fit_face(cloud.model, blind, kCamera), InvalidInput);
    FaceModel model = cloud.model;
    model.spread(1) = 0;
    EXPECT_THROW(fit_face(model, features, kCamera), InvalidInput);
    features.features[3].position.x() = std::nan("");
    EXPECT_THROW(fit_face(cloud.model, features, kCamera), InvalidInput);
}

}  // namespace
}  // namespace mimetic
