// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/shared/error.hpp>

#include "../sanitized.hpp"
#include "head_scene.hpp"

namespace mimetic {
namespace {

using test::degrees_between;
using test::HeadScene;
using test::repeats;

struct Score {
    double mean = 0;  // degrees
    double worst = 0;
    double last = 0;
    double translation = 0;  // mean, metres
    int num_held = 0;
    int num_within_two_std = 0;
    int num_frames = 0;
};

/// Follows a scene's motion from frame 0 to `end`, every `step`th frame.
Score follow(const HeadScene& scene, const HeadShape& shape, int end, int step,
             const HeadOptions& options = {}) {
    const auto reference = scene.render(HeadScene::motion(0));
    HeadTracker tracker(scene.camera, shape, scene.view(reference), HeadScene::motion(0), options);
    Score score;
    for (int frame = step; frame < end; frame += step) {
        const Eigen::Isometry3d truth = HeadScene::motion(frame);
        const auto image = scene.render(truth, static_cast<unsigned>(frame), 1 + .2 * std::sin(.05 * frame));
        const HeadEstimate estimate = tracker.advance(scene.view(image));
        score.last = degrees_between(estimate.camera_from_head, truth);
        score.mean += score.last;
        score.worst = std::max(score.worst, score.last);
        score.translation += (estimate.camera_from_head.translation() - truth.translation()).norm();
        const double std = std::sqrt(estimate.covariance.diagonal().head<3>().sum()) * 180 / M_PI;
        score.num_within_two_std += score.last < 2 * std;
        score.num_held += estimate.held;
        ++score.num_frames;
    }
    score.mean /= score.num_frames;
    score.translation /= score.num_frames;
    return score;
}

HeadShape shape_of(const HeadScene& scene, HeadModel model) {
    return make_head_shape(model, scene.vertices, scene.faces);
}

TEST(HeadTracker, FollowsAnEllipsoidThroughThreeHundredFramesWithoutDrift) {
    const HeadScene scene(true);
    // Five frames in six are skipped: 300 frames of the motion, in both directions of every axis.
    const Score score = follow(scene, shape_of(scene, HeadModel::ellipsoid), repeats(300, 60), 6);
    EXPECT_LT(score.mean, .8);
    EXPECT_LT(score.worst, 2);
    EXPECT_LT(score.last, 1);
    EXPECT_LT(score.translation, 4e-3);  // 0.7 % of the distance
    EXPECT_EQ(score.num_held, 0);
    EXPECT_GT(score.num_within_two_std, .9 * score.num_frames);
}

TEST(HeadTracker, FindsTheDepthThatTheFirstFitHadWrong) {
    const HeadScene scene(true);
    HeadShape shape = shape_of(scene, HeadModel::ellipsoid);
    const auto depth = [](const HeadShape& of) { return of.half_axes.z() / of.half_axes.x(); };
    const double truth = depth(shape);
    shape.half_axes.z() *= .8;
    const auto reference = scene.render(HeadScene::motion(0));
    HeadTracker tracker(scene.camera, shape, scene.view(reference), HeadScene::motion(0));
    EXPECT_FALSE(tracker.relax());  // one view shows no depth
    const int step = 150 / repeats(30, 10);
    for (int frame = step; frame < 150; frame += step) {
        tracker.advance(scene.view(scene.render(HeadScene::motion(frame), static_cast<unsigned>(frame))));
    }
    EXPECT_TRUE(tracker.relax());
    EXPECT_NEAR(depth(tracker.shape()), truth, .08 * truth);
}

TEST(HeadTracker, PlaneIsWorseThanEllipsoidAndSurfaceIsBestOnAHeadThatIsNone) {
    const HeadScene scene(false);
    const int end = repeats(90, 20);
    const Score ellipsoid = follow(scene, shape_of(scene, HeadModel::ellipsoid), end, 4);
    const Score plane = follow(scene, shape_of(scene, HeadModel::plane), end, 4);
    const Score surface = follow(scene, shape_of(scene, HeadModel::surface), end, 4);
    EXPECT_LT(ellipsoid.mean, 3);
    EXPECT_LT(ellipsoid.mean, plane.mean / 3);
    EXPECT_LT(surface.mean, 1);
    EXPECT_LT(surface.mean, ellipsoid.mean);
    EXPECT_LT(surface.translation, 2e-3);
    EXPECT_EQ(ellipsoid.num_held + surface.num_held, 0);
}

TEST(HeadTracker, ReferenceTexturesStopWhatFlowAloneAddsUp) {
    const HeadScene scene(false);
    const HeadShape shape = shape_of(scene, HeadModel::surface);
    HeadOptions flow_alone;
    flow_alone.max_key_views = 0;
    const int end = repeats(60, 20);
    EXPECT_LT(3 * follow(scene, shape, end, 1).worst, follow(scene, shape, end, 1, flow_alone).worst);
}

TEST(HeadTracker, FastPathFollowsAsWellWhereItIsTaken) {
    const HeadScene scene(false);
    HeadOptions fast;
    fast.fast = true;
    const Score surface = follow(scene, shape_of(scene, HeadModel::surface), repeats(60, 30), 2, fast);
    EXPECT_LT(surface.mean, 1);
    EXPECT_LT(surface.worst, 3);
    EXPECT_EQ(surface.num_held, 0);
    EXPECT_GT(surface.num_within_two_std, .9 * surface.num_frames);
}

TEST(HeadTracker, HoldsALostHeadAndFindsItAtTheDetectorsGuess) {
    const HeadScene scene(false);
    const auto reference = scene.render(HeadScene::pose(0, 0, 0));
    HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::surface), scene.view(reference),
                        HeadScene::pose(0, 0, 0));
    const std::vector<std::uint8_t> wall(reference.size(), 120);
    HeadEstimate estimate = tracker.advance(scene.view(wall));
    EXPECT_TRUE(estimate.held);
    EXPECT_LT(estimate.quality, .2);
    const double before = estimate.covariance.trace();
    estimate = tracker.advance(scene.view(wall));
    EXPECT_GT(estimate.covariance.trace(), before);
    const Eigen::Isometry3d back = HeadScene::pose(14, -6, 5, .06, -.02, .03);
    const auto image = scene.render(back, 5);
    estimate = tracker.advance(scene.view(image), HeadScene::pose(10, -3, 2, .055, -.016, .04));
    EXPECT_FALSE(estimate.held);
    EXPECT_LT(degrees_between(estimate.camera_from_head, back), 1.5);
}

