// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/gaze.hpp>

#include "block_banded.hpp"

namespace mimetic {
namespace {

using State = Eigen::Vector4d;  // degrees: both eyes' yaw and pitch, vergence (yaw R - L), pitch L - R
using Turns = std::vector<std::array<IrisTurn, 2>>;
using Sequence = std::vector<Eigen::VectorXd>;

// Degrees, at 30 frames a second; the eyeballs of the canonical head are 1.4 times as large as people's, so
// that they turn less for the same way of an iris.
constexpr double kDrift = .12;  // of fixations, a frame
constexpr double kVergenceDrift = .06;
constexpr double kTail = 2.5;      // in drifts: from here on an increment counts as a saccade
constexpr double kFreedom = 4;     // of measurements' errors (Student)
constexpr double kMeasured = .25;  // beside the jitter: what smoothing must not follow
constexpr double kSaccade = 1.5;   // root mean square increment, for what is not seen
constexpr double kLargestYaw = 50, kHighestPitch = 40, kLowestPitch = -50;
// Rest, as a state: what irises show of eyes that look straight ahead. Of seven rendered people for tuning
// (docs/measured/gaze.md): mean 1, -5, -2, 1, deviation 2, 2, 5, 2; wider here, as they are few and real
// people differ more. The fitted eyes stand a little too high. And how far a clip's mean gaze is from
// straight ahead.
const State kRest(0, -4, 0, 0), kRestStd(3.5, 3.5, 5, 2);
constexpr double kMeanGazeStd = 4, kGazeStd = 10, kFixation = 30;  // the last: frames
// Share of an eye's turn that the network's iris shows, about where it usually is: sideways, up and down. On
// rendered people .87 and .64, in real frames marked by hand 1 and .7 to .9 (docs/measured/gaze.md).
constexpr double kShownYaw = .9, kShownPitch = .8;
constexpr double kVergence = 2, kVergenceStd = 1.2, kPitchApartStd = .7;

/// The eyes' four angles from the state.
Eigen::Matrix4d eyes_by_state() {
    Eigen::Matrix4d eyes;
    eyes << 1, 0, -.5, 0,  //
        0, 1, 0, .5,       //
        1, 0, .5, 0,       //
        0, 1, 0, -.5;
    return eyes;
}

/// Information and right-hand side of a frame's irises; robust, given the present state.
void add_irises(const std::array<IrisTurn, 2>& turns, const State* present, Eigen::MatrixXd& information,
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

/// A weak pull to straight ahead, without which a clip that shows no eyes has no solution.
void add_prior(Eigen::MatrixXd& information, Eigen::VectorXd& pull) {
    const Eigen::Vector4d own = Eigen::Vector4d(15, 15, 5, 5).cwiseAbs2().cwiseInverse() / kFixation / 100;
    information.diagonal() += own;
    pull[2] += own[2] * kVergence;
}

/// Information of the increment from each frame to the next.
std::vector<Eigen::VectorXd> increments_of(const Sequence& states, double fps) {
    const double pace = std::sqrt(30 / fps);
    const double drift = kDrift * pace, tail = kTail * drift;
    std::vector<Eigen::VectorXd> weights;
    for (std::size_t t = 0; t + 1 < states.size(); ++t) {
        const double jump = (states[t + 1] - states[t]).head<2>().squaredNorm() / (tail * tail);
        const double own = 1 / (drift * drift * (1 + jump)), apart = kVergenceDrift * pace;
        weights.push_back(Eigen::Vector4d(own, own, 1 / (apart * apart), 1 / (apart * apart)));
    }
    return weights;
}

BlockBanded joined(std::vector<Eigen::MatrixXd> information, const std::vector<Eigen::VectorXd>& increments) {
    BlockBanded matrix;
    matrix.diagonal = std::move(information);
    matrix.first.assign(matrix.diagonal.size(), Eigen::VectorXd::Zero(4));
    matrix.second = matrix.first;
    for (std::size_t t = 0; t < increments.size(); ++t) {
        matrix.diagonal[t].diagonal() += increments[t];
        matrix.diagonal[t + 1].diagonal() += increments[t];
        matrix.first[t] = -increments[t];
    }
    return matrix;
}

/// As the irises are seen, frames without one on straight lines between their neighbours.
Sequence seen_states(const Turns& turns) {
    Sequence states(turns.size(), State(0, 0, kVergence, 0));
    int last = -1;
    const auto bridge = [&](int from, int to) {
        for (int t = from + 1; t < to; ++t) {
            const double share = from < 0 ? 1 : static_cast<double>(t - from) / (to - from);
            states[static_cast<std::size_t>(t)] =
                (1 - share) * states[static_cast<std::size_t>(std::max(from, 0))] +
                share * states[static_cast<std::size_t>(to)];
        }
    };
    for (int t = 0; t < static_cast<int>(turns.size()); ++t) {
        const auto& both = turns[static_cast<std::size_t>(t)];
        if (!both[0].is_seen && !both[1].is_seen) {
            continue;
        }
        Eigen::MatrixXd information = Eigen::MatrixXd::Zero(4, 4);
        Eigen::VectorXd pull = Eigen::VectorXd::Zero(4);
        information.diagonal().tail<2>().setConstant(.05);  // one eye alone does not show vergence
        pull[2] = .05 * kVergence;
        add_irises(both, nullptr, information, pull);
        states[static_cast<std::size_t>(t)] = information.llt().solve(pull);
        bridge(last, t);
        last = t;
    }
    for (std::size_t t = static_cast<std::size_t>(last + 1); last >= 0 && t < states.size(); ++t) {
        states[t] = states[static_cast<std::size_t>(last)];
    }
    return states;
}

Sequence smoothed(const Turns& turns, double fps) {
    constexpr int kRounds = 10;
    Sequence states = seen_states(turns);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
        Sequence next(turns.size(), Eigen::VectorXd::Zero(4));
        for (std::size_t t = 0; t < turns.size(); ++t) {
            const State present = states[t];
            add_irises(turns[t], &present, information[t], next[t]);
            add_prior(information[t], next[t]);
        }
        BlockBandedFactor(joined(std::move(information), increments_of(states, fps))).solve(next);
        states = std::move(next);
    }
    return states;
}

/// Variances of the four angles in every frame, by the jitter and what may happen unseen.
std::vector<Eigen::Vector4d> variances_of(const Turns& turns, double fps) {
    std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
    Eigen::VectorXd unused = Eigen::VectorXd::Zero(4);
    for (std::size_t t = 0; t < turns.size(); ++t) {
        add_irises(turns[t], nullptr, information[t], unused);
        information[t].diagonal() += Eigen::Vector4d(15, 15, 5, 5).cwiseAbs2().cwiseInverse() / kFixation;
    }
    const double pace = 30 / fps;
    const Eigen::VectorXd increment =
        (Eigen::Vector4d(kSaccade, kSaccade, .2, .2).cwiseAbs2() * pace).cwiseInverse();
    const std::vector<Eigen::VectorXd> increments(turns.size() - 1, increment);
    std::vector<Eigen::Vector4d> variances;
    const Eigen::Matrix4d eyes = eyes_by_state();
    for (const Eigen::MatrixXd& block :
         BlockBandedFactor(joined(information, increments)).inverse_diagonal()) {
        variances.push_back((eyes * block * eyes.transpose()).diagonal());
    }
    return variances;
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The state that a clip usually shows, and in how many frames it shows eyes at all.
struct UsualState {
    State median = State(0, 0, kVergence, 0);
    double num_seen = 0;
};

UsualState usual_of(const Sequence& states, const Turns& turns) {
    UsualState usual;
    std::array<std::vector<double>, 4> columns;
    for (std::size_t t = 0; t < states.size(); ++t) {
        if (turns[t][0].is_seen || turns[t][1].is_seen) {
            usual.num_seen += 1;
            for (std::size_t i = 0; i < 4; ++i) {
                columns[i].push_back(states[t][static_cast<Eigen::Index>(i)]);
            }
        }
    }
    if (usual.num_seen > 0) {
        for (std::size_t i = 0; i < 4; ++i) {
            usual.median[static_cast<Eigen::Index>(i)] = median_of(columns[i]);
        }
    }
    return usual;
}

/// What of it is the eyes' rest, by how far each may stray: state, then variances.
std::pair<State, State> rest_of(const UsualState& usual) {
    const double mean = kMeanGazeStd * kMeanGazeStd + kGazeStd * kGazeStd / (1 + usual.num_seen / kFixation);
    const State prior = kRestStd.cwiseAbs2();
    const State other(mean, mean, kVergenceStd * kVergenceStd, kPitchApartStd * kPitchApartStd);
    const State share = prior.cwiseQuotient(prior + other);
    if (!(usual.num_seen > 0)) {
        return {State::Zero(), prior};
    }
    return {kRest + share.cwiseProduct(usual.median - State(0, 0, kVergence, 0) - kRest),
            share.cwiseProduct(other)};
}

/// The turn that takes an eye which rests at one direction to another.
EyeAngles turn_between(const EyeAngles& rest, const EyeAngles& seen) {
    EyeAngles turn{seen.yaw - rest.yaw, seen.pitch - rest.pitch};
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        const EyeAngles there = gaze_angles(eye_rotation(turn) * gaze_direction(rest));
        turn.yaw += seen.yaw - there.yaw;
        turn.pitch += seen.pitch - there.pitch;
    }
    return {std::clamp(turn.yaw, -kLargestYaw, kLargestYaw),
            std::clamp(turn.pitch, kLowestPitch, kHighestPitch)};
}

}  // namespace

GazeTrack follow_gaze(const Camera& camera, const Eyeballs& eyes, const std::vector<GazeFrame>& frames,
                      double fps) {
    eyes.check();
    if (!(fps > 0) || !std::isfinite(fps)) {
        throw InvalidInput("gaze needs the frames' rate; it is " + std::to_string(fps));
    }
    const auto count = static_cast<Eigen::Index>(frames.size());
    GazeTrack track{MatrixRows::Zero(count, 4), MatrixRows::Zero(count, 4)};
    if (frames.empty()) {
        return track;
    }
    Turns turns;
    for (const GazeFrame& frame : frames) {
        turns.push_back({iris_turn(camera, eyes, frame, 0), iris_turn(camera, eyes, frame, 1)});
    }
    const Sequence states = smoothed(turns, fps);
    const std::vector<Eigen::Vector4d> variances = variances_of(turns, fps);
    const UsualState usual = usual_of(states, turns);
    const auto [rest, rest_variance] = rest_of(usual);
    const State shown(kShownYaw, kShownPitch, 1, 1);
    const Eigen::Matrix4d by_state = eyes_by_state();
    const Eigen::Vector4d at_rest = by_state * rest;
    const Eigen::Vector4d rest_variances = by_state.cwiseAbs2() * rest_variance;
    track.rest_std = rest_variances.cwiseSqrt();
    for (int eye = 0; eye < 2; ++eye) {
        track.rest[static_cast<std::size_t>(eye)] = {at_rest[2 * eye], at_rest[2 * eye + 1]};
    }
    // Of frames that show no iris, those of the last one that did
    std::array<Eigen::Vector2d, 2> lasting{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    for (Eigen::Index t = 0; t < count; ++t) {
        const auto at = static_cast<std::size_t>(t);
        const State aside = states[at] - usual.median;
        const Eigen::Vector4d seen = by_state * (usual.median + aside.cwiseQuotient(shown));
        Eigen::Vector4d variance = variances[at] + rest_variances;
        for (int eye = 0; eye < 2; ++eye) {
            const IrisTurn& own = turns[at][static_cast<std::size_t>(eye)];
            const EyeAngles turn =
                turn_between(track.rest[static_cast<std::size_t>(eye)], {seen[2 * eye], seen[2 * eye + 1]});
            track.angles(t, 2 * eye) = turn.yaw;
            track.angles(t, 2 * eye + 1) = turn.pitch;
            lasting[static_cast<std::size_t>(eye)] =
                own.is_seen ? own.lasting.diagonal() : lasting[static_cast<std::size_t>(eye)];
            variance.segment<2>(2 * eye) += lasting[static_cast<std::size_t>(eye)];
        }
        track.std.row(t) = variance.cwiseSqrt().transpose();
    }
    return track;
}

}  // namespace mimetic
