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

void LidReader::look(const cv::Mat1b& gray, const FaceState& near) {
    measured_.clear();
    if (lids_.empty()) {
        return;
    }
    FaceState open = near;
    for (const LidMeter& lid : lids_) {
        for (const int value : {lid.slit().lid_upper, lid.slit().lid_lower}) {
            if (value >= 0) {
                open.values[value] = 0;
            }
        }
    }
    const FloatPixels pixels = project_control(open);
    for (const LidMeter& lid : lids_) {
        measured_.push_back(lid.measure(gray, pixels));
    }
}

void LidReader::look_away() { measured_.clear(); }

StepPrior LidReader::terms(const FaceState& state) const {
    const Eigen::Index size = face_.num_unknowns();
    StepPrior terms{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    for (std::size_t i = 0; i < measured_.size(); ++i) {
        if (measured_[i].seen) {
            const int value = lids_[i].slit().lid_upper;
            const double information = 1 / (measured_[i].std * measured_[i].std);
            terms.information(FaceStep::kPose + value, FaceStep::kPose + value) = information;
            terms.gradient[FaceStep::kPose + value] =
                information * (measured_[i].closure - state.values[value]);
        }
    }
    return terms;
}

FaceState LidReader::with_lids(FaceState state) const {
    for (std::size_t i = 0; i < measured_.size(); ++i) {
        if (measured_[i].seen) {
            state.values[lids_[i].slit().lid_upper] = measured_[i].closure;
        }
    }
    state.keep_within(face_.motion);
    return state;
}

}  // namespace mimetic