TEST(HeadTracker, StatesOfALostHeadWhatItMayDoInTheTimeOfAFrame) {
    const HeadScene scene(false);
    const auto reference = scene.render(HeadScene::pose(0, 0, 0));
    const std::vector<std::uint8_t> wall(reference.size(), 120);
    const auto growth = [&](double frame_rate) {
        HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::surface), scene.view(reference),
                            HeadScene::pose(0, 0, 0), {.frame_rate = frame_rate});
        const Matrix6 before = tracker.advance(scene.view(wall)).covariance;
        return Matrix6(tracker.advance(scene.view(wall)).covariance - before);
    };
    EXPECT_TRUE(growth(24).isApprox(2.5 * growth(60), 1e-9));
}

TEST(HeadTracker, IsNotLedAstrayByAHandOverHalfTheFace) {
    const HeadScene scene(false);
    const auto reference = scene.render(HeadScene::pose(0, 0, 0));
    HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::surface), scene.view(reference),
                        HeadScene::pose(0, 0, 0));
    HeadEstimate estimate;
    for (int frame = 1; frame <= 8; ++frame) {
        const auto image =
            scene.render(HeadScene::pose(frame, 0, .5 * frame), static_cast<unsigned>(frame), 1, frame > 3);
        estimate = tracker.advance(scene.view(image));
    }
    EXPECT_FALSE(estimate.held);
    EXPECT_LT(degrees_between(estimate.camera_from_head, HeadScene::pose(8, 0, 4)), 2.5);
}

/// A head that is dissolved into another in the same place, and back; true where it was held.
std::vector<bool> held_through_dissolve(double alike) {
    const HeadScene scene(false);
    HeadScene other(false);
    other.alike = alike;
    const Eigen::Isometry3d pose = HeadScene::pose(0, 0, 0);
    HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::surface), scene.view(scene.render(pose)),
                        pose);
    std::vector<bool> held;
    for (const double share : {0., .25, .5, .75, 1., 1., 1., .75, .5, .25, 0., 0.}) {
        const auto own = scene.render(pose, static_cast<unsigned>(held.size()));
        auto image = other.render(pose, static_cast<unsigned>(held.size()));
        for (std::size_t k = 0; k < image.size(); ++k) {
            image[k] = static_cast<std::uint8_t>(std::lround((1 - share) * own[k] + share * image[k]));
        }
        held.push_back(tracker.advance(scene.view(image)).held);
    }
    return held;
}

