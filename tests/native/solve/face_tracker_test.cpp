// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>

#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::degrees_between;
using test::FaceScene;

const FaceScene& scene() {
    static const FaceScene made;
    return made;
}

/// A run of frames with its truth.
struct Clip {
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Eigen::VectorXd> values;
};

double ramp(int frame, int start, int end) {
    return std::clamp(static_cast<double>(frame - start) / (end - start), 0., 1.);
}

/// Two brows rise, a smile follows, the jaw drops; the head nods and turns meanwhile.
Clip expressive_clip(int num_frames) {
    Clip clip;
    for (int t = 0; t < num_frames; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[0] = .8 * ramp(t, 4, 12) * (1 - ramp(t, 24, 32));
        values[1] = .6 * ramp(t, 4, 12) * (1 - ramp(t, 24, 32));
        values[2] = .7 * ramp(t, 14, 22);
        values[3] = .7 * ramp(t, 14, 22);
        values[5] = .9 * ramp(t, 26, 34);
        Eigen::Isometry3d pose = scene().camera_from_head;
        pose.linear() = (Eigen::AngleAxisd(.12 * std::sin(.2 * t), Eigen::Vector3d::UnitX()) *
                         Eigen::AngleAxisd(.2 * std::sin(.13 * t), Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(.05 * std::sin(.1 * t), Eigen::Vector3d::UnitZ()))
                            .toRotationMatrix() *
                        pose.linear();
        pose.translation() +=
            Eigen::Vector3d(.01 * std::sin(.15 * t), .008 * std::sin(.1 * t), .03 * std::sin(.07 * t));
        clip.poses.push_back(pose);
        clip.values.push_back(values);
    }
    return clip;
}

FaceTracker make_tracker(const TrackerOptions& options = {}) {
    const auto image = scene().render(scene().camera_from_head, scene().rest());
    return {
        scene().camera, scene().surface, scene().motion, scene().view(image), scene().camera_from_head, {},
        options};
}

using Image = std::vector<std::uint8_t>;

FrameEstimate advance(FaceTracker& tracker, const Image& image) {
    return tracker.advance(scene().view(image));
}

/// Grey noise over the columns [first, last) of an image.
void cover(Image& image, int first, int last, unsigned seed) {
    std::mt19937 random(seed);
    for (int y = 0; y < scene().camera.height; ++y) {
        for (int x = first; x < last; ++x) {
            const auto grey = static_cast<std::uint8_t>(90 + random() % 60);
            std::fill_n(image.begin() + 3 * (y * scene().camera.width + x), 3, grey);
        }
    }
}

/// Median distance in pixels of where the skin was seen from where it is.
double median_miss(const SkinObservations& seen, const Eigen::Isometry3d& pose,
                   const Eigen::VectorXd& values) {
    Points moved = scene().motion.neutral;
    Eigen::Map<Eigen::VectorXd>(moved.data(), moved.size()) += scene().motion.modes.transpose() * values;
    const Points refined = scene().surface.stencils * moved;
    std::vector<double> misses;
    for (Eigen::Index k = 0; k < seen.pixels.rows(); ++k) {
        if (seen.information(k, 0) + seen.information(k, 3) > 0) {
            Eigen::Vector3d point = Eigen::Vector3d::Zero();
            for (int corner = 0; corner < 3; ++corner) {
                point += seen.barycentric(k, corner) * refined.row(seen.vertices(k, corner)).transpose();
            }
            const Eigen::Vector2d found = seen.pixels.row(k);
            misses.push_back((scene().camera.project(pose * point) - found).norm());
        }
    }
    std::sort(misses.begin(), misses.end());
    return misses.size() < 100 ? 1e9 : misses[misses.size() / 2];
}

/// A ring of a centimetre and a half in the head frame, before the skin that the third value moves.
Points ring() {
    Points curve(73, 3);
    for (int k = 0; k < 73; ++k) {
        const double angle = k * M_PI / 36;
        curve.row(k) << -.03 + .015 * std::cos(angle), -.05 + .015 * std::sin(angle), .078;
    }
    return curve;
}

/// Paints the ring, four millimetres wide and nearly black, on a head at a pose.
void wear_ring(Image& image, const Eigen::Isometry3d& pose) {
    const Camera& camera = scene().camera;
    const Points curve = ring();
    for (Eigen::Index k = 0; k + 1 < curve.rows(); ++k) {
        for (const double share : {0., .25, .5, .75}) {
            const Eigen::Vector3d point =
                pose * Eigen::Vector3d((1 - share) * curve.row(k) + share * curve.row(k + 1));
            const Eigen::Vector2d at = camera.project(point);
            const double radius = .002 * camera.fx / point.z();
            const auto first_y = static_cast<int>(at.y() - radius),
                       first_x = static_cast<int>(at.x() - radius);
            for (int y = first_y; y <= at.y() + radius; ++y) {
                for (int x = first_x; x <= at.x() + radius; ++x) {
                    if (std::hypot(x - at.x(), y - at.y()) < radius) {
                        std::fill_n(image.begin() + 3 * (y * camera.width + x), 3, std::uint8_t{20});
                    }
                }
            }
        }
    }
}

/// How far off the value behind the ring is, on the mean over a smile.
double error_behind_ring(const std::vector<Points>& rims) {
    Image first = scene().render(scene().camera_from_head, scene().rest());
    wear_ring(first, scene().camera_from_head);
    TrackedSurface surface = scene().surface;
    surface.rims = rims;
    FaceTracker tracker(scene().camera, surface, scene().motion, scene().view(first),
                        scene().camera_from_head);
    double sum = 0;
    constexpr int kFrames = 16;
    for (int t = 1; t <= kFrames; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[2] = .8 * ramp(t, 2, 10);
        Image image = scene().render(scene().camera_from_head, values, 2, 1, 0, static_cast<unsigned>(t));
        wear_ring(image, scene().camera_from_head);
        const FrameEstimate estimate = advance(tracker, image);
        EXPECT_FALSE(estimate.held);
        sum += std::abs(estimate.values[2] - values[2]) / kFrames;
    }
    return sum;
}

TEST(FaceTracker, LooksPastTheRimsOfGlasses) {
    const double followed = error_behind_ring({}), passed_by = error_behind_ring({ring()});
    EXPECT_LT(passed_by, .07);
    EXPECT_GT(followed, 2 * passed_by);
}

TEST(FaceTracker, RecoversPoseAndValuesThroughExpressionsAndHeadMotion) {
    const Clip clip = expressive_clip(40);
    FaceTracker tracker = make_tracker();
    std::vector<FrameEstimate> estimates;
    double worst_turn = 0;
    for (std::size_t t = 1; t < clip.poses.size(); ++t) {
        estimates.push_back(advance(
            tracker, scene().render(clip.poses[t], clip.values[t], 2, 1, 0, static_cast<unsigned>(t + 7))));
        const Eigen::VectorXd error = (estimates.back().values - clip.values[t]).head(6);
        worst_turn = std::max(worst_turn, degrees_between(estimates.back().camera_from_head, clip.poses[t]));
        EXPECT_GT(estimates.back().quality, .6) << "frame " << t;
        EXPECT_LT(error.cwiseAbs().maxCoeff(), .16) << "frame " << t;
        EXPECT_LT(median_miss(tracker.observations(), clip.poses[t], clip.values[t]), .4) << "frame " << t;
    }
    EXPECT_LT(worst_turn, .5);
    double sum = 0;
    const std::vector<FrameEstimate> smoothed = smooth(estimates, scene().motion);
    for (std::size_t t = 1; t < clip.poses.size(); ++t) {
        sum += (smoothed[t - 1].values - clip.values[t]).head(6).squaredNorm();
        EXPECT_LT(degrees_between(smoothed[t - 1].camera_from_head, clip.poses[t]), .45) << "frame " << t;
    }
    EXPECT_LT(std::sqrt(sum / (6. * static_cast<double>(estimates.size()))), .05);
}

TEST(FaceTracker, KeepsAStillFaceStillUnderNoise) {
    FaceTracker tracker = make_tracker();
    for (unsigned t = 0; t < 15; ++t) {
        const FrameEstimate estimate =
            advance(tracker, scene().render(scene().camera_from_head, scene().rest(), 5, 1, 0, 50 + t));
        EXPECT_LT(estimate.values.cwiseAbs().maxCoeff(), .05) << "frame " << t;
        EXPECT_LT(degrees_between(estimate.camera_from_head, scene().camera_from_head), .2);
    }
}

TEST(FaceTracker, DoesNotTakeLightForMotion) {
    FaceTracker tracker = make_tracker();
    for (int t = 1; t <= 8; ++t) {
        const FrameEstimate estimate = advance(
            tracker, scene().render(scene().camera_from_head, scene().rest(), 2, 1 - .05 * t, 3. * t, 3));
        EXPECT_LT(estimate.values.cwiseAbs().maxCoeff(), .05) << "frame " << t;
        EXPECT_GT(estimate.quality, .8);
    }
}

TEST(FaceTracker, FollowsAFaceInLittleLight) {
    constexpr double kLight = .06, kNoise = .7;
    const Clip clip = expressive_clip(16);
    const Image first = scene().render(scene().camera_from_head, scene().rest(), kNoise, kLight, 0, 5);
    FaceTracker tracker(scene().camera, scene().surface, scene().motion, scene().view(first),
                        scene().camera_from_head);
    for (std::size_t t = 1; t < clip.poses.size(); ++t) {
        const FrameEstimate estimate = advance(
            tracker,
            scene().render(clip.poses[t], clip.values[t], kNoise, kLight, 0, static_cast<unsigned>(t + 7)));
        EXPECT_FALSE(estimate.held) << "frame " << t;
        EXPECT_LT(degrees_between(estimate.camera_from_head, clip.poses[t]), 1.5) << "frame " << t;
        EXPECT_LT((estimate.values - clip.values[t]).head(6).cwiseAbs().maxCoeff(), .35) << "frame " << t;
    }
}

TEST(FaceTracker, DrivesValuesByWhatMovesAndKeepsThemWithinBounds) {
    FaceTracker tracker = make_tracker();
    FrameEstimate estimate;
    for (int t = 1; t <= 8; ++t) {
        Eigen::VectorXd beyond = scene().rest();
        beyond[0] = .2 * t;
        beyond[2] = -.1 * t;
        estimate = advance(tracker, scene().render(scene().camera_from_head, beyond));
        EXPECT_GE((estimate.values - scene().motion.lower).minCoeff(), 0);
        EXPECT_LE((estimate.values - scene().motion.upper).maxCoeff(), 0);
    }
    EXPECT_GT(estimate.values[0], .95);
    EXPECT_LT(estimate.values[2], .05);
}

TEST(FaceTracker, LooksPastABlockThatHidesAThirdOfTheFace) {
    FaceTracker tracker = make_tracker();
    for (int t = 0; t < 6; ++t) {
        Image image = scene().render(scene().camera_from_head, scene().rest());
        cover(image, 90, 140, 5);
        const FrameEstimate estimate = advance(tracker, image);
        EXPECT_FALSE(estimate.held);
        EXPECT_LT(estimate.quality, .9);
        EXPECT_LT(estimate.values.cwiseAbs().maxCoeff(), .1) << "frame " << t;
        EXPECT_LT(degrees_between(estimate.camera_from_head, scene().camera_from_head), .5);
    }
}

TEST(FaceTracker, HoldsAHiddenFaceAndFindsItAgainElsewhere) {
    FaceTracker tracker = make_tracker();
    const Image open = scene().render(scene().camera_from_head, scene().rest());
    const FrameEstimate before = advance(tracker, open);
    FrameEstimate held;
    for (unsigned t = 0; t < 5; ++t) {
        Image image = open;
        cover(image, 0, scene().camera.width, t);
        held = advance(tracker, image);
        EXPECT_TRUE(held.held);
        EXPECT_LT(held.quality, .2);
        EXPECT_EQ(held.values, before.values);
        EXPECT_EQ(tracker.observations().pixels.rows(), 0);
    }
    EXPECT_GT(held.pose_cov().trace(), 10 * before.pose_cov().trace());
    Eigen::Isometry3d moved = scene().camera_from_head;
    moved.translation() += Eigen::Vector3d(.05, -.02, .05);
    FrameEstimate found;
    for (unsigned t = 0; t < 3; ++t) {
        found = advance(tracker, scene().render(moved, scene().rest(), 2, 1, 0, 80 + t));
    }
    EXPECT_FALSE(found.held);
    EXPECT_GT(found.quality, .6);
    EXPECT_LT((found.camera_from_head.translation() - moved.translation()).norm(), .004);
}

TEST(FaceTracker, HoldsAHiddenFaceThatIsGuessedBehindOrAtTheCamera) {
    FaceTracker tracker = make_tracker();
    Image image = scene().render(scene().camera_from_head, scene().rest());
    cover(image, 0, scene().camera.width, 1);
    for (const double depth : {-.65, 0., 1e-4}) {
        Eigen::Isometry3d guess = scene().camera_from_head;
        guess.translation().z() = depth;
        const FrameEstimate estimate = tracker.advance(scene().view(image), guess);
        EXPECT_TRUE(estimate.held) << depth << " m";
    }
}

TEST(FaceTracker, HoldsWhereAnotherFaceStandsAndGoesOnWhenThisOneIsBack) {
    FaceTracker tracker = make_tracker();
    const Image own = scene().render(scene().camera_from_head, scene().rest());
    const FrameEstimate before = advance(tracker, own);
    FaceScene other;
    other.person = .3;
    for (unsigned t = 0; t < 4; ++t) {
        const FrameEstimate estimate =
            advance(tracker, other.render(scene().camera_from_head, scene().rest(), 2, 1, 0, t));
        EXPECT_TRUE(estimate.held) << "frame " << t;
        EXPECT_EQ(estimate.values, before.values);
    }
    EXPECT_FALSE(advance(tracker, own).held);
}

TEST(FaceTracker, TellsAFaceThatWasLostAndFoundInOneFrame) {
    FaceTracker tracker = make_tracker();
    const Image here = scene().render(scene().camera_from_head, scene().rest());
    EXPECT_FALSE(advance(tracker, here).found_again);
    Eigen::Isometry3d elsewhere = scene().camera_from_head;
    elsewhere.translation() += Eigen::Vector3d(.08, -.02, .05);
    const Image there = scene().render(elsewhere, scene().rest());
    const FrameEstimate found = advance(tracker, there);
    EXPECT_FALSE(found.held);
    EXPECT_TRUE(found.found_again);
    EXPECT_LT((found.camera_from_head.translation() - elsewhere.translation()).norm(), .004);
    EXPECT_FALSE(advance(tracker, there).found_again);
    // After a cut a detector's guess is no proof either.
    EXPECT_TRUE(tracker.advance(scene().view(there), elsewhere).found_again);
}

TEST(FaceTracker, DoesNotTakeAHeadThatGoesAwayForOneThatIsBehindItself) {
    for (const bool relative_flow : {true, false}) {
        TrackerOptions options;
        options.relative_flow = relative_flow;
        FaceTracker tracker = make_tracker(options);
        advance(tracker, scene().render(scene().camera_from_head, scene().rest()));
        Eigen::Isometry3d away = scene().camera_from_head;
        away.translation().z() += .025;
        const FrameEstimate found = advance(tracker, scene().render(away, scene().rest()));
        EXPECT_FALSE(found.held);
        EXPECT_FALSE(found.found_again);
        EXPECT_GT(found.quality, .8);
        EXPECT_NEAR(found.camera_from_head.translation().z(), away.translation().z(), .005);
    }
}

TEST(FaceTracker, AsksMoreOfAFaceThatWasLostAndFoundInOneFrame) {
    Eigen::Isometry3d elsewhere = scene().camera_from_head;
    elsewhere.translation() += Eigen::Vector3d(.08, -.02, .05);
    const Image there = scene().render(elsewhere, scene().rest());
    FaceTracker tracker = make_tracker();
    const FrameEstimate found = advance(tracker, there);
    Image covered = there;
    cover(covered, 224, scene().camera.width, 3);
    EXPECT_TRUE(advance(tracker, covered).held);
    // So much in sight is enough where the face is known to be there.
    tracker.restart(scene().view(there), found);
    EXPECT_FALSE(advance(tracker, covered).held);
}

TEST(FaceTracker, IsHeldOrRightWhileABarCrosses) {
    FaceTracker tracker = make_tracker();
    const Clip clip = expressive_clip(26);
    int num_held = 0;
    for (int t = 1; t < 26; ++t) {
        const auto at = static_cast<std::size_t>(t);
        Image image = scene().render(clip.poses[at], clip.values[at], 2, 1, 0, static_cast<unsigned>(t + 3));
        const int left = 20 + 10 * t;
        cover(image, std::max(0, left - 110), left, 5);
        const FrameEstimate estimate = advance(tracker, image);
        num_held += estimate.held ? 1 : 0;
        if (!estimate.held) {
            EXPECT_LT(degrees_between(estimate.camera_from_head, clip.poses[at]), 10) << "frame " << t;
        }
    }
    EXPECT_GT(num_held, 0);
    EXPECT_LT(num_held, 20);
    EXPECT_FALSE(advance(tracker, scene().render(clip.poses[25], clip.values[25])).held);
}

TEST(FaceTracker, SaysWhatIsWrongWithItsInput) {
    const Image image = scene().render(scene().camera_from_head, scene().rest());
    const auto make = [&](const FaceScene& from, const Eigen::Isometry3d& pose) {
        return FaceTracker(from.camera, from.surface, from.motion, scene().view(image), pose);
    };
    FaceScene wrong;
    wrong.motion.modes(0, 0) = std::nan("");
    EXPECT_THROW(make(wrong, scene().camera_from_head), InvalidInput);
    wrong = FaceScene();
    wrong.motion.lower[0] = .5;
    EXPECT_THROW(make(wrong, scene().camera_from_head), InvalidInput);
    wrong = FaceScene();
    wrong.surface.quads(0, 0) = 1 << 20;
    EXPECT_THROW(make(wrong, scene().camera_from_head), InvalidInput);
    wrong = FaceScene();
    wrong.surface.weights.setZero();
    EXPECT_THROW(make(wrong, scene().camera_from_head), InvalidInput);
    Eigen::Isometry3d behind = scene().camera_from_head;
    behind.translation().z() = -1;
    EXPECT_THROW(make(scene(), behind), InvalidInput);
    TrackerOptions options;
    options.crop_height = 10;
    EXPECT_THROW(make_tracker(options), InvalidInput);
    FaceTracker tracker = make_tracker();
    EXPECT_THROW(tracker.advance({image.data(), 100, 100, 300}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
