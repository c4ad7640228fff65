// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/head/head.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

#include "registration.hpp"
#include "view_graph.hpp"

namespace mimetic {

using head::HeadCrop;
using head::KeyView;
using head::PointMeasurement;
using head::Pyramid;
using head::Registration;
using head::RigidMotion;
using head::SampleView;
using head::ViewGraph;
using head::ViewShares;

namespace {

constexpr double kMargin = 0.25;        // of the head's box: how far it may move from frame to frame
constexpr double kAnchorAngle = 0.6;    // rad up to which the first reference texture is compared too
constexpr double kAnchorShare = 0.5;    // its weight beside the nearest one's
constexpr double kStill = 0.3;          // pixels: a stabilised frame that needs no further round
constexpr double kReferenceStd = 2e-3;  // rad and metres of the first pose: it defines the head frame
constexpr double kFoundQuality = .45;   // from which a head counts as found again, or as the one after a cut
constexpr double kTooVague = 0.12;      // rad: s.d. of a pose that no reference texture is taken at
constexpr double kNearer = 0.3;         // share of the distance after which a texture is taken anew
constexpr double kMostNearing = .03;    // of the distance, a frame on the fast path: samples are lost
constexpr std::size_t kNearViews = 5;   // from which a doubtful frame is tried anew
constexpr std::size_t kCloseViews = 6;  // taken at half the angle
constexpr long kFlowEvery = 6;          // frames on the fast path: samples alone let the distance run away

/// Share of the distance by which a head came nearer or went away.
double nearing(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
    return std::abs(to.translation().norm() / from.translation().norm() - 1);
}

double rotation_std(const Matrix6& covariance) {
    return std::sqrt(std::max(0., covariance.diagonal().head<3>().maxCoeff()));
}

}  // namespace

struct HeadTracker::State {
    Camera camera;
    HeadOptions options;
    ViewGraph graph;
    cv::Mat1b before;  // the last frame
    HeadEstimate last;
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();  // of the head in its own frame, frame to frame
    // Of each view, on the fast path, once it is wanted: relaxing moves all of them
    mutable std::vector<std::optional<SampleView>> sampled;
    long num_frames = 0;
    long refused = -kFlowEvery;  // frame in which flow did not confirm a texture

