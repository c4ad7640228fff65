// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/depth_error.hpp"

#include <gtest/gtest.h>

#include "../sanitized.hpp"
#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::FaceScene;
using test::repeats;

constexpr double kAside = .006;  // metres that the chin moves aside at the value 1

/// A head whose chin goes aside by its last value, and another with that chin too far behind.
class DepthErrorTest : public testing::Test {
protected:
    DepthErrorTest() {
        add_chin(scene);
        shown = scene;
        const Eigen::Index side = scene.motion.modes.rows() - 1;
        for (Eigen::Index v = 0; v < shown.motion.neutral.rows(); ++v) {
            shown.motion.neutral(v, 2) -= scene.motion.modes(side, 3 * v);  // 6 mm
        }
    }

    static void add_chin(FaceScene& scene) {
        FaceMotion& motion = scene.motion;
        const Eigen::Index side = motion.modes.rows();
        motion.modes.conservativeResize(side + 1, Eigen::NoChange);
        motion.modes.row(side).setZero();
        for (Eigen::Index v = 0; v < motion.neutral.rows(); ++v) {
            const double distance = std::hypot(motion.neutral(v, 0), motion.neutral(v, 1) + .08);
            motion.modes(side, 3 * v) = kAside * std::exp(-.5 * std::pow(distance / .03, 2));
        }
        for (Eigen::VectorXd* vector : {&motion.lower, &motion.upper, &motion.prior_std}) {
            vector->conservativeResize(side + 1);
        }
        motion.lower[side] = -1;
        motion.upper[side] = 1;
        motion.prior_std[side] = .1;
    }

    Eigen::Isometry3d turned(double angle) const {
        Eigen::Isometry3d pose = scene.camera_from_head;
        pose.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * pose.linear();
        return pose;
    }

    /// The last value of each frame, in which the head is turned by `angles` and has it as `values`.
    std::vector<double> followed(const FaceMotion& motion, const std::vector<double>& angles,
                                 const std::vector<double>& values) const {
        const auto image = shown.render(shown.camera_from_head, shown.rest());
        FaceTracker tracker(scene.camera, scene.surface, motion, scene.view(image), scene.camera_from_head);
        std::vector<double> read;
        for (std::size_t t = 0; t < angles.size(); ++t) {
            Eigen::VectorXd here = shown.rest();
            here.tail<1>().setConstant(values[t]);
            const auto frame = shown.render(turned(angles[t]), here, 2, 1, 0, static_cast<unsigned>(t + 3));
            read.push_back(tracker.advance(scene.view(frame)).values.tail<1>()[0]);
        }
        return read;
    }

    FaceMotion allowing() const {
        FaceMotion motion = scene.motion;
        motion.depth_std = Eigen::VectorXd::Zero(motion.lower.size());
        motion.depth_std.tail<1>().setConstant(1);
        return motion;
    }

    FaceScene scene, shown;
};

TEST_F(DepthErrorTest, AChinThatLiesDeeperIsNoMovementOfATurnedHead) {
    std::vector<double> angles;
    for (int t = 0; t <= repeats(20, 5); ++t) {
        angles.push_back(.4 * std::sin(.314 * t));
    }
    const std::vector<double> still(angles.size(), 0);
    const std::vector<double> without = followed(scene.motion, angles, still);
    const std::vector<double> with = followed(allowing(), angles, still);
    double worst_without = 0, worst_with = 0;
    for (std::size_t t = 0; t < angles.size(); ++t) {
        worst_without = std::max(worst_without, std::abs(without[t]));
        worst_with = std::max(worst_with, std::abs(with[t]));
    }
    EXPECT_GT(worst_without, .2);
    EXPECT_LT(worst_with, .3 * worst_without);
}

TEST_F(DepthErrorTest, AMovementIsReadInFullFromTheFrontAndAtAHeadThatTurnedBefore) {
    std::vector<double> angles, values;
    for (int t = 0; t <= repeats(51, 6); ++t) {
        angles.push_back(t < 12 ? 0 : .35 * std::sin(.2 * (t - 12)));
        values.push_back(t < 12 ? .7 * std::sin(.26 * t) : t < 42 ? 0 : .6);
    }
    const std::vector<double> read = followed(allowing(), angles, values);
    EXPECT_NEAR(read[6], values[6], .12);
    if (!test::kIsSanitized) {
        EXPECT_NEAR(read[49], values[49], .15);
    }
}

TEST_F(DepthErrorTest, TheErrorGrowsWithTheTangentOfTheTurnAndFramesNarrowIt) {
    DepthErrors errors(allowing(), scene.camera_from_head);
    EXPECT_NEAR(errors.at(scene.camera_from_head)[0].variance, 0, 1e-12);
    EXPECT_NEAR(std::sqrt(errors.at(turned(.3))[0].variance), std::tan(.3), 1e-9);
    EXPECT_EQ(errors.at(turned(.3))[0].mean, 0);
    const double before = errors.at(turned(.3))[0].variance;
    const double depth = errors.at(turned(.3))[0].mean;
    for (int t = 0; t < 100; ++t) {
        errors.learn(turned(.3), scene.motion.lower.size() - 1, .2, 1e-4, 25);
    }
    EXPECT_GT(errors.at(turned(.3))[0].mean, depth + .1);
    EXPECT_LT(errors.at(turned(.3))[0].mean, .2);
    EXPECT_NEAR(errors.at(turned(-.3))[0].mean, -errors.at(turned(.3))[0].mean, 1e-9);
    EXPECT_LT(errors.at(turned(.3))[0].variance, .5 * before);
}

TEST_F(DepthErrorTest, AFaceWithoutSuchValuesHasNoErrors) {
    EXPECT_TRUE(DepthErrors(scene.motion, scene.camera_from_head).at(turned(.3)).empty());
}

}  // namespace
}  // namespace mimetic
