// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/gaze.hpp>

#include "block_banded.hpp"
#include "gaze_state.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

using State = GazeState;
using Turns = std::vector<std::array<IrisTurn, 2>>;
using Sequence = std::vector<Eigen::VectorXd>;

/// What is seen of a clip; which frames begin a scene, into which nothing goes on.
struct Clip {
    Turns turns;
    std::vector<bool> begins;  // the first frame of all too
    double fps = 0;
};

constexpr double kSaccade = 1.5;  // degrees, root mean square increment at 30 frames a second, unseen

/// A weak pull to straight ahead, without which a clip that shows no eyes has no solution.
void add_prior(Eigen::MatrixXd& information, Eigen::VectorXd& pull) {
    const Eigen::Vector4d own = kUnseen.cwiseAbs2().cwiseInverse() / kFixation / 100;
    information.diagonal() += own;
    pull[2] += own[2] * straight_ahead()[2];
}

/// Information of the increment from each frame to the next; none over a cut.
std::vector<Eigen::VectorXd> increments_of(const Clip& clip, const Sequence& states) {
    const double pace = std::sqrt(30 / clip.fps);
    const double drift = kDrift * pace, tail = kTail * drift;
    std::vector<Eigen::VectorXd> weights;
    for (std::size_t t = 0; t + 1 < states.size(); ++t) {
        if (clip.begins[t + 1]) {
            weights.push_back(Eigen::Vector4d::Zero());
            continue;
        }
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

bool is_any_seen(const std::array<IrisTurn, 2>& both) { return both[0].is_seen || both[1].is_seen; }

/// As the irises are seen, frames without one on straight lines between their neighbours of the scene.
Sequence seen_states(const Clip& clip) {
    const Turns& turns = clip.turns;
    Sequence states(turns.size(), straight_ahead());
    constexpr auto kNone = static_cast<std::size_t>(-1);
    std::size_t first = 0, last = kNone;  // of the scene; seen of the scene
    const auto carry_on = [&](std::size_t end) {
        for (std::size_t t = last + 1; last != kNone && t < end; ++t) {
            states[t] = states[last];
        }
    };
    const auto bridge = [&](std::size_t to) {
        for (std::size_t t = last == kNone ? first : last + 1; t < to; ++t) {
            const double share =
                last == kNone ? 1 : static_cast<double>(t - last) / static_cast<double>(to - last);
            states[t] = share < 1 ? (1 - share) * states[last] + share * states[to] : states[to];
        }
    };
    for (std::size_t t = 0; t < turns.size(); ++t) {
        if (clip.begins[t]) {
            carry_on(t);
            first = t;
            last = kNone;
        }
        const auto& both = turns[t];
        if (!is_any_seen(both)) {
            continue;
        }
        Eigen::MatrixXd information = Eigen::MatrixXd::Zero(4, 4);
        Eigen::VectorXd pull = Eigen::VectorXd::Zero(4);
        information.diagonal().tail<2>().setConstant(.05);  // one eye alone does not show vergence
        pull[2] = .05 * straight_ahead()[2];
        add_irises(both, nullptr, information, pull);
        states[t] = information.llt().solve(pull);
        bridge(t);
        last = t;
    }
    carry_on(turns.size());
    return states;
}

Sequence smoothed(const Clip& clip) {
    constexpr int kRounds = 10;
    const Turns& turns = clip.turns;
    Sequence states = seen_states(clip);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
        Sequence next(turns.size(), Eigen::VectorXd::Zero(4));
        for (std::size_t t = 0; t < turns.size(); ++t) {
            const State present = states[t];
            add_irises(turns[t], &present, information[t], next[t]);
            add_prior(information[t], next[t]);
        }
        BlockBandedFactor(joined(std::move(information), increments_of(clip, states))).solve(next);
        states = std::move(next);
    }
    return states;
}

/// Variances of the four angles in every frame, by the jitter and what may happen unseen.
std::vector<Eigen::Vector4d> variances_of(const Clip& clip) {
    const Turns& turns = clip.turns;
    std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
    Eigen::VectorXd unused = Eigen::VectorXd::Zero(4);
    for (std::size_t t = 0; t < turns.size(); ++t) {
        add_irises(turns[t], nullptr, information[t], unused);
        information[t].diagonal() += kUnseen.cwiseAbs2().cwiseInverse() / kFixation;
    }
    const double pace = 30 / clip.fps;
    const Eigen::VectorXd increment =
        (Eigen::Vector4d(kSaccade, kSaccade, .2, .2).cwiseAbs2() * pace).cwiseInverse();
    std::vector<Eigen::VectorXd> increments(turns.size() - 1, increment);
    for (std::size_t t = 0; t < increments.size(); ++t) {
        if (clip.begins[t + 1]) {
            increments[t].setZero();
        }
    }
    std::vector<Eigen::Vector4d> variances;
    const Eigen::Matrix4d eyes = eyes_by_state();
    for (const Eigen::MatrixXd& block :
         BlockBandedFactor(joined(information, increments)).inverse_diagonal()) {
        variances.push_back((eyes * block * eyes.transpose()).diagonal());
    }
    return variances;
}

UsualOpening usual_opening(const std::vector<GazeFrame>& frames) {
    UsualOpening usual = {};
    for (std::size_t eye = 0; eye < usual.size(); ++eye) {
        std::vector<double> openings;
        for (const GazeFrame& frame : frames) {
            if (frame.irises[eye].side > 0) {
                openings.push_back(frame.irises[eye].opening);
            }
        }
        usual[eye] = upper_median(openings);
    }
    return usual;
}

UsualGaze usual_of(const Sequence& states, const Turns& turns) {
    UsualGaze usual;
    std::array<std::vector<double>, 4> columns;
    for (std::size_t t = 0; t < states.size(); ++t) {
        if (is_any_seen(turns[t])) {
            usual.num_seen += 1;
            for (std::size_t i = 0; i < 4; ++i) {
                columns[i].push_back(states[t][static_cast<Eigen::Index>(i)]);
            }
        }
    }
    if (usual.num_seen > 0) {
        for (std::size_t i = 0; i < 4; ++i) {
            usual.median[static_cast<Eigen::Index>(i)] = upper_median(columns[i]);
        }
    }
    return usual;
}

/// A scene that shows no eyes: they stand as in the others.
void stand_as_usual(const Clip& clip, const UsualGaze& usual, Sequence& states) {
    for (std::size_t first = 0; first < states.size();) {
        std::size_t end = first + 1;
        bool is_seen = is_any_seen(clip.turns[first]);
        for (; end < states.size() && !clip.begins[end]; ++end) {
            is_seen = is_seen || is_any_seen(clip.turns[end]);
        }
        if (!is_seen && usual.num_seen > 0) {
            std::fill(states.begin() + static_cast<std::ptrdiff_t>(first),
                      states.begin() + static_cast<std::ptrdiff_t>(end), usual.median);
        }
        first = end;
    }
}

std::vector<bool> marked(std::size_t count, const std::vector<int>& scene_starts) {
    std::vector<bool> begins(count, false);
    begins[0] = true;
    for (const int start : scene_starts) {
        if (start < 0 || static_cast<std::size_t>(start) >= count) {
            throw InvalidInput("gaze: a scene starts at frame " + std::to_string(start) + " of " +
                               std::to_string(count));
        }
        begins[static_cast<std::size_t>(start)] = true;
    }
    return begins;
}

}  // namespace

