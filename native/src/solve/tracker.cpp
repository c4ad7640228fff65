// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/error.hpp>

#include "tracker_state.hpp"

namespace mimetic {

namespace {

constexpr double kErrorSpacing = .02;  // metres between the nodes of the model error field
constexpr double kFoundQuality = .35;  // a lost face counts as found again from here
constexpr double kKeyViewAngle = .26;  // rad from the nearest texture
constexpr double kKeyViewQuality = .6;

/// Well spread points of the measured skin, no two closer than the spacing.
std::vector<Eigen::Vector3f> spread_nodes(const ReferenceView& view) {
    std::vector<Eigen::Vector3f> nodes;
    for (const ReferenceSample& sample : view.samples()) {
        const bool apart = std::all_of(nodes.begin(), nodes.end(), [&](const Eigen::Vector3f& node) {
            return (node - sample.skin.neutral).norm() > kErrorSpacing;
        });
        if (apart) {
            nodes.push_back(sample.skin.neutral);
        }
    }
    return nodes;
}

Eigen::MatrixXd rest_covariance(const FaceMotion& motion) {
    Eigen::VectorXd variance(6 + motion.lower.size());
    variance.head<3>().setConstant(1e-4);
    variance.segment<3>(3).setConstant(1e-5);
    variance.tail(motion.lower.size()) = motion.prior_std.cwiseAbs2();
    return variance.asDiagonal();
}

}  // namespace

FaceTracker::State::State(const Camera& camera_in, const TrackedSurface& surface_in,
                          const FaceMotion& motion_in, const std::vector<EyeSlit>& eyes_in,
                          const TrackerOptions& options_in)
    : camera(camera_in),
      motion(motion_in),
      surface(surface_in, motion_in),
      eyes(eyes_in),
      options(options_in),
      texture_flow(options_in.flow_method) {
    noise.model_error = options.model_error;
    noise.shape_error = options.shape_error;
    relative_dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
    velocity = Eigen::VectorXd::Zero(6 + num_values());
    covariance = rest_covariance(motion);
}

FrameEstimate FaceTracker::State::report(const FrameScore& score, const StepPrior& prior) const {
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
    estimate.model_covariance = Eigen::MatrixXd::Zero(size, size);
    estimate.held = lost;
    if (lost) {
        estimate.covariance = covariance;
        return estimate;
    }
    const Eigen::MatrixXd working =
        (solver->information() + prior.information).llt().solve(Eigen::MatrixXd::Identity(size, size));
    estimate.model_covariance = solver->model_covariance(working);
    estimate.covariance = working + estimate.model_covariance;
    estimate.information = solver->information();
    estimate.gradient = solver->pull() - solver->information() * last_step;
    std::vector<double>& distances = solver->distances_px();
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    estimate.residual_px = *middle;
    return estimate;
}

void FaceTracker::State::add_key_view(const FrameScore& score) {
    ++frames_since_key_view;
    if (static_cast<int>(views.size()) > options.max_key_views || score.quality < kKeyViewQuality ||
        frames_since_key_view < 10) {
        return;
    }
    for (const auto& view : views) {
        if (view_angle(*view) < kKeyViewAngle) {
            return;
        }
    }
    try {
        views.push_back(std::make_unique<ReferenceView>(surface, camera, state.camera_from_head, state.values,
                                                        gray, options.crop_height, options.sample_spacing));
        frames_since_key_view = 0;
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
    s.views.push_back(std::make_unique<ReferenceView>(s.surface, camera, camera_from_head, s.last.values,
                                                      s.last_gray, options.crop_height,
                                                      options.sample_spacing));
    if (s.views.front()->samples().size() < 100) {
        throw InvalidInput(
            "only " + std::to_string(s.views.front()->samples().size()) +
            " samples of the face are in sight of the reference image, 100 are needed: choose a frame "
            "in which the face is larger and turned to the camera");
    }
    s.solver = std::make_unique<JointSolver>(s.motion, spread_nodes(*s.views.front()));
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
        const Eigen::Index all = 6 + s.num_values();
        FrameScore score = s.register_textures(prior, s.options.max_iterations, all);
        const double needed =
            was_lost ? std::max(kFoundQuality, s.options.held_quality) : s.options.held_quality;
        if (score.quality < needed) {
            const FaceState held = s.last;
            score = s.search_again(prior, guess);
            s.lost = score.quality < std::max(kFoundQuality, s.options.held_quality);
            if (s.lost) {
                s.state = held;
            }
        } else {
            s.lost = false;
        }
        {
            const StageClock clock(s.times.solve_ms);
            estimate = s.report(score, prior);
        }
        if (s.lost) {
            s.velocity.setZero();
            estimate.quality = std::min(estimate.quality, .999 * s.options.held_quality);
        } else {
            s.covariance = (s.solver->information() + prior.information)
                               .llt()
                               .solve(Eigen::MatrixXd::Identity(all, all));
            s.velocity =
                was_lost ? Eigen::VectorXd(Eigen::VectorXd::Zero(all)) : s.state.difference_from(s.last);
            s.add_key_view(score);
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
    s.covariance = rest_covariance(s.motion);
    s.lost = false;
}

}  // namespace mimetic
