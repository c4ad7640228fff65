// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "gaze_state.hpp"

namespace mimetic {
namespace {

constexpr int kRounds = 4;              // of reweighting; a saccade is found in two
constexpr double kMemory = 1800;        // frames over which what is usual is learnt: a minute
constexpr double kReach = 4;            // degrees: how far one frame may pull what is usual
constexpr double kReachOfOpening = .2;  // of what is usual: the same of the lids
constexpr double kLongestGap = 1;       // seconds

}  // namespace

GazeFilter::GazeFilter(const Eyeballs& eyes)
    : eyes_(eyes),
      state_(straight_ahead()),
      usual_(straight_ahead()),
      covariance_(kUnseen.cwiseAbs2().asDiagonal()) {
    eyes_.check();
}

void GazeFilter::learn_opening(const GazeFrame& frame) {
    for (std::size_t eye = 0; eye < usual_opening_.size(); ++eye) {
        const SeenIris& iris = frame.irises[eye];
        double& usual = usual_opening_[eye];
        if (iris.side > 0 && std::isfinite(iris.opening)) {
            // An eye may be seen for the first time long after the other
            usual = usual > 0 ? usual : std::max(0., iris.opening);
            const double reach = kReachOfOpening * usual;
            usual += std::clamp(iris.opening - usual, -reach, reach) / std::min(num_seen_ + 1, kMemory);
        }
    }
}

Eigen::Vector4d GazeFilter::advance(const Camera& camera, const GazeFrame& frame, double seconds) {
    const double pace = 30 * std::clamp(std::isfinite(seconds) ? seconds : 0, 1e-3, kLongestGap);
    learn_opening(frame);
    const std::array<IrisTurn, 2> turns{iris_turn(camera, eyes_, frame, 0, usual_opening_),
                                        iris_turn(camera, eyes_, frame, 1, usual_opening_)};
    if (turns[0].is_seen || turns[1].is_seen) {
        const double drift = kDrift * kDrift * pace, apart = kVergenceDrift * kVergenceDrift * pace;
        GazeState next = state_;
        Eigen::MatrixXd information;
        // A jump is a saccade: where the irises are far off, the eyes' freedom to move grows with it, and
        // what is seen counts in full, since no frame to come can tell whether it was an error.
        for (int round = 0; round < kRounds; ++round) {
            const double jump = (next - state_).head<2>().squaredNorm() / (kTail * kTail * drift);
            Eigen::Matrix4d expected = covariance_;
            expected.diagonal() += GazeState(drift * (1 + jump), drift * (1 + jump), apart, apart);
            information = expected.llt().solve(Eigen::Matrix4d::Identity());
            Eigen::VectorXd pull = information * state_;
            add_irises(turns, nullptr, information, pull);
            const double weak = 1e-4;  // to straight ahead
            information(2, 2) += weak;
            pull[2] += weak * straight_ahead()[2];
            next = information.llt().solve(pull);
        }
        state_ = next;
        covariance_ = information.llt().solve(Eigen::Matrix4d::Identity());
        num_seen_ += 1;
        usual_ += (state_ - usual_).cwiseMax(-kReach).cwiseMin(kReach) / std::min(num_seen_, kMemory);
    }
    const UsualGaze usual{usual_, num_seen_};
    const Eigen::Vector4d at_rest = eyes_by_state() * rest_of(usual).first;
    const Eigen::Vector4d seen = turned_eyes(state_, usual);
    Eigen::Vector4d angles;
    for (int eye = 0; eye < 2; ++eye) {
        const EyeAngles turn =
            turn_between({at_rest[2 * eye], at_rest[2 * eye + 1]}, {seen[2 * eye], seen[2 * eye + 1]});
        angles.segment<2>(2 * eye) << turn.yaw, turn.pitch;
    }
    return angles;
}

}  // namespace mimetic
