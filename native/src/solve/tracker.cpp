// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>

#include "motion_prior.hpp"
#include "shared/gray.hpp"
#include "tracker_state.hpp"

namespace mimetic {

namespace {

constexpr double kFlowWindow = 9.5;    // reference pixels on a side
constexpr float kErrorReach = 3;       // of the model error field's exponent
constexpr double kFoundQuality = .45;  // a lost face counts as found again from here
constexpr double kKeyViewAngle = .26;  // rad from the nearest texture
constexpr double kKeyViewQuality = .6;

ErrorField<float> error_field(const ReferenceView& view) {
    std::vector<Eigen::Vector3f> points;
    for (const ReferenceSample& sample : view.samples()) {
        points.push_back(sample.skin.neutral);
    }
    return ErrorField<float>(points, kErrorReach);
}

Eigen::MatrixXd first_covariance(const Eigen::MatrixXd& rest) {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6 + rest.rows(), 6 + rest.rows());
    covariance.diagonal().head<3>().setConstant(1e-4);
    covariance.diagonal().segment<3>(3).setConstant(1e-5);
    covariance.bottomRightCorner(rest.rows(), rest.rows()) = rest;
    return covariance;
}

}  // namespace

FaceTracker::State::State(const Camera& camera_in, const TrackedSurface& surface_in,
                          const FaceMotion& motion_in, const std::vector<EyeSlit>& eyes_in,
                          const TrackerOptions& options_in)
    : camera(camera_in),
      motion(motion_in),
      to_rest(motion),
      surface(surface_in, motion_in),
      options(options_in),
      detail_solver(motion),
      texture_flow(options_in.flow_method),
      likeness(options_in.crop_height) {
    noise.model.anyway = options.model_error;
    noise.model.shape = options.shape_error;
    noise.samples_a_window = std::max(1., std::pow(kFlowWindow / options.sample_spacing, 2));
    relative_dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
    velocity = Eigen::VectorXd::Zero(6 + num_values());
    rest = rest_covariance(motion);
    // The prediction already tends to rest; more would delay onsets.
    constexpr double kFramesPerState = 12;
    rest_pull = rest.inverse() / kFramesPerState;
    last_std = motion.prior_std;
    covariance = first_covariance(rest);
    for (const EyeSlit& eye : eyes_in) {
        lids.emplace_back(eye);
    }
}

FrameEstimate FaceTracker::State::report(const FrameScore& score, const StepPrior& prior) {
    const Eigen::Index size = 6 + num_values();
    FrameEstimate estimate;
    estimate.camera_from_head = state.camera_from_head;
    estimate.values = state.values;
    estimate.quality = score.quality;
    estimate.num_samples = score.num_samples;
    estimate.num_explained = score.num_explained;
    estimate.correlation = score.correlation;
    estimate.num_views = score.num_views;
    estimate.information = Eigen::MatrixXd::Zero(size, size);
    estimate.gradient = Eigen::VectorXd::Zero(size);
    estimate.held = lost;
    if (lost) {
        estimate.covariance = covariance;
        estimate.detail.coefficients = Eigen::VectorXd::Zero(motion.detail_std.size());
        estimate.detail.std = motion.detail_std;
        return estimate;
    }
    if (motion.detail_std.size() > 0) {
        // Not put back into the next frame's warp: flow that falls short would let its errors grow.
        estimate.detail = detail_solver.solve(*solver, measurements, last_step);
    }
    estimate.covariance =
        (solver->information() + prior.information).llt().solve(Eigen::MatrixXd::Identity(size, size));
    estimate.information = solver->information();
    estimate.gradient = solver->pull() - solver->information() * last_step;
    estimate.residual_px = upper_median(solver->distances_px());
    return estimate;
}

FloatPixels FaceTracker::State::project_control(const FaceState& at) const {
    Points moved = motion.neutral;
    Eigen::Map<Eigen::VectorXd> flat(moved.data(), moved.size());
    flat += motion.modes.transpose() * at.values;
    FloatPixels pixels(moved.rows(), 2);
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        const Eigen::Vector3d point = at.camera_from_head * Eigen::Vector3d(moved.row(i));
        pixels.row(i) = camera.project(point).transpose().cast<float>();
    }
    return pixels;
}

void FaceTracker::State::measure_lids(FrameEstimate& estimate) {
    if (lids.empty()) {
        return;
    }
    FaceState open = state;
    for (const LidMeter& lid : lids) {
        for (const int value : {lid.slit().lid_upper, lid.slit().lid_lower}) {
            if (value >= 0) {
                open.values[value] = 0;
            }
        }
    }
    const FloatPixels pixels = project_control(open);
    for (const LidMeter& lid : lids) {
        const LidMeasurement measured = lid.measure(gray, pixels);
        if (!measured.seen) {
            continue;
        }
        const int value = lid.slit().lid_upper;
        const Eigen::Index row = 6 + value;
        // A blink takes three frames: what was says little.
        constexpr double kJump = .4;
        const double variance = measured.std * measured.std;
        const double share = kJump * kJump / (kJump * kJump + variance);
        const double before = last.values[value];
        const double wanted = std::clamp(before + share * (measured.closure - before), motion.lower[value],
                                         motion.upper[value]);
        state.values[value] = estimate.values[value] = wanted;
        estimate.covariance.row(row).setZero();
        estimate.covariance.col(row).setZero();
        estimate.covariance(row, row) = share * variance;
        estimate.information.row(row).setZero();
        estimate.information.col(row).setZero();
        estimate.information(row, row) = 1 / variance;
        estimate.gradient[row] = (measured.closure - wanted) / variance;
    }
}

