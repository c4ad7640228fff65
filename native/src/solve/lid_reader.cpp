// SPDX-License-Identifier: GPL-3.0-or-later
#include "lid_reader.hpp"

namespace mimetic {

LidReader::LidReader(const TrackedFace& face, const std::vector<EyeSlit>& eyes, const cv::Mat1b& gray,
                     const FaceState& state)
    : face_(face), lids_(eyes.begin(), eyes.end()) {
    for (LidMeter& lid : lids_) {
        lid.take_reference(gray, project_control(state));
    }
}

FloatPixels LidReader::project_control(const FaceState& state) const {
    Points moved = face_.motion.neutral;
    Eigen::Map<Eigen::VectorXd> flat(moved.data(), moved.size());
    flat += face_.motion.modes.transpose() * state.values;
    FloatPixels pixels(moved.rows(), 2);
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        const Eigen::Vector3d point = state.camera_from_head * Eigen::Vector3d(moved.row(i));
        pixels.row(i) = face_.camera.project(point).transpose().cast<float>();
    }
    return pixels;
}

FrameEstimate LidReader::read(FrameEstimate estimate, const cv::Mat1b& gray, const FaceState& before) const {
    if (lids_.empty()) {
        return estimate;
    }
    FaceState open{estimate.camera_from_head, estimate.values};
    for (const LidMeter& lid : lids_) {
        for (const int value : {lid.slit().lid_upper, lid.slit().lid_lower}) {
            if (value >= 0) {
                open.values[value] = 0;
            }
        }
    }
    const FloatPixels pixels = project_control(open);
    for (const LidMeter& lid : lids_) {
        const LidMeasurement measured = lid.measure(gray, pixels);
        if (!measured.seen) {
            continue;
        }
        const int value = lid.slit().lid_upper;
        const Eigen::Index row = FaceStep::kPose + value;
        // A blink takes three frames: what was says little.
        constexpr double kJump = .4;
        const double variance = measured.std * measured.std;
        const double share = kJump * kJump / (kJump * kJump + variance);
        const double last = before.values[value];
        const double wanted = std::clamp(last + share * (measured.closure - last), face_.motion.lower[value],
                                         face_.motion.upper[value]);
        estimate.values[value] = wanted;
        estimate.covariance.row(row).setZero();
        estimate.covariance.col(row).setZero();
        estimate.covariance(row, row) = share * variance;
        estimate.information.row(row).setZero();
        estimate.information.col(row).setZero();
        estimate.information(row, row) = 1 / variance;
        estimate.gradient[row] = (measured.closure - wanted) / variance;
    }
    return estimate;
}

}  // namespace mimetic
