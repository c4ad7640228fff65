// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/corrections.hpp>

#include "evidence_bias.hpp"

namespace mimetic {

namespace {

constexpr int kMostRounds = 4;  // of linearising: turns and projection are nearly linear
constexpr double kMet = .3;     // standard deviations from which a correction counts as met

FaceState state_of(const FrameEstimate& estimate) { return {estimate.camera_from_head, estimate.values}; }

/// Corrections that share a frame are one: they are solved together.
std::vector<Correction> by_frame(const std::vector<Correction>& corrections) {
    std::vector<Correction> joined;
    for (const Correction& correction : corrections) {
        const auto same = std::find_if(joined.begin(), joined.end(),
                                       [&](const Correction& c) { return c.index == correction.index; });
        if (same == joined.end()) {
            joined.push_back(correction);
            continue;
        }
        same->reach = std::max(same->reach, correction.reach);
        same->pins.insert(same->pins.end(), correction.pins.begin(), correction.pins.end());
        same->poses.insert(same->poses.end(), correction.poses.begin(), correction.poses.end());
        same->values.insert(same->values.end(), correction.values.begin(), correction.values.end());
    }
    return joined;
}

bool is_std(double std) { return std > 1e-9 && std < 1e9; }

bool fits(const Correction& correction, Eigen::Index num_values) {
    bool is_fit = correction.reach >= 1 && correction.reach < 1e6;
    for (const SkinPin& pin : correction.pins) {
        is_fit = is_fit && pin.modes.rows() == num_values && pin.modes.cols() == 3 && pin.modes.allFinite() &&
                 pin.neutral.allFinite() && pin.pixel.allFinite() && is_std(pin.std);
    }
    for (const PosePin& pose : correction.poses) {
        is_fit = is_fit && pose.camera_from_head.matrix().allFinite() && is_std(pose.rotation_std) &&
                 is_std(pose.translation_std);
    }
    for (const ValuePin& value : correction.values) {
        is_fit = is_fit && value.weights.size() == num_values && value.weights.allFinite() &&
                 std::isfinite(value.target) && is_std(value.std);
    }
    return is_fit;
}

void check(const std::vector<Correction>& corrections, std::size_t num_estimates, Eigen::Index num_values) {
    for (const Correction& correction : corrections) {
        if (correction.index < 0 || static_cast<std::size_t>(correction.index) >= num_estimates) {
            throw InvalidInput("a correction is of estimate " + std::to_string(correction.index) +
                               ", there are " + std::to_string(num_estimates));
        }
        if (!fits(correction, num_values)) {
            throw InvalidInput("the correction of estimate " + std::to_string(correction.index) +
                               " is not of a face of " + std::to_string(num_values) +
                               " values, not finite, or has no standard deviation above 0");
        }
    }
}

/// The pictures' estimates, moved by their bias, with the corrections as further measurements.
std::vector<FrameEstimate> with_corrections(const std::vector<FrameEstimate>& estimates,
                                            const std::vector<Correction>& corrections,
                                            const std::vector<CorrectionRows>& rows,
                                            const std::vector<FrameEstimate>& current,
                                            const EvidenceBias& bias) {
    std::vector<FrameEstimate> moved = estimates;
    for (std::size_t t = 0; t < moved.size(); ++t) {
        moved[t].gradient += moved[t].information * bias.shift(static_cast<int>(t));
    }
    for (std::size_t k = 0; k < corrections.size(); ++k) {
        const auto at = static_cast<std::size_t>(corrections[k].index);
        const Eigen::MatrixXd information = rows[k].information();
        const FaceStep since = state_of(current[at]).difference_from(state_of(estimates[at]));
        moved[at].information += information;
        moved[at].gradient += rows[k].pull() + information * since.flat;
    }
    return moved;
}

bool are_met(const std::vector<CorrectionRows>& rows) {
    return std::all_of(rows.begin(), rows.end(), [](const CorrectionRows& own) {
        return own.residual.size() == 0 || own.residual.cwiseQuotient(own.std).cwiseAbs().maxCoeff() < kMet;
    });
}

}  // namespace

std::vector<FrameEstimate> smooth_corrected(const std::vector<FrameEstimate>& estimates,
                                            const FaceMotion& motion, const Camera& camera,
                                            const std::vector<Correction>& corrections,
                                            const SmootherOptions& options, const Progress& progress) {
    check(corrections, estimates.size(), motion.lower.size());
    const std::vector<Correction> frames = by_frame(corrections);
    int round = 0;
    bool is_stopped = false;
    const Progress part = [&](double fraction) {
        is_stopped = is_stopped || (progress && !progress((round + fraction) / (1 + kMostRounds)));
        return !is_stopped;
    };
    std::vector<FrameEstimate> current = smooth(estimates, motion, options, part);
    if (frames.empty()) {
        return current;
    }
    std::vector<Eigen::VectorXd> evidence;
    evidence.reserve(frames.size());
    for (const Correction& correction : frames) {
        evidence.push_back(current[static_cast<std::size_t>(correction.index)].values);
    }
    EvidenceBias bias(motion, frames);
    std::vector<Eigen::VectorXd> shifts(frames.size(), Eigen::VectorXd::Zero(6 + motion.lower.size()));
    for (round = 1; round <= kMostRounds && !is_stopped; ++round) {
        std::vector<CorrectionRows> rows, asked;
        for (std::size_t k = 0; k < frames.size(); ++k) {
            const FrameEstimate& here = current[static_cast<std::size_t>(frames[k].index)];
            rows.push_back(linearised(frames[k], camera, state_of(here)));
            asked.push_back(rows.back());
            asked.back().residual += rows.back().rows * shifts[k];
        }
        if (are_met(rows)) {
            break;
        }
        bias.fit(asked, evidence);
        for (std::size_t k = 0; k < frames.size(); ++k) {
            shifts[k] = bias.shift(frames[k].index);
        }
        current = smooth(with_corrections(estimates, frames, rows, current, bias), motion, options, part);
    }
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        const FaceStep step = state_of(current[t]).difference_from(state_of(estimates[t]));
        current[t].information = estimates[t].information;
        current[t].gradient = estimates[t].gradient - estimates[t].information * step.flat;
    }
    return current;
}

}  // namespace mimetic
