// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/feature_evidence.hpp"

#include <gtest/gtest.h>

#include "face_scene.hpp"
#include "feature_scene.hpp"

namespace mimetic {
namespace {

using test::FaceScene;
using test::FeatureScene;

/// A face whose source shows what the test puts into `seen`.
struct Watched {
    FeatureScene scene;
    std::vector<SeenOpening> seen;
    std::unique_ptr<TrackedFace> face;
    std::unique_ptr<FeatureEvidence> evidence;

    explicit Watched(std::vector<SeenOpening> at_rest) : seen(std::move(at_rest)) {
        scene.inputs.source = [this](const ColorView&, const Eigen::Isometry3d&) { return seen; };
        face = std::make_unique<TrackedFace>(scene.camera, scene.surface, scene.motion, TrackerOptions{});
        evidence = std::make_unique<FeatureEvidence>(*face, scene.inputs, ColorView{}, rest());
    }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

    FaceState rest() const { return {scene.camera_from_head, none()}; }
    static Eigen::VectorXd none() { return Eigen::VectorXd::Zero(FeatureScene::kValues); }

    /// The state and the covariance of its values that what is seen now makes most probable.
    std::pair<FaceState, Eigen::MatrixXd> estimate() {
        evidence->look(ColorView{}, evidence->reference());
        FaceState state = evidence->with_lids(evidence->reference());
        Eigen::MatrixXd covariance;
        for (int step = 0; step < 4; ++step) {
            const StepPrior terms = evidence->terms(state);
            Eigen::MatrixXd information = terms.information.bottomRightCorner<5, 5>();
            const Eigen::VectorXd prior = scene.motion.prior_std.cwiseAbs2().cwiseInverse();
            information += prior.asDiagonal();
            covariance = information.inverse();
            state.values += covariance * (terms.gradient.tail<5>() - prior.cwiseProduct(state.values));
            state.keep_within(scene.motion);
        }
        return {state, covariance};
    }
};

std::vector<SeenOpening> at_rest() { return FeatureScene().see(Watched::none()); }

TEST(FeatureEvidence, ReadsAWinkInOneEyeAlone) {
    Watched watched(at_rest());
    Eigen::VectorXd wink = Watched::none();
    wink[FeatureScene::upper_left] = 1;
    watched.seen = watched.scene.see(wink);
    const FaceState state = watched.estimate().first;
    EXPECT_GT(state.values[FeatureScene::upper_left], .93);
    EXPECT_LT(std::abs(state.values[FeatureScene::upper_right]), .05);
    EXPECT_LT(std::abs(state.values[FeatureScene::lower_right]), .05);
}

TEST(FeatureEvidence, ReadsEyesThatOpenFurtherThanAtRest) {
    Watched watched(at_rest());
    Eigen::VectorXd wide = Watched::none();
    wide[FeatureScene::upper_left] = wide[FeatureScene::upper_right] = -.5;
    watched.seen = watched.scene.see(wide);
    const FaceState state = watched.estimate().first;
    EXPECT_NEAR(state.values[FeatureScene::upper_left], -.5, .1);
    EXPECT_NEAR(state.values[FeatureScene::upper_right], -.5, .1);
}

TEST(FeatureEvidence, KnowsSleepyEyesInTheReferenceFrameForHalfClosed) {
    Eigen::VectorXd sleepy = Watched::none();
    sleepy[FeatureScene::upper_left] = sleepy[FeatureScene::upper_right] = .5;
    Watched watched(FeatureScene().see(sleepy));
    EXPECT_NEAR(watched.evidence->reference().values[FeatureScene::upper_left], .5, .12);
    watched.seen = at_rest();  // wide awake
    EXPECT_NEAR(watched.estimate().first.values[FeatureScene::upper_left], 0, .15);
    Eigen::VectorXd shut = Watched::none();
    shut[FeatureScene::upper_left] = shut[FeatureScene::upper_right] = 1;
    watched.seen = watched.scene.see(shut);
    EXPECT_GT(watched.estimate().first.values[FeatureScene::upper_left], .85);
}

TEST(FeatureEvidence, LearnsThePersonsOffsetInTheReferenceFrame) {
    constexpr double kHigher = .002;  // metres: the fit put both margins of the eyes so much too low
    Watched watched(FeatureScene().see(Watched::none(), kHigher, kHigher));
    EXPECT_NEAR(watched.evidence->reference().values[FeatureScene::upper_left], 0, .05);
    EXPECT_NEAR(watched.evidence->reference().values[FeatureScene::brow], 0, 1e-12);
    for (const double closure : {0., .5, 1.}) {
        Eigen::VectorXd values = Watched::none();
        values[FeatureScene::upper_left] = closure;
        watched.seen = watched.scene.see(values, kHigher, kHigher);
        EXPECT_NEAR(watched.estimate().first.values[FeatureScene::upper_left], closure, .08) << closure;
    }
}

TEST(FeatureEvidence, HasWideBarsForAnEyeThatIsTurnedAwayOrNotSeen) {
    Watched watched(at_rest());
    const Eigen::MatrixXd open = watched.estimate().second;
    watched.seen[1].lines.clear();
    const Eigen::MatrixXd hidden = watched.estimate().second;
    const int right = FeatureScene::upper_right, left = FeatureScene::upper_left;
    EXPECT_NEAR(hidden(left, left), open(left, left), .2 * open(left, left));
    EXPECT_GT(std::sqrt(hidden(right, right)), .9 * watched.scene.motion.prior_std[right]);

    watched.scene.camera_from_head.linear() =
        watched.scene.camera_from_head.linear() *
        Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
    const std::vector<SeenOpening> turned = watched.scene.see(Watched::none());
    watched.seen = turned;
    watched.evidence->look(ColorView{}, watched.rest());
    const StepPrior terms = watched.evidence->terms(watched.rest());
    EXPECT_LT(terms.information(FaceStep::kPose + left, FaceStep::kPose + left), .1 / open(left, left));
}

TEST(FeatureEvidence, IsLessSureOfWhatItsSourceDoubts) {
    Watched watched(at_rest());
    const double sure =
        std::sqrt(watched.estimate().second(FeatureScene::upper_right, FeatureScene::upper_right));
    watched.seen[1].doubt = 3;
    const double doubted =
        std::sqrt(watched.estimate().second(FeatureScene::upper_right, FeatureScene::upper_right));
    EXPECT_GT(doubted, 1.4 * sure);
}

TEST(FeatureEvidence, DoesNotBelieveLinesThatNoEyeCanHave) {
    Watched watched(at_rest());
    for (SeenOpening& opening : watched.seen) {
        opening.lines[0].col(1).array() += 40;  // half an eye's width below the lower margin: a hand
        opening.lines[1].col(1).array() -= 40;
    }
    watched.evidence->look(ColorView{}, watched.rest());
    EXPECT_EQ(watched.evidence->terms(watched.rest()).information.norm(), 0);
    EXPECT_EQ(watched.evidence->with_lids(watched.rest()).values, watched.rest().values);
}

TEST(FeatureEvidence, SaysNothingOfThePose) {
    Watched watched(at_rest());
    for (SeenOpening& opening : watched.seen) {
        for (Points2& line : opening.lines) {
            line.col(1).array() -= 6;  // both eyes are seen higher
        }
    }
    watched.evidence->look(ColorView{}, watched.rest());
    const StepPrior terms = watched.evidence->terms(watched.rest());
    EXPECT_EQ(terms.gradient.head<6>().norm(), 0);
    EXPECT_EQ(terms.information.topRows<6>().norm(), 0);
}

/// A mouth of four lines, of which the fitted head's inner ones stand 2 mm apart at rest; values: what shuts
/// it (down with the upper, up with the lower inner line, 4 mm each), and a jaw that takes the lower lip
/// down.
struct Mouth {
    static constexpr int kPoints = 9;
    FeatureScene scene;  // for its camera

