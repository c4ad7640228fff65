// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/puppet/stillness.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>
#include <numbers>
#include <random>
#include <string>

namespace mimetic {
namespace {

constexpr double kShortestLag = .01, kLongestLag = .4;  // seconds at rest, near stillness 0 and at 1
constexpr double kQuickening = 4;                       // Hz for a value that goes from 0 to 1 in a second
constexpr double kSpeedLag = .04;                       // seconds
constexpr double kLongestGap = 1;                       // seconds; after it nothing is known of the motion
constexpr double kShortestStep = 1e-4;
// What counts as much as a value of 1: radians, metres
constexpr double kRotation = .5, kTranslation = .1;

FilterOptions options_of(double stillness) {
    FilterOptions options;
    options.lag = stillness > 0 ? kShortestLag * std::pow(kLongestLag / kShortestLag, stillness) : 0;
    options.quickening = kQuickening;
    options.speed_lag = kSpeedLag;
    return options;
}

/// A head that faces the camera: x to the image right, y up, z to the camera.
Eigen::Matrix3d facing() { return Eigen::Vector3d(1, -1, -1).asDiagonal(); }

Eigen::VectorXd flat(const LivePose& pose) {
    Eigen::VectorXd numbers(6 + pose.values.size());
    numbers << rotation_vector(pose.camera_from_head.linear() * facing()),
        pose.camera_from_head.translation(), pose.values;
    return numbers;
}

LivePose posed(const Eigen::VectorXd& numbers) {
    LivePose pose;
    pose.camera_from_head.linear() = rotation_from_vector(numbers.head<3>()) * facing();
    pose.camera_from_head.translation() = numbers.segment<3>(3);
    pose.values = numbers.tail(numbers.size() - 6);
    return pose;
}

double checked(double stillness) {
    check_range("stillness", stillness, 0, 1);
    return stillness;
}

}  // namespace

StillnessFilter::StillnessFilter(double stillness) : stillness_(checked(stillness)) {}

void StillnessFilter::set_stillness(double stillness) {
    stillness_ = checked(stillness);
    if (filter_) {
        filter_->set_options(options_of(stillness));
    }
}

LivePose StillnessFilter::advance(const LivePose& measured, double seconds) {
    const Eigen::VectorXd numbers = flat(measured);
    if (!numbers.allFinite() || !std::isfinite(seconds)) {
        throw InvalidInput("a live face needs a pose, values and a time that are finite");
    }
    if (!filter_ || filter_->size() != numbers.size()) {
        Eigen::VectorXd units = Eigen::VectorXd::Ones(numbers.size());
        units.head<3>().setConstant(kRotation);
        units.segment<3>(3).setConstant(kTranslation);
        filter_.emplace(units, options_of(stillness_));
    } else if (seconds >= kLongestGap) {
        filter_->restart();
    }
    const Eigen::VectorXd now = filter_->advance(numbers, std::max(seconds, kShortestStep));
    return now == numbers ? measured : posed(now);
}

StillnessFigures stillness_figures(double stillness, double fps) {
    if (!(fps > 0) || !std::isfinite(fps)) {
        throw InvalidInput("stillness needs the frames' rate; it is " + std::to_string(fps));
    }
    constexpr double kRise = 1. / 3;  // seconds
    constexpr double kHalf = .25;
    constexpr double kJitter = .005;
    constexpr int kPerFrame = 20, kFrames = 2000;
    StillnessFigures figures;
    // Half of the way is crossed between two frames: the motion is begun at many times within one
    double lag = 0;
    for (int phase = 0; phase < kPerFrame; ++phase) {
        StillnessFilter filter(stillness);
        double before = 0, time = -1 / fps * phase / kPerFrame;
        for (int frame = 0;; ++frame, time += 1 / fps) {
            const double way = std::clamp(time / kRise, 0., 1.);
            LivePose pose;
            pose.camera_from_head.linear() = facing();
            pose.values = Eigen::VectorXd::Constant(1, kHalf * (1 - std::cos(std::numbers::pi * way)));
            const double now = filter.advance(pose, 1 / fps).values[0];
            if (now >= kHalf) {
                const double crossed = time - (now - kHalf) / (now - before) / fps;
                lag += (crossed - kRise / 2) * fps / kPerFrame;
                break;
            }
            before = now;
        }
    }
    figures.lag_frames = std::max(0., lag);
    StillnessFilter filter(stillness);
    // The same figures every time.
    std::mt19937 random(7);  // NOLINT(bugprone-random-generator-seed)
    std::normal_distribution<double> jitter(0, kJitter);
    double kept = 0, all = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
        LivePose pose;
        pose.camera_from_head.linear() = facing();
        const double measured = jitter(random);
        pose.values = Eigen::VectorXd::Constant(1, measured);
        const double now = filter.advance(pose, 1 / fps).values[0];
        kept += now * now;
        all += measured * measured;
    }
    figures.jitter_share = std::sqrt(kept / all);
    return figures;
}

}  // namespace mimetic
