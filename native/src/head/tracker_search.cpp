// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/shared/rotations.hpp>

#include "tracker_state.hpp"

namespace mimetic {

using head::HeadCrop;
using head::KeyView;
using head::PointMeasurement;
using head::Pyramid;
using head::Registration;
using head::RigidMotion;
using head::ViewShares;

namespace {

constexpr double kStill = 0.3;         // pixels: a stabilised frame that needs no further round
constexpr double kFoundQuality = .45;  // from which a head counts as found again, or as the one after a cut
constexpr double kMostNearing = .03;   // of the distance, a frame on the fast path: samples are lost
constexpr double kMostTurn = .5;  // rad from frame to frame: no head turns faster, one is found elsewhere
/// Share of a texture that is in sight in all but one of a hundred frames: of a head that is mostly out of
/// the picture the strip that is left is alike at many poses.
constexpr double kUsuallyInSight = .7;
constexpr double kUnseenTurn = .03, kUnseenShift = 3e-3;  // rad^2 and m^2 a second, along each axis
constexpr std::size_t kNearViews = 5;                     // from which an uncertain frame is registered again

/// Share of the distance by which a head came nearer or went away.
double nearing(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
    return std::abs(to.translation().norm() / from.translation().norm() - 1);
}

}  // namespace

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

/// The fast path; none where it is uncertain. The better one of two guesses, no motion and steady motion,
/// by the coarsest level, is refined.
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
    found.likeness = found.explained;
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

/// From the frame before on.
std::optional<HeadEstimate> HeadTracker::State::follow(const cv::Mat1b& gray) const {
    if (options.fast) {
        auto sampled_pose = register_samples(gray);
        if (sampled_pose && num_frames % kFlowEvery != 0) {
            return sampled_pose;
        }
        if (sampled_pose) {
            if (auto registered = register_frame(gray, sampled_pose->camera_from_head)) {
                return registered;
            }
        }
    }
    const auto predicted = follow_flow(gray);
    auto near = register_frame(gray, predicted ? predicted->camera_from_head : last.camera_from_head);
    constexpr double kDoubtful = .6;
    if (near && near->quality >= kDoubtful) {
        return near;
    }
    // Large steps: flow may have converged elsewhere
    const auto start = recall(gray, last.camera_from_head * step, kNearViews);
    auto other = start ? register_frame(gray, *start) : std::nullopt;
    return other && (!near || other->quality > near->quality) ? other : near;
}

std::optional<HeadEstimate> HeadTracker::State::search(const cv::Mat1b& gray,
                                                       const std::optional<Eigen::Isometry3d>& guess) const {
    const auto start = recall(gray, guess, views().size());
    return start ? register_frame(gray, *start) : std::nullopt;
}

/// By the reference texture that shows it best.
Look HeadTracker::State::look_at(const cv::Mat1b& gray, const Eigen::Isometry3d& pose) {
    Look best;
    if (const auto part = portrait_crop_at(pose)) {
        const HeadCrop now = head::cut(gray, camera, *part);
        for (const auto& [share, view] : views_for(pose)) {
            const KeyView& portrait = portrait_of(*view);
            const auto stabilised = portrait.stabilise(now, pose);
            const cv::Mat1f weights = portrait.weights(shape(), options, stabilised);
            const Look one = likeness.compare(portrait.texture(), stabilised.texture, weights);
            const double in_sight = std::min(1., stabilised.in_sight / kUsuallyInSight);
            best = {std::max(best.alike, one.alike * in_sight), std::max(best.detail, one.detail)};
        }
    }
    return best;
}

/// Other faces correlate somewhat, unlike background: a head that is found must be recognised as this one.
bool HeadTracker::State::is_this_head(const cv::Mat1b& gray, std::optional<HeadEstimate>& found,
                                      double least_quality) {
    if (!found || found->quality < least_quality || !found->camera_from_head.matrix().allFinite()) {
        return false;
    }
    if (views().empty()) {
        return true;  // flow alone recognises no one
    }
    if (found->likeness > 0) {
        return true;  // as samples say, which correlate as no other head's do
    }
    look = look_at(gray, found->camera_from_head);
    found->likeness = look->alike;
    return recognition.accepts(*look);
}

HeadEstimate HeadTracker::State::estimate(const cv::Mat1b& gray,
                                          const std::optional<Eigen::Isometry3d>& guess) {
    std::optional<HeadEstimate> found;
    bool is_found = false;
    if (views().empty()) {
        found = follow_flow(gray);
        is_found = is_this_head(gray, found, options.held_quality);
    } else if (!last.held && !guess) {
        found = follow(gray);
        if (found && angle_between(last.camera_from_head, found->camera_from_head) > kMostTurn) {
            recognition.begin_trial();
        }
        is_found = is_this_head(gray, found, options.held_quality);
    }
    if (!is_found && !views().empty()) {
        recognition.begin_trial();  // lost and found in one frame is doubtful too
        found = search(gray, guess);
        is_found = is_this_head(gray, found, std::max(kFoundQuality, options.held_quality));
    }
    if (found && is_found) {
        if (look) {
            recognition.learn(*look);
        }
        return *found;
    }
    HeadEstimate held = last;
    held.held = true;
    held.quality = found ? std::min(found->quality, .99 * options.held_quality) : 0;
    held.correlation = found ? found->correlation : 0;
    held.likeness = found ? found->likeness : 0;
    held.num_samples = 0;
    // The pose of an unseen head is uncertain: it may turn and move while it is not seen.
    held.covariance.diagonal().head<3>().array() += kUnseenTurn / options.frame_rate;
    held.covariance.diagonal().tail<3>().array() += kUnseenShift / options.frame_rate;
    return held;
}

}  // namespace mimetic