    Mouth() {
        FeatureOpening mouth;
        mouth.shutting = {0};
        scene.motion = {};
        scene.motion.neutral.resize(4 * kPoints, 3);
        scene.motion.modes.setZero(2, 3 * scene.motion.neutral.rows());
        for (int line = 0; line < 4; ++line) {
            std::vector<int>& vertices = mouth.lines.emplace_back();
            for (int i = 0; i < kPoints; ++i) {
                const int vertex = line * kPoints + i;
                const double along = 2. * i / (kPoints - 1) - 1, arch = 1 - along * along;
                const double height = std::array{.008, .001, -.001, -.009}[static_cast<std::size_t>(line)];
                scene.motion.neutral.row(vertex) << .025 * along, height * arch, 0;
                scene.motion.modes(0, 3 * vertex + 1) = (line == 1 ? -.004 : line == 2 ? .004 : 0) * arch;
                scene.motion.modes(1, 3 * vertex + 1) = (line > 1 ? -.02 : 0) * arch;
                vertices.push_back(vertex);
            }
        }
        scene.surface.quads.resize(kPoints - 1, 4);
        for (int i = 0; i + 1 < kPoints; ++i) {
            scene.surface.quads.row(i) << i, i + kPoints, i + kPoints + 1, i + 1;
        }
        scene.surface.stencils.resize(4 * kPoints, 4 * kPoints);
        scene.surface.stencils.setIdentity();
        scene.surface.weights = Eigen::VectorXd::Ones(4 * kPoints);
        scene.motion.lower = Eigen::VectorXd::Zero(2);
        scene.motion.upper = Eigen::VectorXd::Ones(2);
        scene.motion.prior_std = Eigen::VectorXd::Constant(2, .3);
        scene.inputs.openings = {mouth};
    }
};

TEST(FeatureEvidence, ShutsLipsThatTouchInTheReferenceFrame) {
    Mouth mouth;
    const std::vector<SeenOpening> touching = mouth.scene.see(Eigen::Vector2d(.25, 0));
    mouth.scene.inputs.source = [&](const ColorView&, const Eigen::Isometry3d&) { return touching; };
    const TrackedFace face(mouth.scene.camera, mouth.scene.surface, mouth.scene.motion, TrackerOptions{});
    const FaceState rest{mouth.scene.camera_from_head, Eigen::VectorXd::Zero(2)};
    const FeatureEvidence evidence(face, mouth.scene.inputs, ColorView{}, rest);
    EXPECT_NEAR(evidence.reference().values[0], .25, .06);  // not the person's offset
    EXPECT_EQ(evidence.reference().values[1], 0);           // the jaw is at rest
}

TEST(FeatureEvidence, SeesACornerOfTheMouthThatRisesAlone) {
    Mouth mouth;
    FaceMotion& motion = mouth.scene.motion;
    motion.modes.row(0).setZero();  // a smile on one side
    for (int line = 0; line < 4; ++line) {
        motion.modes(0, 3 * line * Mouth::kPoints + 1) = .008;
    }
    std::vector<SeenOpening> seen = mouth.scene.see(Eigen::Vector2d::Zero());
    mouth.scene.inputs.source = [&](const ColorView&, const Eigen::Isometry3d&) { return seen; };
    const TrackedFace face(mouth.scene.camera, mouth.scene.surface, motion, TrackerOptions{});
    const FaceState rest{mouth.scene.camera_from_head, Eigen::VectorXd::Zero(2)};
    FeatureEvidence evidence(face, mouth.scene.inputs, ColorView{}, rest);
    seen = mouth.scene.see(Eigen::Vector2d(.5, 0));
    evidence.look(ColorView{}, rest);
    const StepPrior terms = evidence.terms(rest);
    EXPECT_NEAR(terms.gradient[6] / terms.information(6, 6), .5, .05);
    constexpr double kByValue = .008 / .063;
    EXPECT_LT(kByValue / std::sqrt(terms.information(6, 6)), .03);
}

/// Standard deviation of the slit's width by the lines alone, when lips are at `values`, in pupil distances.
double slit_std(const Eigen::Vector2d& values, int jaw = -1) {
    Mouth mouth;
    mouth.scene.inputs.openings[0].jaw = jaw;
    std::vector<SeenOpening> seen = mouth.scene.see(Eigen::Vector2d(.25, 0));
    mouth.scene.inputs.source = [&](const ColorView&, const Eigen::Isometry3d&) { return seen; };
    const TrackedFace face(mouth.scene.camera, mouth.scene.surface, mouth.scene.motion, TrackerOptions{});
    const FaceState rest{mouth.scene.camera_from_head, Eigen::VectorXd::Zero(2)};
    FeatureEvidence evidence(face, mouth.scene.inputs, ColorView{}, rest);
    seen = mouth.scene.see(values);
    const FaceState state{mouth.scene.camera_from_head, values};
    evidence.look(ColorView{}, state);
    constexpr double kByShutting = .008 / .063;
    return kByShutting / std::sqrt(evidence.terms(state).information(6, 6));
}

TEST(FeatureEvidence, KnowsASlitThatIsShutFarBetterThanAnOpenOne) {
    EXPECT_LT(slit_std({.25, 0}), .006);  // else flow lets lips pass through each other
    EXPECT_GT(slit_std({.25, .5}), .015);
}

TEST(FeatureEvidence, ReadsLipsLessSurelyByAsMuchAsAJawPartsThem) {
    EXPECT_EQ(slit_std({.25, 0}, 1), slit_std({.25, 0}));  // shut lips are seen to touch on any person
    EXPECT_GT(slit_std({.25, .5}, 1), 1.15 * slit_std({.25, .5}));
}

TEST(FeatureEvidence, ShutsByDetailLipsThatTouchAndTheValuesLeaveApart) {
    Mouth mouth;
    mouth.scene.motion.detail_modes = mouth.scene.motion.modes.topRows(1);  // as what shuts it
    mouth.scene.motion.detail_std = Eigen::VectorXd::Ones(1);
    const std::vector<SeenOpening> touching = mouth.scene.see(Eigen::Vector2d(.25, 0));
    mouth.scene.inputs.source = [&](const ColorView&, const Eigen::Isometry3d&) { return touching; };
    const TrackedFace face(mouth.scene.camera, mouth.scene.surface, mouth.scene.motion, TrackerOptions{});
    FaceState state{mouth.scene.camera_from_head, Eigen::VectorXd::Zero(2)};
    FeatureEvidence evidence(face, mouth.scene.inputs, ColorView{}, state);
    const DetailTerms unseen = [&] {
        evidence.look_away();
        return evidence.detail_terms(state);
    }();
    EXPECT_EQ(unseen.information.norm(), 0);
    evidence.look(ColorView{}, state);
    const DetailTerms apart = evidence.detail_terms(state);
    EXPECT_NEAR(apart.pull[0] / apart.information(0, 0), .25, .06);
    const Eigen::Vector2d step(.25, 0);  // once the values shut them nothing is left
    EXPECT_NEAR((apart.pull[0] - apart.coupling.rightCols(2).row(0).dot(step)) / apart.information(0, 0), 0,
                .06);
    EXPECT_EQ(apart.coupling.leftCols(FaceStep::kPose).norm(), 0);
    constexpr double kByDetail = .008 / .063;
    EXPECT_LT(kByDetail / std::sqrt(apart.information(0, 0)), .006);
}

TEST(FaceTracker, KeepsItsPoseWhenLinesAtTheMouthMoveTogether) {
    const FaceScene scene;
    FeatureInputs inputs;
    FeatureOpening& mouth = inputs.openings.emplace_back();
    for (const int row : {24, 26}) {
        std::vector<int>& line = mouth.lines.emplace_back();
        for (int column = 9; column <= 19; ++column) {
            line.push_back(row * (FaceScene::kAcross + 1) + column);
        }
    }
    double lower = 0;  // pixels
    inputs.source = [&](const ColorView&, const Eigen::Isometry3d& pose) {
        SeenOpening seen;
        for (const std::vector<int>& line : mouth.lines) {
            Points2& pixels = seen.lines.emplace_back(static_cast<Eigen::Index>(line.size()), 2);
            for (std::size_t i = 0; i < line.size(); ++i) {
                const Eigen::Vector3d point = scene.motion.neutral.row(line[i]);
                pixels.row(static_cast<Eigen::Index>(i)) =
                    (scene.camera.project(pose * point) + Eigen::Vector2d(0, lower)).transpose();
            }
        }
        return std::vector{seen};
    };
    const auto image = scene.render(scene.camera_from_head, scene.rest());
    FaceTracker tracker(scene.camera, scene.surface, scene.motion, scene.view(image), scene.camera_from_head,
                        inputs);
    for (int frame = 1; frame < 5; ++frame) {
        lower = frame;
        const auto next = scene.render(scene.camera_from_head, scene.rest(), 2, 1, 0, 9 + frame);
        const FrameEstimate estimate = tracker.advance(scene.view(next));
        EXPECT_LT(test::degrees_between(estimate.camera_from_head, scene.camera_from_head), .1);
    }
}

}  // namespace
}  // namespace mimetic
