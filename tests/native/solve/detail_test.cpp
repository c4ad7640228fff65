// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>

#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::FaceScene;

constexpr Eigen::Index kHidden = 2;  // of the scene's modes: what the values lack and only detail can follow

const FaceScene& scene() {
    static const FaceScene made;
    return made;
}

Eigen::VectorXd without_hidden(const Eigen::VectorXd& all) {
    Eigen::VectorXd rest(all.size() - 1);
    rest << all.head(kHidden), all.tail(all.size() - kHidden - 1);
    return rest;
}

/// Two sines across the face for a basis, and the hidden mode.
FaceMotion motion_with_detail() {
    const FaceMotion& whole = scene().motion;
    const Eigen::Index count = whole.modes.rows();
    FaceMotion motion = whole;
    motion.modes.resize(count - 1, whole.modes.cols());
    motion.modes << whole.modes.topRows(kHidden), whole.modes.bottomRows(count - kHidden - 1);
    motion.num_muscles = whole.num_muscles - 1;
    motion.lower = without_hidden(whole.lower);
    motion.upper = without_hidden(whole.upper);
    motion.prior_std = without_hidden(whole.prior_std);
    motion.detail_modes.setZero(3, whole.modes.cols());
    motion.detail_modes.row(0) = whole.modes.row(kHidden);
    for (Eigen::Index v = 0; v < whole.neutral.rows(); ++v) {
        motion.detail_modes(1, 3 * v) = .002 * std::sin(60 * whole.neutral(v, 1));
        motion.detail_modes(2, 3 * v + 1) = .002 * std::sin(70 * whole.neutral(v, 0));
    }
    motion.detail_std = Eigen::Vector3d(.6, .5, .5);
    return motion;
}

FaceTracker make_tracker(const FaceMotion& motion, const TrackerOptions& options = {}) {
    const auto image = scene().render(scene().camera_from_head, scene().rest());
    return {scene().camera, scene().surface, motion, scene().view(image), scene().camera_from_head, {},
            options};
}

Points moved(const FaceMotion& motion, const Eigen::VectorXd& values, const Eigen::VectorXd& detail) {
    Points points = motion.neutral;
    Eigen::Map<Eigen::VectorXd>(points.data(), points.size()) +=
        motion.modes.transpose() * values + motion.detail_modes.transpose() * detail;
    return points;
}

/// Root mean square distance in the image between two surfaces, frame pixels.
double pixels_apart(const Points& points, const Eigen::Isometry3d& pose, const Points& others,
                    const Eigen::Isometry3d& other_pose) {
    double sum = 0;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const Eigen::Vector3d point = pose * Eigen::Vector3d(points.row(v));
        const Eigen::Vector3d other = other_pose * Eigen::Vector3d(others.row(v));
        sum += (scene().camera.project(point) - scene().camera.project(other)).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(points.rows()));
}

TEST(Detail, FollowsWhatTheValuesCannotExplain) {
    const FaceMotion motion = motion_with_detail();
    const Eigen::VectorXd none = Eigen::Vector3d::Zero();
    FaceTracker tracker = make_tracker(motion);
    std::vector<FrameEstimate> estimates;
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Points> truth;
    for (unsigned t = 1; t <= 16; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[kHidden] = .25 * std::min(1., t / 10.);
        values[5] = .5 * std::min(1., t / 12.);
        poses.push_back(scene().camera_from_head);
        poses.back().linear() =
            Eigen::AngleAxisd(.01 * t, Eigen::Vector3d::UnitY()).toRotationMatrix() * poses.back().linear();
        const auto image = scene().render(poses.back(), values, 2, 1, 0, t);
        estimates.push_back(tracker.advance(scene().view(image)));
        Points whole = scene().motion.neutral;
        Eigen::Map<Eigen::VectorXd>(whole.data(), whole.size()) += scene().motion.modes.transpose() * values;
        truth.push_back(whole);
    }
    const std::vector<FrameEstimate> smoothed = smooth(estimates, motion);
    for (std::size_t t = 9; t < truth.size(); ++t) {
        for (const FrameEstimate& estimate : {estimates[t], smoothed[t]}) {
            const auto apart = [&](const Eigen::VectorXd& detail) {
                return pixels_apart(moved(motion, estimate.values, detail), estimate.camera_from_head,
                                    truth[t], poses[t]);
            };
            EXPECT_LT(apart(estimate.detail.coefficients), .85 * apart(none)) << "frame " << t;
            EXPECT_LT(estimate.detail.std[0], motion.detail_std[0]);
        }
    }
}

