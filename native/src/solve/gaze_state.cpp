// SPDX-License-Identifier: GPL-3.0-or-later
#include "gaze_state.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace mimetic {
namespace {

constexpr double kFreedom = 4;     // of measurements' errors (Student)
constexpr double kMeasured = .25;  // degrees beside the jitter: what smoothing must not follow
constexpr double kLargestYaw = 50, kHighestPitch = 40, kLowestPitch = -50;
// Rest, as a state: what irises show of eyes that look straight ahead. Of seven rendered people for tuning
// (docs/measured/gaze.md): mean 1, -5, -2, 1, deviation 2, 2, 5, 2; wider here, as they are few and real
// people differ more. The fitted eyes stand a little too high. And how far a clip's mean gaze is from
// straight ahead.
const GazeState kRest(0, -4, 0, 0), kRestStd(3.5, 3.5, 5, 2);
constexpr double kMeanGazeStd = 4, kGazeStd = 10;
// Share of an eye's turn that the network's iris shows, about where it usually is: sideways, up and down. On
// rendered people .87 and .64, in real frames marked by hand 1 and .7 to .9 (docs/measured/gaze.md).
constexpr double kShownYaw = .9, kShownPitch = .8;
constexpr double kVergence = 2, kVergenceStd = 1.2, kPitchApartStd = .7;

}  // namespace

GazeState straight_ahead() { return {0, 0, kVergence, 0}; }

Eigen::Matrix4d eyes_by_state() {
    Eigen::Matrix4d eyes;
    eyes << 1, 0, -.5, 0,  //
        0, 1, 0, .5,       //
        1, 0, .5, 0,       //
        0, 1, 0, -.5;
    return eyes;
}

void add_irises(const std::array<IrisTurn, 2>& turns, const GazeState* present, Eigen::MatrixXd& information,
                Eigen::VectorXd& pull) {
    static const Eigen::Matrix4d eyes = eyes_by_state();
    for (int eye = 0; eye < 2; ++eye) {
        const IrisTurn& turn = turns[static_cast<std::size_t>(eye)];
        if (!turn.is_seen) {
            continue;
        }
        const Eigen::Matrix<double, 2, 4> rows = eyes.middleRows<2>(2 * eye);
        const Eigen::Vector2d angles(turn.angles.yaw, turn.angles.pitch);
        const Eigen::Matrix2d own =
            (turn.jitter + kMeasured * kMeasured * Eigen::Matrix2d::Identity()).inverse();
        double weight = 1;
        if (present != nullptr) {
            const Eigen::Vector2d off = angles - rows * *present;
            weight = (kFreedom + 2) / (kFreedom + off.dot(own * off));
        }
        information += weight * rows.transpose() * own * rows;
        pull += weight * rows.transpose() * own * angles;
    }
}

std::pair<GazeState, GazeState> rest_of(const UsualGaze& usual) {
    const double mean = kMeanGazeStd * kMeanGazeStd + kGazeStd * kGazeStd / (1 + usual.num_seen / kFixation);
    const GazeState prior = kRestStd.cwiseAbs2();
    const GazeState other(mean, mean, kVergenceStd * kVergenceStd, kPitchApartStd * kPitchApartStd);
    const GazeState share = prior.cwiseQuotient(prior + other);
    if (!(usual.num_seen > 0)) {
        return {GazeState::Zero(), prior};
    }
    return {kRest + share.cwiseProduct(usual.median - straight_ahead() - kRest), share.cwiseProduct(other)};
}

Eigen::Vector4d turned_eyes(const GazeState& state, const UsualGaze& usual) {
    const GazeState shown(kShownYaw, kShownPitch, 1, 1);
    return eyes_by_state() * (usual.median + (state - usual.median).cwiseQuotient(shown));
}

EyeAngles within_eyes_range(const EyeAngles& turn) {
    return {std::clamp(turn.yaw, -kLargestYaw, kLargestYaw),
            std::clamp(turn.pitch, kLowestPitch, kHighestPitch)};
}

EyeAngles turn_between(const EyeAngles& rest, const EyeAngles& seen) {
    EyeAngles turn{seen.yaw - rest.yaw, seen.pitch - rest.pitch};
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        const EyeAngles there = gaze_angles(eye_rotation(turn) * gaze_direction(rest));
        turn.yaw += seen.yaw - there.yaw;
        turn.pitch += seen.pitch - there.pitch;
    }
    return within_eyes_range(turn);
}

}  // namespace mimetic