void FaceTracker::State::add_key_view(const FrameScore& score, const DetailEstimate& detail) {
    ++frames_since_key_view;
    if (static_cast<int>(views.size()) > options.max_key_views || score.quality < kKeyViewQuality ||
        score.likeness < kSurelyAlike || frames_since_key_view < 10) {
        return;
    }
    for (const auto& view : views) {
        if (view_angle(*view) < kKeyViewAngle) {
            return;
        }
    }
    try {
        views.push_back(std::make_unique<ReferenceView>(surface, camera, state, gray, options.crop_height,
                                                        options.sample_spacing,
                                                        flow_blur_px(options.flow_method)));
        frames_since_key_view = 0;
        // Of detail, about half is motion; the rest is shape that looks otherwise from elsewhere.
        constexpr double kMoved = .5;
        views.back()->keep_detail(kMoved * detail.coefficients);
    } catch (const InvalidInput&) {
        return;  // too little of the face is in sight for a texture
    }
}

FaceTracker::FaceTracker(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                         const ColorView& image, const Eigen::Isometry3d& camera_from_head,
                         const std::vector<EyeSlit>& eyes, const TrackerOptions& options) {
    options.check();
    check_inputs(camera, surface, motion, eyes);
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
    state_ = std::make_unique<State>(camera, surface, motion, eyes, options);
    State& s = *state_;
    s.last_gray = to_gray(image);
    s.last.camera_from_head = camera_from_head;
    s.last.values = Eigen::VectorXd::Zero(s.num_values());
    s.state = s.predicted = s.last;
    s.views.push_back(std::make_unique<ReferenceView>(s.surface, camera, s.last, s.last_gray,
                                                      options.crop_height, options.sample_spacing,
                                                      flow_blur_px(options.flow_method)));
    if (s.views.front()->samples().size() < 100) {
        throw InvalidInput(
            "only " + std::to_string(s.views.front()->samples().size()) +
            " samples of the face are in sight of the reference image, 100 are needed: choose a frame "
            "in which the face is larger and turned to the camera");
    }
    s.solver = std::make_unique<JointSolver>(s.motion, error_field(*s.views.front()));
    s.relative_solver = std::make_unique<JointSolver>(s.motion, error_field(*s.views.front()));
    for (LidMeter& lid : s.lids) {
        lid.take_reference(s.last_gray, s.project_control(s.last));
    }
    s.search = std::make_unique<FaceSearch>(s.last_gray, *s.views.front());
}

FaceTracker::~FaceTracker() = default;
FaceTracker::FaceTracker(FaceTracker&&) noexcept = default;
FaceTracker& FaceTracker::operator=(FaceTracker&&) noexcept = default;

FrameEstimate FaceTracker::advance(const ColorView& image, const std::optional<Eigen::Isometry3d>& guess) {
    State& s = *state_;
    if (image.rows != s.camera.height || image.cols != s.camera.width) {
        throw InvalidInput("a frame is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " pixels, the reference image was " + std::to_string(s.camera.width) + " x " +
                           std::to_string(s.camera.height));
    }
    s.times = {};
    FrameEstimate estimate;
    {
        const StageClock whole(s.times.total_ms);
        s.gray = to_gray(image);
        const bool was_lost = s.lost;
        StepPrior prior = s.predict();
        if (s.options.relative_flow && !was_lost) {
            const StageClock clock(s.times.predict_ms);
            s.follow_flow(prior);
        }
        s.frame.update(s.gray, 1 / s.face_pixels_per_crop_pixel());
        // Who gives a guess is in doubt: after a cut another face may be where this one was.
        s.trial.next_frame();
        if (was_lost || guess) {
            s.trial.start();
        }
        FrameScore score = s.register_face(prior, s.trial.least_likeness());
        const double found = std::max(kFoundQuality, s.options.held_quality);
        if (was_lost || score.quality < s.options.held_quality) {
            s.trial.start();  // lost and found in one frame is doubtful too
            // From where the face was last seen, or anywhere: whichever explains more
            const FaceState held = s.last;
            score = s.search_again(prior, score.quality, guess);
            s.lost = score.quality < found;
            if (s.lost) {
                s.state = held;
            }
        }
        {
            const StageClock clock(s.times.solve_ms);
            estimate = s.report(score, prior);
        }
        if (s.lost) {
            s.velocity.setZero();
            estimate.quality = std::min(estimate.quality, .999 * s.options.held_quality);
        } else {
            s.measure_lids(estimate);
            s.covariance = estimate.covariance;
            s.last_std = estimate.values_std();
            s.velocity = s.state.difference_from(s.last);
            if (was_lost) {
                s.velocity.setZero();
            }
            s.add_key_view(score, estimate.detail);
            estimate.found_again = s.trial.has_just_started();
        }
        s.last = s.state;
        std::swap(s.gray, s.last_gray);
    }
    estimate.times = s.times;
    return estimate;
}

void FaceTracker::restart(const ColorView& image, const FrameEstimate& estimate) {
    State& s = *state_;
    if (image.rows != s.camera.height || image.cols != s.camera.width ||
        estimate.values.size() != s.num_values()) {
        throw InvalidInput("restart needs an image of the reference's size and an estimate of this tracker");
    }
    s.last_gray = to_gray(image);
    s.last.camera_from_head = estimate.camera_from_head;
    s.last.values = estimate.values;
    s.state = s.predicted = s.last;
    s.velocity.setZero();
    s.covariance = first_covariance(s.rest);
    s.last_std = s.motion.prior_std;
    s.lost = false;
    s.trial.end();
}

}  // namespace mimetic
