// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/fit/fit.hpp>
#include <mimetic/shared/error.hpp>
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
            fit_face(cloud.model, {{cloud.seen(pose, identity, 0.05), {}, {}}}, kCamera, options);
        EXPECT_TRUE(estimate.converged);
        EXPECT_LT(angle_deg(estimate.camera_from_head[0], pose), 0.5);
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
    const FaceEstimate estimate = fit_face(cloud.model, {{features, {}, {}}}, kCamera);
    EXPECT_LT(angle_deg(estimate.camera_from_head[0], pose), 1.0);
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
    const FaceEstimate estimate = fit_face(cloud.model, {{features, {}, {}}}, guess, options);
    EXPECT_LT(std::abs(estimate.focal - 700), 100);
}

TEST(FitFace, ProjectedFeaturesFallOnTheSeenOnes) {
    Cloud cloud;
    const FaceFeatures features = cloud.seen(turned(0.2, 0.1, 0), Eigen::VectorXd::Zero(4), 0);
    const FaceEstimate estimate = fit_face(cloud.model, {{features, {}, {}}}, kCamera);
    const FaceFeatures again = project_features(cloud.model, estimate, kCamera);
    for (const auto& feature : features.features) {
        EXPECT_LT((again.find(feature.name)->position - feature.position).norm(), 0.5) << feature.name;
    }
}

TEST(FitFace, PinIsMetHoweverFarOffItIs) {
    Cloud cloud;
    FaceView view{cloud.seen(turned(0.1, 0, 0), Eigen::VectorXd::Zero(4), 0.1), {}, {}};
    const Feature& seen = view.features.features[10];
    view.pins.push_back({seen.name, seen.position + Eigen::Vector2d(15, -8), 0.1, 1});
    const FaceEstimate estimate = fit_face(cloud.model, {view}, kCamera);
    const FaceFeatures fitted = project_features(cloud.model, estimate, kCamera);
    EXPECT_LT((fitted.find(seen.name)->position - view.pins[0].position).norm(), 1.0);
}

TEST(FitFace, ViewsOfOnePersonShareTheProportionsAndTellDepthTogether) {
    Cloud cloud;
    FitOptions options;
    options.gaze_spread = 0;
    Eigen::VectorXd identity = Eigen::VectorXd::Zero(4);
    identity(2) = 1.5;  // depth alone: one view from the front does not show it
    const std::vector<Eigen::Isometry3d> poses{turned(0, 0, 0), turned(0.3, 0, 0), turned(0, 0.25, 0)};
    std::vector<FaceView> views;
    for (const auto& pose : poses) views.push_back({cloud.seen(pose, identity, 0.05), {}, {}});
    const FaceEstimate alone = fit_face(cloud.model, {views[0]}, kCamera, options);
    const FaceEstimate joint = fit_face(cloud.model, views, kCamera, options);
    EXPECT_LT(std::abs(joint.identity(2) - 1.5), 0.1);
    EXPECT_GT(std::abs(alone.identity(2) - 1.5), 2 * std::abs(joint.identity(2) - 1.5));
    ASSERT_EQ(joint.camera_from_head.size(), 3U);
    for (std::size_t v = 0; v < 3; ++v) EXPECT_LT(angle_deg(joint.camera_from_head[v], poses[v]), 0.5);
    const FaceEstimate again = fit_face(cloud.model, views, kCamera, options, &joint);
    EXPECT_LT(again.iterations, joint.iterations);
    EXPECT_LT(angle_deg(again.camera_from_head[0], joint.camera_from_head[0]), 0.05);
}

TEST(FitFace, PosesThatAreKeptLeaveWhatFeaturesSayToTheProportions) {
    Cloud cloud;
    const Eigen::Isometry3d pose = turned(0.1, 0.05, 0);
    Eigen::VectorXd identity(4);
    identity << 0.8, -0.5, 0.4, 0.6;
    const FaceView view{cloud.seen(pose, identity, 0), {}, {}};
    FaceEstimate start;
    start.camera_from_head = {pose};
    start.focal = kCamera.fx;
    start.identity = Eigen::VectorXd::Zero(4);
    FitOptions options;
    options.pose_free = false;
    const FaceEstimate kept = fit_face(cloud.model, {view}, kCamera, options, &start);
    EXPECT_LT(angle_deg(kept.camera_from_head[0], pose), 1e-6);
    EXPECT_NEAR(kept.camera_from_head[0].translation().z(), 0.7, 1e-12);
    EXPECT_LT((kept.identity - identity).norm(), 0.1);
    EXPECT_THROW(fit_face(cloud.model, {view}, kCamera, options), InvalidInput);
    options.shape_free = false;
    EXPECT_THROW(fit_face(cloud.model, {view}, kCamera, options, &start), InvalidInput);
}

TEST(FitFace, FurtherViewsWeighAsIsAsked) {
    Cloud cloud;
    const Eigen::Isometry3d pose = turned(0, 0, 0);
    Eigen::VectorXd first = Eigen::VectorXd::Zero(4), second = first;
    second(3) = 1;
    const std::vector<FaceView> views{{cloud.seen(pose, first, 0), {}, {}},
                                      {cloud.seen(pose, second, 0), {}, {}}};
    FaceEstimate start;
    start.camera_from_head = {pose, pose};
    start.focal = kCamera.fx;
    start.identity = first;
    FitOptions options;
    options.pose_free = false;
    options.robust_scale = 1e3;
    const double little = fit_face(cloud.model, views, kCamera, options, &start).identity(3);
    options.elsewhere = 1;
    const double alike = fit_face(cloud.model, views, kCamera, options, &start).identity(3);
    EXPECT_NEAR(little, 0.1, 0.02);
    EXPECT_NEAR(alike, 0.5, 0.02);
}