GazeTrack follow_gaze(const Camera& camera, const Eyeballs& eyes, const std::vector<GazeFrame>& frames,
                      double fps, const std::vector<int>& scene_starts) {
    eyes.check();
    if (!(fps > 0) || !std::isfinite(fps)) {
        throw InvalidInput("gaze needs the frames' rate; it is " + std::to_string(fps));
    }
    const auto count = static_cast<Eigen::Index>(frames.size());
    GazeTrack track{MatrixRows::Zero(count, 4), MatrixRows::Zero(count, 4)};
    if (frames.empty()) {
        return track;
    }
    Clip clip{{}, marked(frames.size(), scene_starts), fps};
    Turns& turns = clip.turns;
    const UsualOpening openings = usual_opening(frames);
    for (const GazeFrame& frame : frames) {
        turns.push_back(
            {iris_turn(camera, eyes, frame, 0, openings), iris_turn(camera, eyes, frame, 1, openings)});
    }
    Sequence states = smoothed(clip);
    const std::vector<Eigen::Vector4d> variances = variances_of(clip);
    const UsualGaze usual = usual_of(states, turns);
    stand_as_usual(clip, usual, states);
    const auto [rest, rest_variance] = rest_of(usual);
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
        const Eigen::Vector4d seen = turned_eyes(states[at], usual);
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
