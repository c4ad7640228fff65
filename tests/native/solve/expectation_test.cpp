// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/expectation.hpp"

#include <gtest/gtest.h>

#include "face_scene.hpp"
#include "shared/gray.hpp"
#include "solve/reference_views.hpp"

namespace mimetic {
namespace {

class ExpectationTest : public testing::Test {
protected:
    test::FaceScene scene;
    TrackedFace face{scene.camera, scene.surface, scene.motion, {}};
    FaceState state{scene.camera_from_head, scene.rest()};
};

TEST_F(ExpectationTest, AFaceThatStoodStillIsExpectedWhereItWasButLessSurely) {
    const TrackMemory memory = first_memory(face, {}, state);
    const Expectation expected = predict(face, memory);
    EXPECT_LT(expected.mean.difference_from(state).flat.norm(), 1e-12);
    const Eigen::VectorXd growth = (expected.covariance - memory.covariance).diagonal();
    EXPECT_GT(growth.head<6>().minCoeff(), 0);
    const Eigen::MatrixXd whole = expected.covariance * expected.information;
    EXPECT_TRUE(whole.isIdentity(1e-6));
}

TEST_F(ExpectationTest, AMovingFaceIsExpectedAheadAndWithinItsBounds) {
    TrackMemory memory = first_memory(face, {}, state);
    memory.velocity.translation() << .01, 0, 0;
    memory.velocity.values()[0] = 5;
    const FaceState mean = predict(face, memory).mean;
    EXPECT_NEAR(mean.camera_from_head.translation().x() - state.camera_from_head.translation().x(), .006,
                1e-12);
    EXPECT_EQ(mean.values[0], face.motion.upper[0]);
    EXPECT_EQ(mean.values[1], 0);
}

TEST_F(ExpectationTest, ThePriorPullsBackToWhatIsExpected) {
    const Expectation expected = predict(face, first_memory(face, {}, state));
    FaceState aside = state;
    aside.camera_from_head.translation().x() += .01;
    EXPECT_LT(expected.from(aside, face).gradient[3], 0);
    EXPECT_NEAR(expected.about(aside).from(aside, face).gradient[3], 0, 1e-9);
}

TEST_F(ExpectationTest, ATextureIsTakenWhereNoneIsNearAndUsedThere) {
    const auto gray_at = [&](const Eigen::Isometry3d& pose) {
        const std::vector<std::uint8_t> image = scene.render(pose, scene.rest());
        return to_gray(scene.view(image)).clone();
    };
    ReferenceViews views(face, state, gray_at(state.camera_from_head));
    FaceState turned = state;
    turned.camera_from_head.linear() =
        state.camera_from_head.linear() * Eigen::AngleAxisd(.4, Eigen::Vector3d::UnitY());
    const cv::Mat1b gray = gray_at(turned.camera_from_head);
    for (int frame = 0; frame < 12; ++frame) {
        views.offer(face, turned, gray, false, {});
    }
    EXPECT_EQ(views.near(turned.camera_from_head).size(), 1u) << "nothing is taken of a doubtful frame";
    views.offer(face, turned, gray, true, Eigen::VectorXd::Zero(face.motion.detail_std.size()));
    EXPECT_EQ(views.near(turned.camera_from_head).size(), 2u);
    EXPECT_EQ(views.near(state.camera_from_head).size(), 1u);
    EXPECT_NEAR(view_angle(state.camera_from_head, turned.camera_from_head), .4, 1e-6);
}

}  // namespace
}  // namespace mimetic