TEST(FitFace, ALineBendsTheShapeAcrossItselfAlone) {
    Cloud cloud;
    cloud.model.points.row(2) << -0.02, -0.04, 0.09;
    cloud.model.points.row(3) << 0.0, -0.04, 0.095;
    cloud.model.points.row(4) << 0.02, -0.04, 0.09;
    cloud.model.modes.conservativeResize(5, Eigen::NoChange);
    cloud.model.modes.row(4).setZero();
    for (const int i : {2, 3, 4}) cloud.model.modes(4, 3 * i + 1) = 0.002;  // the lip's edge lies higher
    cloud.model.spread = Eigen::VectorXd::Ones(5);
    cloud.model.limits = MatrixRows(Eigen::VectorXd::Constant(5, 3) * Eigen::RowVector2d(-1, 1));
    cloud.model.curve_names = {"edge"};
    cloud.model.curves = {{2, 3, 4}};
    const Eigen::Isometry3d pose = turned(0, 0, 0);
    FaceFeatures features = cloud.seen(pose, Eigen::VectorXd::Zero(5), 0);
    FeatureCurve edge{"edge", Points2(3, 2), Points2(3, 2), Eigen::VectorXd::Constant(3, 0.2)};
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d higher(0.015 * (i - 1) + 0.003, -0.038, 0.092);  // and shifted along it
        edge.points.row(i) = kCamera.project(pose * higher).transpose();
        edge.normals.row(i) << 0, 1;
    }
    features.curves.push_back(edge);
    std::erase_if(features.features, [](const Feature& f) {
        return f.name == "point 2" || f.name == "point 3" || f.name == "point 4";
    });
    const FaceEstimate estimate = fit_face(cloud.model, {{features, {}, {}}}, kCamera);
    EXPECT_NEAR(estimate.identity(4), 1, 0.2);
    EXPECT_LT(estimate.identity.head(4).cwiseAbs().maxCoeff(), 0.2);
    // A landmark of the line's name that the user puts elsewhere is met, and takes the line along
    FaceView pinned{features, {}, {}};
    cloud.model.curve_names = {"point 3"};
    pinned.features.curves[0].name = "point 3";
    const Eigen::Vector3d lower(0, -0.042, 0.095);
    pinned.pins.push_back({"point 3", kCamera.project(pose * lower), 0.1, 1});
    const FaceEstimate moved = fit_face(cloud.model, {pinned}, kCamera);
    EXPECT_NEAR(moved.identity(4), -1, 0.25);
}

TEST(FitFace, MotionBetweenViewsTellsThePitchThatFeaturesLeaveOpen) {
    Cloud cloud;
    cloud.model.spread.setConstant(0.5);
    Eigen::VectorXd identity(4);
    identity << -0.5, 0.2, 0.8, 0.6;
    const Eigen::Isometry3d bent = turned(0, 0.2, 0), aside = turned(0.2, 0.2, 0);
    const Points points = cloud.model.shaped(identity);
    std::vector<FaceView> views{{cloud.seen(bent, identity, 0.5), {}, {}},
                                {cloud.seen(aside, identity, 0.5), {}, {}}};
    // Eyes and a few others: the features alone leave pitch to its prior
    for (auto& view : views) {
        view.features.features.resize(6);
        for (auto& feature : view.features.features) feature.sigma_px = 2;
    }
    const FaceEstimate alone = fit_face(cloud.model, {views[0]}, kCamera);
    for (int i = 0; i < points.rows(); ++i) {
        const Eigen::Vector2d before = kCamera.project(bent * points.row(i).transpose());
        views[1].motion.push_back({i, kCamera.project(aside * points.row(i).transpose()) - before, 0.05});
    }
    const FaceEstimate joint = fit_face(cloud.model, views, kCamera);
    EXPECT_LT(angle_deg(joint.camera_from_head[0], bent), 0.5 * angle_deg(alone.camera_from_head[0], bent));
    views[1].motion[0].point = 1000;
    EXPECT_THROW(fit_face(cloud.model, views, kCamera), InvalidInput);
}

TEST(FitFace, RefusesFeaturesWithoutPupilsAndModelsThatDoNotFit) {
    Cloud cloud;
    FaceFeatures features = cloud.seen(turned(0, 0, 0), Eigen::VectorXd::Zero(4), 0);
    FaceFeatures blind = features;
    blind.features.erase(blind.features.begin());
    EXPECT_THROW(fit_face(cloud.model, {{blind, {}, {}}}, kCamera), InvalidInput);
    FaceModel model = cloud.model;
    model.spread(1) = 0;
    EXPECT_THROW(fit_face(model, {{features, {}, {}}}, kCamera), InvalidInput);
    const FaceView stray{features, {{"no such point", {0, 0}, 1, 1}}, {}};
    EXPECT_THROW(fit_face(cloud.model, {stray}, kCamera), InvalidInput);
    EXPECT_THROW(fit_face(cloud.model, {}, kCamera), InvalidInput);
    features.features[3].position.x() = std::nan("");
    EXPECT_THROW(fit_face(cloud.model, {{features, {}, {}}}, kCamera), InvalidInput);
}

}  // namespace
}  // namespace mimetic
