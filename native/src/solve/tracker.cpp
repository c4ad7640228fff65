// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/locate/well_lit.hpp>
#include <mimetic/shared/error.hpp>

#include "shared/gray.hpp"
#include "tracker_state.hpp"

namespace mimetic {

namespace {

constexpr float kErrorReach = 3;       // of the model error field's exponent
constexpr double kFoundQuality = .45;  // a lost face counts as found again from here
constexpr double kKeyViewQuality = .6;
constexpr double kMostCovered = .02;  // of a face whose texture is taken
// Of a value's usual deviation: what is hidden may do anything that a face does which talks, not one at rest
constexpr double kHiddenStd = 1.5;
constexpr double kMostAlike = .5;  // share of what is hidden that may look like the skin behind it
constexpr std::size_t kFewestSamples = 100;
// The square about a face in which its light is looked at: of the mean head, as `feature_crops` places it
constexpr double kFaceSide = .25;                   // metres
const Eigen::Vector3d kFaceMiddle(0, -.0014, .08);  // head frame, metres

/// Grey values of a frame in which the face is near a pose; of a badly lit face those of a picture in which
/// it is well lit, since what is known of noise, and of how textures look alike, is in grey levels.
cv::Mat1b gray_of(const Camera& camera, const ColorView& image, const Eigen::Isometry3d& camera_from_head) {
    std::optional<ColorImage> lit;
    try {
        lit = well_lit(image, crop_round(camera, camera_from_head, kFaceMiddle, kFaceSide));
    } catch (const InvalidInput&) {  // a head that is not before the camera
    }
    return to_gray(lit ? lit->view() : image);
}

ErrorField<float> error_field(const ReferenceView& view) {
    std::vector<Eigen::Vector3f> points;
    for (const ReferenceSample& sample : view.samples()) {
        points.push_back(sample.skin.neutral);
    }
    return ErrorField<float>(points, kErrorReach);
}

ReferenceViews first_views(const TrackedFace& face, const FaceState& state, const cv::Mat1b& gray) {
    ReferenceViews views(face, state, gray);
    if (views.first().samples().size() < kFewestSamples) {
        throw InvalidInput(
            "only " + std::to_string(views.first().samples().size()) +
            " samples of the face are in sight of the reference image, 100 are needed: choose a frame "
            "in which the face is larger and turned to the camera");
    }
    return views;
}

FrameEstimate to_estimate(const FaceState& state, const FrameScore& score) {
    FrameEstimate estimate;
    estimate.camera_from_head = state.camera_from_head;
    estimate.values = state.values;
    estimate.quality = score.quality;
    estimate.num_samples = score.num_samples;
    estimate.num_explained = score.num_explained;
    estimate.correlation = score.correlation;
    estimate.num_views = score.num_views;
    return estimate;
}

}  // namespace

FaceTracker::State::State(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                          const FeatureInputs& inputs, const TrackerOptions& options, const ColorView& image,
                          const cv::Mat1b& gray, const Eigen::Isometry3d& camera_from_head)
    : face(camera, surface, motion, options),
      cover(inputs.occlusion, inputs.still_cover, image, camera_from_head),
      features(face, inputs, image, {camera_from_head, Eigen::VectorXd::Zero(face.num_values())}),
      memory(first_memory(face, gray, features.reference())),
      views(first_views(face, memory.state, gray)),
      follower(face, cover, error_field(views.first())),
      registrar(face, views, error_field(views.first()), features, cover),
      search(gray, views.first()),
      detail_solver(face.motion) {}

void FaceTracker::State::check_frame(const ColorView& image) const {
    if (image.rows != face.camera.height || image.cols != face.camera.width) {
        throw InvalidInput("a frame is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " pixels, the reference image was " + std::to_string(face.camera.width) + " x " +
                           std::to_string(face.camera.height));
    }
}

/// Predict, follow the flow, register, judge, search if the face is lost, report, remember.
FrameEstimate FaceTracker::State::follow(FrameAtHand& frame, const std::optional<Eigen::Isometry3d>& guess) {
    const double held_quality = face.options.held_quality;
    const Expectation expected = predict(face, memory);
    const FaceState start = start_of(expected, frame);
    // A guess means that the caller is in doubt: after a cut another face may be where this one was.
    Recognition recognition = memory.recognition;
    recognition.begin_frame(memory.is_lost || guess);
    Registration found = registrar.register_face(expected, start, frame, recognition);
    bool is_lost = false;
    if (memory.is_lost || found.score.quality < held_quality) {
        recognition.begin_trial();  // lost and found in one frame is doubtful too
        found = search_again(expected, found, frame, guess, recognition);
        is_lost = found.score.quality < std::max(kFoundQuality, held_quality);
    }
    FrameEstimate estimate;
    {
        const StageClock clock(frame.times.solve_ms);
        estimate = is_lost ? held_estimate(expected, found.score) : measured_estimate(expected, found);
    }
    TrackMemory now = memory;
    now.gray = frame.gray;
    now.covariance = expected.covariance;
    now.velocity = FaceStep::none(face.num_values());
    now.is_lost = is_lost;
    Hidden hidden;
    if (!is_lost) {
        hidden = hidden_by_cover(found.state, found.measured.projected);
        estimate.covered = hidden.came;
        estimate.irises = features.irises();
        estimate.found_again = recognition.has_trial_begun();
        now.state = {estimate.camera_from_head, estimate.values};
        now.covariance = estimate.covariance;
        now.values_std = estimate.values_std();
        if (!memory.is_lost) {
            now.velocity = now.state.difference_from(memory.state);
        }
        recognition.learn(found.score.look);
        const bool may_be_view = found.score.quality >= kKeyViewQuality && hidden.at_all < kMostCovered &&
                                 recognition.may_be_reference(found.score.look);
        views.offer(face, now.state, frame.gray, may_be_view, estimate.detail.coefficients);
    }
    now.recognition = std::move(recognition);
    if (!is_lost) {
        learn_depth(expected, found, now.depth_errors);
    }
    memory = std::move(now);
    last_measured = std::move(found.measured);
    if (!is_lost) {
        // Not remembered: what is expected of the next frame knows already how long nothing was seen
        const Eigen::ArrayXd unseen = kHiddenStd * hidden.of_values * face.motion.prior_std.array();
        estimate.covariance.diagonal().tail(face.num_values()).array() += unseen.square();
    }
    return estimate;
}

/// How much is hidden of the face that is turned to the camera, and of what the values move. Beside a face
/// that is turned away, where its far cheek would be, nothing is hidden.
FaceTracker::State::Hidden FaceTracker::State::hidden_by_cover(const FaceState& state,
                                                               const ProjectedSurface& projected) const {
    Hidden hidden{0, 0, Eigen::ArrayXd::Zero(face.num_values())};
    if (!cover.hides_any()) {
        return hidden;
    }
    Eigen::ArrayXd moved = Eigen::ArrayXd::Constant(face.num_values(), 1e-12);
    double measured = 0;
    const Triangles& triangles = face.surface.triangles();
    const Eigen::Vector3f eye = eye_in_head(state);
    for (const ReferenceSample& sample : views.first().samples()) {
        const Eigen::Vector2d pixel = place_of(sample, triangles, projected).cast<double>();
        const double seen = sample.weight * turned_to_camera(sample, triangles, projected, eye);
        const Eigen::ArrayXd energy =
            seen * sample.skin.modes.colwise().squaredNorm().transpose().cast<double>().array();
        measured += seen;
        moved += energy;
        const bool has_come = cover.came(pixel);
        hidden.came += has_come ? seen : 0;
        hidden.at_all += has_come || cover.stands(pixel) ? seen : 0;
        if (cover.hides(pixel)) {
            hidden.of_values += energy;
        }
    }
    hidden.came /= std::max(measured, 1e-12);
    hidden.at_all /= std::max(measured, 1e-12);
    hidden.of_values /= moved;
    return hidden;
}

/// What seems to be before the face is not, where the face's own texture is seen.
void FaceTracker::State::look_for_cover(const FaceState& state, FrameAtHand& frame) {
    cover.look(frame.color, state.camera_from_head);
    if (registrar.alike_behind_cover(state, frame) >= kMostAlike) {
        cover.dismiss();
    }
}

/// Where the frame is compared with the textures first.
FaceState FaceTracker::State::start_of(const Expectation& expected, FrameAtHand& frame) {
    FaceState start = expected.mean;
    if (face.options.relative_flow && !memory.is_lost) {
        const StageClock clock(frame.times.predict_ms);
        start = follower.follow(expected, memory, frame.gray, views.first());
    }
    frame.prepared.update(frame.gray, 1 / views.pixels_per_crop_pixel(start.camera_from_head));
    features.look_away();
    if (!memory.is_lost) {
        const StageClock clock(frame.times.features_ms);
        look_for_cover(start, frame);
        features.look(frame.color, start);
        features.leave_out(cover);
        start = features.with_lids(start);
    }
    return start;
}

/// From where the face was last seen, or from a search of the whole frame: whichever fits better.
Registration FaceTracker::State::search_again(const Expectation& expected, const Registration& near,
                                              FrameAtHand& frame,
                                              const std::optional<Eigen::Isometry3d>& guess,
                                              const Recognition& recognition) {
    features.look_away();  // where the face is not, no eyes are
    cover.look_away();
    const auto scale_at = [this](const FaceState& state) {
        return views.pixels_per_crop_pixel(state.camera_from_head);
    };
    std::vector<Eigen::Isometry3d> poses;
    {
        const StageClock clock(frame.times.predict_ms);
        poses = search.find(face.camera, frame.gray, scale_at(near.state) * views.first().scale());
    }
    if (guess) {
        poses.push_back(*guess);
    }
    poses.push_back(memory.state.camera_from_head);  // without the flow, which may have tracked an occluder
    FaceState best = near.state;
    double best_quality = near.score.quality;
    for (const Eigen::Isometry3d& pose : poses) {
        // The last pose gives no information about the present one.
        const FaceState there{pose, Eigen::VectorXd::Zero(face.num_values())};
        frame.prepared.update(frame.gray, 1 / scale_at(there));
        const FaceState start = registrar.register_pose(expected.about(there), there, frame);
        const FaceState mean{start.camera_from_head, there.values};
        const Registration found = registrar.register_face(expected.about(mean), start, frame, recognition);
        if (found.score.quality > best_quality) {
            best_quality = found.score.quality;
            best = found.state;
        }
    }
    // Once more where it fits best: the solver must not be left with another candidate's equations.
    frame.prepared.update(frame.gray, 1 / scale_at(best));
    {
        const StageClock clock(frame.times.features_ms);
        look_for_cover(best, frame);
        features.look(frame.color, best);
        features.leave_out(cover);
        best = features.with_lids(best);
    }
    return registrar.register_face(expected.about(best), best, frame, recognition);
}

FrameEstimate FaceTracker::State::measured_estimate(const Expectation& expected, const Registration& found) {
    const Eigen::Index size = face.num_unknowns();
    const JointSolver& solver = registrar.solver();
    FrameEstimate estimate = to_estimate(found.state, found.score);
    if (face.motion.detail_std.size() > 0) {
        // Not fed back into the next frame's warp: flow underestimates, and the errors would accumulate.
        estimate.detail = detail_solver.solve(solver, found.measured.samples, found.last_step.flat,
                                              features.detail_terms(found.state));
    }
    estimate.covariance =
        (solver.information() + expected.information).llt().solve(Eigen::MatrixXd::Identity(size, size));
    estimate.information = solver.information();
    estimate.gradient = solver.pull() - solver.information() * found.last_step.flat;
    std::vector<double> distances = solver.distances_px();
    estimate.residual_px = upper_median(distances);
    return estimate;
}

/// A value that depth may be taken for is read without its own prior, which knows nothing of depth.
void FaceTracker::State::learn_depth(const Expectation& expected, const Registration& found,
                                     DepthErrors& depth_errors) const {
    const StepPrior& shown = registrar.solver().as_read();
    FaceState before = found.state;
    before.apply(FaceStep(-found.last_step.flat));
    const StepPrior prior = expected.from(before, face);
    for (const ReadingError& error : depth_errors.at(found.state.camera_from_head)) {
        const Eigen::Index at = FaceStep::kPose + error.value;
        Eigen::MatrixXd information = prior.information;
        information.row(at).setZero();
        information.col(at).setZero();
        information += shown.information;
        Eigen::VectorXd pull = prior.gradient;
        pull[at] = 0;
        pull += shown.gradient;
        const Eigen::LLT<Eigen::MatrixXd> factor(information);
        const double step = factor.solve(pull)[at];
        const double variance = factor.solve(Eigen::VectorXd::Unit(pull.size(), at))[at];
        depth_errors.learn(found.state.camera_from_head, error.value, before.values[error.value] + step,
                           variance, face.options.correlation_time);
    }
}

FrameEstimate FaceTracker::State::held_estimate(const Expectation& expected, const FrameScore& score) const {
    const Eigen::Index size = face.num_unknowns();
    FrameEstimate estimate = to_estimate(memory.state, score);
    estimate.held = true;
    estimate.quality = std::min(score.quality, .999 * face.options.held_quality);
    estimate.covariance = expected.covariance;
    estimate.information = Eigen::MatrixXd::Zero(size, size);
    estimate.gradient = Eigen::VectorXd::Zero(size);
    estimate.detail.coefficients = Eigen::VectorXd::Zero(face.motion.detail_std.size());
    estimate.detail.std = face.motion.detail_std;
    return estimate;
}

FaceTracker::FaceTracker(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                         const ColorView& image, const Eigen::Isometry3d& camera_from_head,
                         const FeatureInputs& features, const TrackerOptions& options) {
    options.check();
    check_inputs(camera, surface, motion, features);
    if (image.rows != camera.height || image.cols != camera.width) {
        throw InvalidInput("the reference image is " + std::to_string(image.cols) + " x " +
                           std::to_string(image.rows) + " pixels but the camera's is " +
                           std::to_string(camera.width) + " x " + std::to_string(camera.height));
    }
    if (!camera_from_head.matrix().allFinite() ||
        (camera_from_head.linear().transpose() * camera_from_head.linear() - Eigen::Matrix3d::Identity())
                .norm() > 1e-3) {
        throw InvalidInput("camera_from_head must be a rotation and a translation, finite");
    }
    state_ = std::make_unique<State>(camera, surface, motion, features, options, image,
                                     gray_of(camera, image, camera_from_head), camera_from_head);
}

FaceTracker::~FaceTracker() = default;
FaceTracker::FaceTracker(FaceTracker&&) noexcept = default;
FaceTracker& FaceTracker::operator=(FaceTracker&&) noexcept = default;

FrameEstimate FaceTracker::advance(const ColorView& image, const std::optional<Eigen::Isometry3d>& guess) {
    state_->check_frame(image);
    FrameAtHand frame;
    FrameEstimate estimate;
    {
        const StageClock whole(frame.times.total_ms);
        frame.color = image;
        frame.gray =
            gray_of(state_->face.camera, image, guess.value_or(state_->memory.state.camera_from_head));
        estimate = state_->follow(frame, guess);
    }
    estimate.times = frame.times;
    return estimate;
}

void FaceTracker::restart(const ColorView& image, const FrameEstimate& estimate) {
    State& s = *state_;
    if (image.rows != s.face.camera.height || image.cols != s.face.camera.width ||
        estimate.values.size() != s.face.num_values()) {
        throw InvalidInput("restart needs an image of the reference's size and an estimate of this tracker");
    }
    Recognition recognition = std::move(s.memory.recognition);
    recognition.end_doubt();
    DepthErrors depth_errors = std::move(s.memory.depth_errors);
    s.memory = first_memory(s.face, gray_of(s.face.camera, image, estimate.camera_from_head),
                            {estimate.camera_from_head, estimate.values});
    s.memory.recognition = std::move(recognition);  // it is the same face
    s.memory.depth_errors = std::move(depth_errors);
    s.cover.look(image, estimate.camera_from_head);
}

}  // namespace mimetic