TEST(Detail, IsKeptByATextureTakenOnTheWay) {
    const FaceMotion motion = motion_with_detail();
    TrackerOptions first_alone;
    first_alone.max_key_views = 0;
    FaceTracker with_more = make_tracker(motion), without = make_tracker(motion, first_alone);
    double kept = 0, known = 0;
    int num_views = 1;
    for (unsigned t = 1; t <= 22; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[kHidden] = .25 * std::min(1., t / 8.);
        Eigen::Isometry3d pose = scene().camera_from_head;
        pose.linear() =
            Eigen::AngleAxisd(.02 * t, Eigen::Vector3d::UnitY()).toRotationMatrix() * pose.linear();
        const auto image = scene().render(pose, values, 2, 1, 0, t);
        const FrameEstimate estimate = with_more.advance(scene().view(image));
        known = without.advance(scene().view(image)).detail.coefficients[0];
        kept = estimate.detail.coefficients[0];
        num_views = estimate.num_views;
    }
    EXPECT_EQ(num_views, 2);
    EXPECT_GT(kept, .53 * known);  // .46 if the texture were taken as the values alone have it
}

TEST(Detail, IsNothingOnAStillFace) {
    const FaceMotion motion = motion_with_detail();
    FaceTracker tracker = make_tracker(motion);
    for (unsigned t = 0; t < 8; ++t) {
        const auto image = scene().render(scene().camera_from_head, scene().rest(), 4, 1, 0, 30 + t);
        const FrameEstimate estimate = tracker.advance(scene().view(image));
        EXPECT_LT(estimate.detail.coefficients.cwiseAbs().maxCoeff(), .1) << "frame " << t;
        EXPECT_LT(estimate.values.cwiseAbs().maxCoeff(), .05) << "frame " << t;
    }
}

TEST(Detail, LeavesHeldFramesToTheirNeighbours) {
    const FaceMotion motion = motion_with_detail();
    FaceTracker tracker = make_tracker(motion);
    std::vector<FrameEstimate> estimates;
    Eigen::VectorXd values = scene().rest();
    values[kHidden] = .6;
    for (unsigned t = 0; t < 7; ++t) {
        estimates.push_back(
            tracker.advance(scene().view(scene().render(scene().camera_from_head, values, 2, 1, 0, t))));
    }
    FrameEstimate& held = estimates[4];
    held.held = true;
    held.information.setZero();
    held.gradient.setZero();
    held.detail = {Eigen::Vector3d::Zero(), motion.detail_std, {}, {}, {}};
    const std::vector<FrameEstimate> smoothed = smooth(estimates, motion);
    EXPECT_NEAR(smoothed[4].detail.coefficients[0], smoothed[5].detail.coefficients[0], .05);
}

TEST(Detail, NamesModesThatDoNotFit) {
    FaceMotion motion = motion_with_detail();
    motion.detail_std = Eigen::Vector2d(.5, .5);
    EXPECT_THROW(make_tracker(motion), InvalidInput);
    motion.detail_std = Eigen::Vector3d(.5, 0, .5);
    EXPECT_THROW(make_tracker(motion), InvalidInput);
    motion = motion_with_detail();
    motion.detail_modes(1, 4) = std::nan("");
    EXPECT_THROW(make_tracker(motion), InvalidInput);
}

TEST(Detail, SmootherNamesAnEstimateWithoutIt) {
    const FaceMotion motion = motion_with_detail();
    FaceTracker tracker = make_tracker(motion);
    const auto image = scene().render(scene().camera_from_head, scene().rest());
    std::vector<FrameEstimate> estimates{tracker.advance(scene().view(image))};
    estimates[0].detail.pull = Eigen::VectorXd();
    EXPECT_THROW(smooth(estimates, motion), InvalidInput);
}

}  // namespace
}  // namespace mimetic
