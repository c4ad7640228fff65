// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/head/head.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

#include "tracker_state.hpp"

namespace mimetic {

using head::KeyView;
using head::SampleView;

namespace {

constexpr double kAnchorAngle = 0.6;    // rad up to which the first reference texture is registered too
constexpr double kAnchorShare = 0.5;    // its weight beside the nearest one's
constexpr double kReferenceStd = 2e-3;  // rad and metres of the first pose: it defines the head frame
constexpr double kTooVague = 0.12;      // rad: s.d. of a pose that no reference texture is taken at
constexpr double kNearer = 0.3;         // share of the distance after which a texture is taken anew
constexpr std::size_t kCloseViews = 6;  // taken at half the angle

double rotation_std(const Matrix6& covariance) {
    return std::sqrt(std::max(0., covariance.diagonal().head<3>().maxCoeff()));
}

}  // namespace

/// Moves the estimate to the pose that its texture gets among the others.
void HeadTracker::State::take_view(const cv::Mat1b& gray, HeadEstimate& estimate) {
    const auto part = crop_at(estimate.camera_from_head);
    const auto portrait = portrait_crop_at(estimate.camera_from_head);
    if (part && portrait) {
        graph.add(head::cut(gray, camera, *part), estimate.camera_from_head, estimate.covariance);
        portrait_crops.push_back(head::cut(gray, camera, *portrait));
        taken_in.push_back(num_frames);
        relax(false);
        estimate.camera_from_head = views().back().camera_from_head();
    }
}

bool HeadTracker::State::relax(bool anew) {
    const bool has_moved = graph.relax(anew);
    forget_places();
    return has_moved;
}

const SampleView& HeadTracker::State::samples_of(const KeyView& view) const {
    std::optional<SampleView>& samples = sampled[static_cast<std::size_t>(&view - views().data())];
    if (!samples) {
        samples.emplace(shape(), options, head::make_pyramid(view.crop()), view.camera_from_head());
    }
    return *samples;
}

const KeyView& HeadTracker::State::portrait_of(const KeyView& view) {
    const auto at = static_cast<std::size_t>(&view - views().data());
    std::optional<KeyView>& portrait = portraits[at];
    if (!portrait) {
        portrait.emplace(shape(), options, portrait_crops[at], view.camera_from_head(), view.covariance());
    }
    return *portrait;
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

/// The nearest reference texture, and the first one, whose pose alone is given: a texture taken at a wrong
/// pose must not confirm itself.
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

bool HeadTracker::State::wants_view(const HeadEstimate& estimate) const {
    // A head that looks up or down is explained less well; samples alone need a sure start.
    const double good = options.fast ? .9 : .7;
    if (options.max_key_views == 0 || static_cast<int>(views().size()) >= options.max_key_views ||
        estimate.held || (look && !recognition.may_be_reference(*look)) || estimate.quality < good ||
        rotation_std(estimate.covariance) > kTooVague) {
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
        !head::crop_camera(shape, camera, camera_from_head, options.crop_height, kHeadMargin)) {
        throw InvalidInput(
            "the head is out of the reference frame or smaller than 43 pixels there: choose another frame");
    }
    state_ = std::make_unique<State>(camera, shape, options);
    state_->before = state_->gray_frame(image);
    state_->last.camera_from_head = camera_from_head;
    state_->last.covariance = kReferenceStd * kReferenceStd * Matrix6::Identity();
    state_->last.quality = state_->last.explained = state_->last.correlation = state_->last.likeness = 1;
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
    // A guess means that the caller is in doubt: after a cut another head may be where this one was.
    state.recognition.begin_frame(state.last.held || guess);
    state.look.reset();
    HeadEstimate found = state.estimate(gray, guess);
    found.found_again = !found.held && state.recognition.has_trial_begun();
    const bool may_ask = !state.options.fast || state.num_frames - state.refused >= kFlowEvery;
    if (may_ask && state.wants_view(found)) {
        if (state.options.fast) {
            // A reference texture's pose must come from the more accurate method: errors of samples
            // accumulate.
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

void HeadTracker::forget(int num_last) {
    State& state = *state_;
    state.recognition.forget(num_last);
    const auto kept =
        static_cast<std::size_t>(std::count_if(state.taken_in.begin(), state.taken_in.end(), [&](long frame) {
            return frame <= state.num_frames - num_last;
        }));
    // The first one is given, whenever that was
    if (const std::size_t count = std::max<std::size_t>(1, kept); count < state.views().size()) {
        state.graph.keep(count);
        state.portrait_crops.resize(count);
        state.taken_in.resize(count);
        state.forget_places();
    }
}

bool HeadTracker::relax() { return state_->relax(true); }

std::vector<PlacedView> HeadTracker::place_on(const HeadShape& skin) {
    skin.check();
    return state_->graph.place_on(skin);
}

void HeadTracker::move_views(const std::vector<Eigen::Isometry3d>& poses) {
    state_->graph.move_views(poses);
    state_->forget_places();
}

const HeadShape& HeadTracker::shape() const { return state_->shape(); }

void HeadTracker::restart(const ColorView& image, const HeadEstimate& estimate) {
    state_->before = state_->gray_frame(image);
    state_->last = estimate;
    state_->step.setIdentity();
    state_->recognition.end_doubt();
}

}  // namespace mimetic