TEST(HeadTracker, HoldsAHeadThatOnlyResemblesTheOneItReplaced) {
    const std::vector<bool> held = held_through_dissolve(.4);
    EXPECT_FALSE(held[0] || held[1]);
    EXPECT_TRUE(held[4] && held[5] && held[6]);
    EXPECT_FALSE(held[10] || held[11]);
}

TEST(HeadTracker, ForgetsTexturesOfTheLastFrames) {
    const HeadScene scene(false);
    const auto reference = scene.render(HeadScene::motion(0));
    HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::ellipsoid), scene.view(reference),
                        HeadScene::motion(0));
    const Eigen::Vector3d given = tracker.shape().half_axes;
    HeadEstimate estimate;
    int views_at_ten = 0;
    for (int frame = 1; frame <= 20; ++frame) {
        const auto image = scene.render(HeadScene::motion(frame), static_cast<unsigned>(frame));
        estimate = tracker.advance(scene.view(image));
        views_at_ten = frame == 10 ? estimate.num_views : views_at_ten;
    }
    ASSERT_GT(estimate.num_views, views_at_ten);
    tracker.forget(10);
    auto image = scene.render(HeadScene::motion(10), 10);
    EXPECT_EQ(tracker.advance(scene.view(image)).num_views, views_at_ten);
    tracker.forget(100);  // the first one stays, and the shape is as it was given
    EXPECT_LT((tracker.shape().half_axes - given).norm(), 1e-4);
    image = scene.render(HeadScene::motion(2), 2);
    estimate = tracker.advance(scene.view(image), HeadScene::motion(1));
    EXPECT_FALSE(estimate.held);
    EXPECT_LT(degrees_between(estimate.camera_from_head, HeadScene::motion(2)), 1.5);
}

TEST(HeadTracker, GoesBackToAFrame) {
    const HeadScene scene(true);
    const auto reference = scene.render(HeadScene::motion(0));
    HeadTracker tracker(scene.camera, shape_of(scene, HeadModel::ellipsoid), scene.view(reference),
                        HeadScene::motion(0));
    const HeadEstimate start = tracker.advance(scene.view(reference));
    for (const int frame : {4, 8, 12}) {
        tracker.advance(scene.view(scene.render(HeadScene::motion(frame))));
    }
    tracker.restart(scene.view(reference), start);
    const auto image = scene.render(HeadScene::motion(-4));
    EXPECT_LT(degrees_between(tracker.advance(scene.view(image)).camera_from_head, HeadScene::motion(-4)), 1);
}

TEST(HeadShape, FitsTheEllipsoidThatTheHeadIs) {
    const HeadScene scene(true);
    // The front alone, as a camera sees it
    Quads front(0, 4);
    for (Eigen::Index f = 0; f < scene.faces.rows(); ++f) {
        if (scene.vertices(scene.faces(f, 0), 2) > .02) {
            front.conservativeResize(front.rows() + 1, 4);
            front.row(front.rows() - 1) = scene.faces.row(f);
        }
    }
    const HeadShape shape = make_head_shape(HeadModel::ellipsoid, scene.vertices, front);
    EXPECT_LT((shape.half_axes - scene.half_axes).norm(), 1e-6);
    EXPECT_LT(shape.centre.norm(), 1e-6);
}

TEST(HeadTracker, SaysWhatIsWrongWithItsInput) {
    const HeadScene scene(true);
    const auto image = scene.render(HeadScene::pose(0, 0, 0));
    HeadShape shape = shape_of(scene, HeadModel::ellipsoid);
    const auto make = [&](const HeadShape& head, const Eigen::Isometry3d& pose, HeadOptions options = {}) {
        return HeadTracker(scene.camera, head, scene.view(image), pose, options);
    };
    EXPECT_THROW(make(shape, HeadScene::pose(0, 0, 0, 3)), InvalidInput);
    EXPECT_THROW(make(shape, HeadScene::pose(0, 0, 0, 0, 0, -.7)), InvalidInput);
    EXPECT_THROW(make(shape, HeadScene::pose(0, 0, 0), {.crop_height = 3}), InvalidInput);
    shape.half_axes.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make(shape, HeadScene::pose(0, 0, 0)), InvalidInput);
    EXPECT_THROW(make_head_shape(HeadModel::ellipsoid, scene.vertices, scene.faces.topRows(1)), InvalidInput);
    EXPECT_THROW(make_head_shape(HeadModel::surface, scene.vertices, Quads(0, 4)), InvalidInput);
    HeadTracker tracker = make(shape_of(scene, HeadModel::plane), HeadScene::pose(0, 0, 0));
    EXPECT_THROW(tracker.advance({image.data(), 120, 320, 960}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