    State(const Camera& of, const HeadShape& start, const HeadOptions& given)
        : camera(of), options(given), graph(start, given) {}
    const HeadShape& shape() const { return graph.shape(); }
    const std::vector<KeyView>& views() const { return graph.views(); }
    cv::Mat1b gray_frame(const ColorView& image) const { return head::gray_frame(image, camera); }
    std::optional<Camera> crop_at(const Eigen::Isometry3d& pose) const {
        return head::crop_camera(shape(), camera, pose, options.crop_height, kMargin);
    }
    void take_view(const cv::Mat1b& gray, HeadEstimate& estimate);
    bool relax(bool anew);
    void forget_samples() {
        sampled.clear();
        sampled.resize(views().size());
    }
    const SampleView& samples_of(const KeyView& view) const;
    std::vector<std::pair<double, const KeyView*>> views_by_angle(const Eigen::Isometry3d& pose) const;
    std::vector<std::pair<double, const KeyView*>> views_for(const Eigen::Isometry3d& pose) const;
    std::optional<HeadEstimate> follow_flow(const cv::Mat1b& gray) const;
    std::optional<HeadEstimate> register_frame(const cv::Mat1b& gray, const Eigen::Isometry3d& start) const;
    std::optional<HeadEstimate> register_samples(const cv::Mat1b& gray) const;
    std::optional<Eigen::Isometry3d> recall(const cv::Mat1b& gray,
                                            const std::optional<Eigen::Isometry3d>& guess,
                                            std::size_t num_views) const;
    HeadEstimate estimate(const cv::Mat1b& gray, const std::optional<Eigen::Isometry3d>& guess) const;
    bool wants_view(const HeadEstimate& estimate) const;
};

/// The estimate goes where its texture comes to stand among the others.
void HeadTracker::State::take_view(const cv::Mat1b& gray, HeadEstimate& estimate) {
    if (const auto part = crop_at(estimate.camera_from_head)) {
        graph.add(head::cut(gray, camera, *part), estimate.camera_from_head, estimate.covariance);
        relax(false);
        estimate.camera_from_head = views().back().camera_from_head();
    }
}

bool HeadTracker::State::relax(bool anew) {
    const bool has_moved = graph.relax(anew);
    forget_samples();
    return has_moved;
}

const SampleView& HeadTracker::State::samples_of(const KeyView& view) const {
    std::optional<SampleView>& samples = sampled[static_cast<std::size_t>(&view - views().data())];
    if (!samples) {
        samples.emplace(shape(), options, head::make_pyramid(view.crop()), view.camera_from_head());
    }
    return *samples;
}

/// Each with its angle from a pose, rad; the nearest first.
std::vector<std::pair<double, const KeyView*>> HeadTracker::State::views_by_angle(
    const Eigen::Isometry3d& pose) const {
    std::vector<std::pair<double, const KeyView*>> order;
    for (const KeyView& view : views()) {
        order.emplace_back(angle_between(view.camera_from_head(), pose), &view);
    }
    std::sort(order.begin(), order.end());
    return order;
}

/// The nearest reference texture, and the first one, which alone is where it was said to be: a texture taken
/// at a wrong pose must not confirm itself.
std::vector<std::pair<double, const KeyView*>> HeadTracker::State::views_for(
    const Eigen::Isometry3d& pose) const {
    const auto order = views_by_angle(pose);
    std::vector<std::pair<double, const KeyView*>> chosen{{1, order.front().second}};
    const double turn = angle_between(views().front().camera_from_head(), pose);
    if (order.front().second != &views().front() && turn < kAnchorAngle) {
        chosen.emplace_back(kAnchorShare, &views().front());
    }
    return chosen;
}

std::optional<HeadEstimate> HeadTracker::State::follow_flow(const cv::Mat1b& gray) const {
    const auto part = crop_at(last.camera_from_head);
    if (!part) {
        return {};
    }
    const auto measurements = head::measure_flow(shape(), options, head::cut(before, camera, *part),
                                                 head::cut(gray, camera, *part), last.camera_from_head);
    if (measurements.size() < 12) {
        return {};
    }
    const RigidMotion motion = head::explain_motion(*part, last.camera_from_head, measurements);
    HeadEstimate found;
    found.camera_from_head = motion.camera_from_head;
    found.covariance = last.covariance + motion.covariance;
    found.quality = found.explained = motion.explained;
    found.num_samples = static_cast<int>(measurements.size());
    found.residual_px = motion.residual_px / (part->fy / camera.fy);
    return found;
}

std::optional<HeadEstimate> HeadTracker::State::register_frame(const cv::Mat1b& gray,
                                                               const Eigen::Isometry3d& start) const {
    HeadEstimate found;
    found.camera_from_head = start;
    for (int round = 0; round < options.max_iterations; ++round) {
        const auto part = crop_at(found.camera_from_head);
        if (!part) {
            return {};
        }
        const HeadCrop now = head::cut(gray, camera, *part);
        std::vector<PointMeasurement> measurements;
        Matrix6 of_views = Matrix6::Zero();
        double shares = 0, correlation = 0;
        for (const auto& [share, view] : views_for(found.camera_from_head)) {
            const auto stabilised = view->stabilise(now, found.camera_from_head);
            view->measure(shape(), options, stabilised, share, measurements);
            of_views += share * view->covariance();
            correlation += share * stabilised.correlation * std::min(1., 2 * stabilised.in_sight);
            shares += share;
        }
        if (measurements.size() < 12) {
            return {};
        }
        for (PointMeasurement& m : measurements) {
            m.weight /= shares;
        }
        const RigidMotion motion = head::explain_motion(*part, found.camera_from_head, measurements);
        const Eigen::Vector3d middle = found.camera_from_head * shape().centre;
        const double moved = angle_between(found.camera_from_head, motion.camera_from_head) * .1 +
                             (motion.camera_from_head * shape().centre - middle).norm();
        found.camera_from_head = motion.camera_from_head;
        found.covariance = motion.covariance + of_views / shares;
        found.correlation = correlation / shares;
        found.explained = motion.explained;
        found.num_samples = static_cast<int>(measurements.size());
        found.residual_px = motion.residual_px / (part->fy / camera.fy);
        if (moved * part->fy / middle.z() < kStill) {
            break;
        }
    }
    constexpr double kChance = .15, kSure = .6;  // correlations of a wrong and of a good registration
    found.quality =
        std::clamp((found.correlation - kChance) / (kSure - kChance), 0., 1.) * std::sqrt(found.explained);
    return found;
}

/// The fast path; nothing where it leaves doubt. The better one of two guesses, no motion and steady motion,
/// as the coarsest level tells, is refined.
std::optional<HeadEstimate> HeadTracker::State::register_samples(const cv::Mat1b& gray) const {
    const auto part = crop_at(last.camera_from_head);
    if (!part) {
        return {};
    }
    const Pyramid now = head::make_pyramid(head::cut(gray, camera, *part));
    const auto samples_for = [this](const Eigen::Isometry3d& pose, Matrix6& covariance) {
        ViewShares samples;
        double shares = 0;
        for (const auto& [share, view] : views_for(pose)) {
            samples.emplace_back(share, &samples_of(*view));
            covariance += share * view->covariance();
            shares += share;
        }
        covariance /= shares;
        return samples;
    };
    Registration best;
    best.correlation = -1;
    for (const Eigen::Isometry3d& start : {last.camera_from_head, last.camera_from_head * step}) {
        Matrix6 unused = Matrix6::Zero();
        const Registration coarse = head::register_coarsely(samples_for(start, unused), now, start, options);
        if (coarse.correlation > best.correlation) {
            best = coarse;
        }
    }
    HeadEstimate found;
    const ViewShares samples = samples_for(best.camera_from_head, found.covariance);
    const Registration registered = head::register_views(samples, now, best.camera_from_head, options);
    constexpr double kSureCorrelation = .95, kSureExplained = .95, kMostPassed = .8;
    if (registered.correlation < kSureCorrelation || registered.explained < kSureExplained ||
        registered.in_sight < kMostPassed ||
        nearing(last.camera_from_head, registered.camera_from_head) > kMostNearing) {
        return {};
    }
    found.camera_from_head = registered.camera_from_head;
    found.covariance += registered.covariance;
    found.correlation = registered.correlation;
    found.explained = registered.explained;
    found.num_samples = registered.num_samples;
    found.residual_px = registered.residual_px / (part->fy / camera.fy);
    found.quality = std::sqrt(found.explained);
    return found;
}

/// Where a lost head may be: a guess, the last pose, or one of the `num_views` nearest references.
std::optional<Eigen::Isometry3d> HeadTracker::State::recall(const cv::Mat1b& gray,
                                                            const std::optional<Eigen::Isometry3d>& guess,
                                                            std::size_t num_views) const {
    std::vector<Eigen::Isometry3d> candidates{last.camera_from_head};
    if (guess) {
        candidates.push_back(*guess);
    }
    const auto order = views_by_angle(last.camera_from_head);
    for (std::size_t k = 0; k < std::min(num_views, order.size()); ++k) {
        candidates.push_back(order[k].second->camera_from_head());
    }
    double best = -1;
    std::optional<Eigen::Isometry3d> chosen;
    for (const Eigen::Isometry3d& candidate : candidates) {
        const auto found = register_frame(gray, candidate);
        if (found && found->quality > best) {
            best = found->quality;
            chosen = found->camera_from_head;
        }
    }
    return chosen;
}

HeadEstimate HeadTracker::State::estimate(const cv::Mat1b& gray,
                                          const std::optional<Eigen::Isometry3d>& guess) const {
    std::optional<HeadEstimate> found;
    if (views().empty()) {
        found = follow_flow(gray);
    } else if (last.held || guess) {
        const auto start = recall(gray, guess, views().size());
        found = start ? register_frame(gray, *start) : std::nullopt;
    } else if (options.fast) {
        found = register_samples(gray);
        if (found && num_frames % kFlowEvery == 0) {
            found = register_frame(gray, found->camera_from_head);
        }
    }
    if (!found && !views().empty() && !last.held && !guess) {
        const auto predicted = follow_flow(gray);
        found = register_frame(gray, predicted ? predicted->camera_from_head : last.camera_from_head);
        constexpr double kDoubtful = .6;
        if (!found || found->quality < kDoubtful) {  // large steps: flow may have gone elsewhere
            const auto start = recall(gray, last.camera_from_head * step, kNearViews);
            const auto other = start ? register_frame(gray, *start) : std::nullopt;
            found = other && (!found || other->quality > found->quality) ? other : found;
        }
    }
    // Other faces' eyes and mouths correlate somewhat, as walls never do: one that is found must be this one.
    const bool is_doubtful = !views().empty() && (last.held || guess);
    const double least = is_doubtful ? std::max(kFoundQuality, options.held_quality) : options.held_quality;
    if (found && found->quality >= least && found->camera_from_head.matrix().allFinite()) {
        return *found;
    }
    HeadEstimate held = last;
    held.held = true;
    held.quality = found ? std::min(found->quality, .99 * options.held_quality) : 0;
    held.correlation = found ? found->correlation : 0;
    held.num_samples = 0;
    // Nobody knows where a head that is not seen goes: it may turn and move a little every frame.
    held.covariance.diagonal().head<3>().array() += 1e-3;
    held.covariance.diagonal().tail<3>().array() += 1e-4;
    return held;
}

bool HeadTracker::State::wants_view(const HeadEstimate& estimate) const {
    // A head that looks up or down is explained less well; samples alone need a sure start.
    const double good = options.fast ? .9 : .7;
    if (options.max_key_views == 0 || static_cast<int>(views().size()) >= options.max_key_views ||
        estimate.held || estimate.quality < good || rotation_std(estimate.covariance) > kTooVague) {
        return false;
    }
    // The first ones stand close: the shape is not known yet, and wrong shapes do not register far.
    const double apart = (views().size() < kCloseViews ? .5 : 1) * options.key_view_angle;
    return std::none_of(views().begin(), views().end(), [&](const KeyView& view) {
        const double nearer =
            estimate.camera_from_head.translation().norm() / view.camera_from_head().translation().norm();
        return angle_between(view.camera_from_head(), estimate.camera_from_head) < apart &&
               std::abs(nearer - 1) < kNearer;
    });
}

HeadTracker::HeadTracker(const Camera& camera, const HeadShape& shape, const ColorView& image,
                         const Eigen::Isometry3d& camera_from_head, const HeadOptions& options) {
    camera.check();
    shape.check();
    options.check();
    if (!camera_from_head.matrix().allFinite() ||
        !head::crop_camera(shape, camera, camera_from_head, options.crop_height, kMargin)) {
        throw InvalidInput(
            "the head is out of the reference frame or smaller than 43 pixels there: choose another frame");
    }
    state_ = std::make_unique<State>(camera, shape, options);
    state_->before = state_->gray_frame(image);
    state_->last.camera_from_head = camera_from_head;
    state_->last.covariance = kReferenceStd * kReferenceStd * Matrix6::Identity();
    state_->last.quality = state_->last.explained = state_->last.correlation = 1;
    if (options.max_key_views > 0) {
        state_->take_view(state_->before, state_->last);
    }
}

HeadTracker::~HeadTracker() = default;
HeadTracker::HeadTracker(HeadTracker&&) noexcept = default;
HeadTracker& HeadTracker::operator=(HeadTracker&&) noexcept = default;

HeadEstimate HeadTracker::advance(const ColorView& image, const std::optional<Eigen::Isometry3d>& guess) {
    State& state = *state_;
    const cv::Mat1b gray = state.gray_frame(image);
    ++state.num_frames;
    HeadEstimate found = state.estimate(gray, guess);
    const bool may_ask = !state.options.fast || state.num_frames - state.refused >= kFlowEvery;
    if (may_ask && state.wants_view(found)) {
        if (state.options.fast) {
            // A reference texture must stand where the surer way says: errors of samples would add up.
            found = state.register_frame(gray, found.camera_from_head).value_or(found);
        }
        if (state.wants_view(found)) {
            state.take_view(gray, found);
        } else {
            state.refused = state.num_frames;
        }
    }
    found.num_views = static_cast<int>(state.views().size());
    state.before = gray;
    state.step = found.held ? Eigen::Isometry3d::Identity()
                            : state.last.camera_from_head.inverse() * found.camera_from_head;
    state.last = found;
    return found;
}

bool HeadTracker::relax() { return state_->relax(true); }

std::vector<PlacedView> HeadTracker::place_on(const HeadShape& skin) {
    skin.check();
    return state_->graph.place_on(skin);
}

void HeadTracker::move_views(const std::vector<Eigen::Isometry3d>& poses) {
    state_->graph.move_views(poses);
    state_->forget_samples();
}

const HeadShape& HeadTracker::shape() const { return state_->shape(); }

void HeadTracker::restart(const ColorView& image, const HeadEstimate& estimate) {
    state_->before = state_->gray_frame(image);
    state_->last = estimate;
    state_->step.setIdentity();
}

}  // namespace mimetic
