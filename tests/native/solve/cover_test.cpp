// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/cover.hpp"

#include <gtest/gtest.h>

#include "face_scene.hpp"
#include "feature_scene.hpp"
#include "solve/feature_evidence.hpp"

namespace mimetic {
namespace {

using test::FaceScene;
using test::FeatureScene;

constexpr int kSide = OcclusionNetwork::kCells;
using Cells = Eigen::MatrixXf;

/// Sees what the test says, in a square of the height of a picture of 320 x 240 pixels.
class Watched {
public:
    Cells cells = Cells::Zero(kSide, kSide);
    FeatureCrop square{{159.5, 119.5}, 240, 0};

    OcclusionSource source() {
        return [this](const ColorView&, const Eigen::Isometry3d&) { return Occlusion{square, cells}; };
    }
};

/// From a frame before which nothing is.
FaceTracker tracker_of(const FaceScene& scene, Watched& watched) {
    FeatureInputs inputs;
    inputs.occlusion = watched.source();
    const auto reference = scene.render(scene.camera_from_head, scene.rest());
    return {scene.camera, scene.surface, scene.motion, scene.view(reference), scene.camera_from_head, inputs};
}

const Eigen::Vector2d kLeft(100, 119.5), kRight(219, 119.5);  // pixels
const Eigen::Isometry3d kSomewhere = Eigen::Isometry3d::Identity();

TEST(Cover, HidesWhatTheReferenceFrameShowed) {
    Watched watched;
    Cover cover(watched.source(), {}, ColorView{}, kSomewhere);
    EXPECT_FALSE(cover.hides(kRight)) << "nobody has looked yet";
    watched.cells.rightCols(kSide / 2).setConstant(.95F);
    cover.look(ColorView{}, kSomewhere);
    EXPECT_TRUE(cover.hides(kRight));
    EXPECT_FALSE(cover.hides(kLeft));
    EXPECT_TRUE(cover.came(kRight));
    EXPECT_FALSE(cover.was_hidden(kRight));
    Points2 points(4, 2);
    points << 100, 100, 219, 100, 219, 120, 219, 140;
    const auto hides = [&cover](const Eigen::Vector2d& at) { return cover.hides(at); };
    EXPECT_EQ(share_of(points, hides), .75);
    EXPECT_EQ(share_of(Points2(0, 2), hides), 0);
    cover.look_away();
    EXPECT_FALSE(cover.hides(kRight));
}

TEST(Cover, HidesNothingThatWasPerhapsThereBefore) {
    Watched watched;
    watched.cells.rightCols(kSide / 2).setConstant(.8F);
    Cover cover(watched.source(), {}, ColorView{}, kSomewhere);
    watched.cells = Cells::Zero(kSide, kSide);
    watched.cells.rightCols(kSide / 2 + 1).setConstant(.95F);  // it has moved by a cell
    cover.look(ColorView{}, kSomewhere);
    EXPECT_FALSE(cover.hides(kRight));
    EXPECT_FALSE(cover.hides({159.5 - 6, 119.5}));
    watched.cells.setConstant(.95F);
    cover.look(ColorView{}, kSomewhere);
    EXPECT_TRUE(cover.hides(kLeft));
}

TEST(Cover, HidesAPartOnlyWhereItIsSurelyHiddenSomewhere) {
    Watched watched;
    Cover cover(watched.source(), {}, ColorView{}, kSomewhere);
    watched.cells.block(9, 7, 6, 3).setConstant(.6F);   // perhaps, about kLeft
    watched.cells.block(9, 15, 6, 4).setConstant(.3F);  // hardly, about kRight, round what is sure
    cover.look(ColorView{}, kSomewhere);
    EXPECT_FALSE(cover.hides(kLeft) || cover.hides(kRight));
    watched.cells.block(9, 18, 2, 1).setConstant(.95F);
    cover.look(ColorView{}, kSomewhere);
    EXPECT_FALSE(cover.hides(kLeft)) << "another part";
    EXPECT_TRUE(cover.hides(kRight));
}

TEST(Cover, HidesForGoodWhatTheTextureNeverShowed) {
    Watched watched;
    watched.cells.rightCols(kSide / 2).setConstant(.95F);
    Cover cover(watched.source(), {}, ColorView{}, kSomewhere);
    watched.cells.setZero();
    cover.look(ColorView{}, kSomewhere);
    EXPECT_TRUE(cover.hides(kRight) && cover.was_hidden(kRight));
    EXPECT_FALSE(cover.came(kRight) || cover.hides(kLeft));
}

/// A column of the picture from 200 to 240, over all its height.
StillCover column() { return {{200, 0}, 40, StillCover::Cells::Constant(6, 1, true)}; }

TEST(Cover, HidesWhatStandsStillInThePicture) {
    Watched watched;
    Cover cover(watched.source(), column(), ColorView{}, kSomewhere);
    EXPECT_TRUE(cover.hides_any() && cover.stands(kRight) && cover.hides(kRight)) << "before any look";
    watched.square.center.x() -= 100;  // the head moves to the left, with the skin that it hid at first
    cover.look(ColorView{}, kSomewhere);
    EXPECT_TRUE(cover.hides(kRight));
    const Eigen::Vector2d behind = kRight - Eigen::Vector2d(100, 0);
    EXPECT_TRUE(cover.was_hidden(behind) && cover.hides(behind));
    EXPECT_FALSE(cover.came(kRight) || cover.came(behind) || cover.stands(behind));
    EXPECT_FALSE(cover.hides({60, 119.5}));
    cover.dismiss();
    EXPECT_TRUE(cover.hides(kRight)) << "it is no mistake of the network";
}

TEST(Cover, HidesNothingWithoutASource) {
    Cover cover({}, {}, ColorView{}, kSomewhere);
    cover.look(ColorView{}, kSomewhere);
    EXPECT_FALSE(cover.hides(kRight));
}

TEST(Cover, LeavesOutTheOpeningThatItHides) {
    FeatureScene scene;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(FeatureScene::kValues);
    const FaceState rest{scene.camera_from_head, none};
    scene.inputs.source = [&](const ColorView&, const Eigen::Isometry3d&) { return scene.see(none); };
    const TrackedFace face(scene.camera, scene.surface, scene.motion, TrackerOptions{});
    FeatureEvidence evidence(face, scene.inputs, ColorView{}, rest);
    const auto information = [&](const Cover* cover) {
        evidence.look(ColorView{}, rest);
        if (cover != nullptr) {
            evidence.leave_out(*cover);
        }
        return Eigen::VectorXd(evidence.terms(rest).information.diagonal().tail(FeatureScene::kValues));
    };
    const Eigen::VectorXd all = information(nullptr);
    Watched watched;
    watched.square = {{scene.camera.cx, scene.camera.cy}, 480, 0};
    Cover cover(watched.source(), {}, ColorView{}, kSomewhere);
    cover.look(ColorView{}, kSomewhere);
    EXPECT_EQ(information(&cover), all);
    watched.cells.rightCols(kSide / 2).setOnes();  // the subject's left eye
    cover.look(ColorView{}, kSomewhere);
    const Eigen::VectorXd hidden = information(&cover);
    EXPECT_EQ(hidden[FeatureScene::upper_left], 0);
    EXPECT_EQ(hidden[FeatureScene::upper_right], all[FeatureScene::upper_right]);
    EXPECT_GT(all[FeatureScene::upper_left], 0);
}

/// What the network takes for cover looks like the skin that it is said to hide: it is that skin.
TEST(Cover, IsNotBelievedWhereTheFaceIsSeen) {
    const FaceScene scene;
    Watched watched;
    FaceTracker tracker = tracker_of(scene, watched);
    watched.cells.leftCols(kSide / 2).setOnes();
    Eigen::VectorXd values = scene.rest();
    values[2] = .5;
    const auto smile = scene.render(scene.camera_from_head, values, 2, 1, 0, 3);
    const FrameEstimate bare = tracker.advance(scene.view(smile));
    EXPECT_EQ(bare.covered, 0);
    EXPECT_NEAR(bare.values[2], .5, .15);
    auto covered = smile;
    std::mt19937 random(7);
    for (int y = 0; y < scene.camera.height; ++y) {
        for (int x = 0; x < scene.camera.width / 2; ++x) {
            const auto grey = static_cast<std::uint8_t>(90 + random() % 60);
            std::fill_n(covered.begin() + 3 * (y * scene.camera.width + x), 3, grey);
        }
    }
    const FrameEstimate hidden = tracker.advance(scene.view(covered));
    EXPECT_GT(hidden.covered, .3);
    const Eigen::VectorXd wider = hidden.values_std().cwiseQuotient(bare.values_std());
    EXPECT_GT(wider[2], 1.5);
    EXPECT_LT(wider[1], .7 * wider[2]);  // a brow of the other side
}

/// Beside a face that is turned away, where its far cheek would be, is what is behind it.
TEST(Cover, HidesNoSkinThatIsTurnedAway) {
    const FaceScene scene;
    Watched watched;
    FaceTracker tracker = tracker_of(scene, watched);
    FrameEstimate turned;
    for (const double yaw : {.1, .2, .3, .4, .5, .6, .7, .8}) {
        Eigen::Isometry3d pose = scene.camera_from_head;
        pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()));
        double outline = 0;  // pixels from the left, of the far cheek
        for (const Eigen::Vector3d point : scene.motion.neutral.rowwise()) {
            outline = std::max(outline, scene.camera.project(pose * point).x());
        }
        for (int column = 0; column < kSide; ++column) {
            const double middle =
                watched.square.center.x() + watched.square.side * ((column + .5) / kSide - .5);
            watched.cells.col(column).setConstant(middle > outline - 7 ? 1.F : 0.F);
        }
        turned = tracker.advance(scene.view(scene.render(pose, scene.rest(), 2, 1, 0, 3)));
        EXPECT_FALSE(turned.held);
    }
    EXPECT_LT(turned.covered, .05);
}

}  // namespace
}  // namespace mimetic
