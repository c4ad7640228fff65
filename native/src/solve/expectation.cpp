// SPDX-License-Identifier: GPL-3.0-or-later
#include "expectation.hpp"

namespace mimetic {

namespace {

constexpr double kRotationStd = .1;      // rad a frame beyond the prediction
constexpr double kTranslationStd = .02;  // metres a frame
constexpr double kDeadZone = 2;          // more would delay onsets

}  // namespace

TrackMemory first_memory(const TrackedFace& face, cv::Mat1b gray, FaceState state) {
    DepthErrors depth_errors(face.motion, state.camera_from_head);
    TrackMemory memory{std::move(gray), std::move(state),       {}, {}, {}, false,
                       Recognition(),   std::move(depth_errors)};
    memory.velocity = FaceStep::none(face.num_values());
    memory.covariance = Eigen::MatrixXd::Zero(face.num_unknowns(), face.num_unknowns());
    memory.covariance.diagonal().head<3>().setConstant(1e-4);
    memory.covariance.diagonal().segment<3>(3).setConstant(1e-5);
    memory.covariance.bottomRightCorner(face.num_values(), face.num_values()) = face.rest;
    memory.values_std = face.motion.prior_std;
    return memory;
}

Expectation Expectation::about(const FaceState& state) const {
    Expectation other = *this;
    other.mean = state;
    return other;
}

StepPrior Expectation::from(const FaceState& state, const TrackedFace& face) const {
    const Eigen::Index num_values = face.num_values();
    StepPrior prior{information, information * mean.difference_from(state).flat};
    const RestPull::Terms terms =
        face.to_rest.at(state.values, state.values, face.to_rest.shown(state.values), values_std, kDeadZone);
    prior.information.bottomRightCorner(num_values, num_values) += face.rest_pull;
    prior.gradient.tail(num_values) -= face.rest_pull * state.values;
    prior.information.diagonal().tail(num_values) += terms.information;
    prior.gradient.tail(num_values) += terms.pull;
    return prior;
}

Expectation predict(const TrackedFace& face, const TrackMemory& memory) {
    constexpr double kDamping = .6;
    const Eigen::Index size = face.num_unknowns(), num_values = face.num_values();
    const double kept = std::exp(-1 / face.options.correlation_time);
    Expectation expected{memory.state, {}, {}, memory.values_std, memory.depth_errors};
    expected.mean.apply(FaceStep(kDamping * memory.velocity.flat));
    expected.mean.keep_within(face.motion);
    FaceStep fade(Eigen::VectorXd::Constant(size, kept));
    fade.rotation().setOnes();
    fade.translation().setOnes();
    FaceStep noise_variance = FaceStep::none(num_values);
    noise_variance.rotation().setConstant(kRotationStd * kRotationStd);
    noise_variance.translation().setConstant(kTranslationStd * kTranslationStd);
    expected.covariance = fade.flat.asDiagonal() * memory.covariance * fade.flat.asDiagonal();
    expected.covariance.diagonal() += noise_variance.flat;
    Eigen::MatrixXd change = (1 - kept * kept) * face.rest;
    if (face.motion.quickness.size() > 0) {
        const auto quickness = face.motion.quickness.asDiagonal();
        change = quickness * change * quickness;
    }
    expected.covariance.bottomRightCorner(num_values, num_values) += change;
    expected.information = expected.covariance.llt().solve(Eigen::MatrixXd::Identity(size, size));
    return expected;
}

}  // namespace mimetic
