// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/gaze.hpp>
#include <optional>
#include <set>

#include "block_banded.hpp"
#include "gaze_state.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

using State = GazeState;
using Turns = std::vector<std::array<IrisTurn, 2>>;
using Sequence = std::vector<Eigen::VectorXd>;

/// Frames from the first to before the end, into and out of which nothing goes on.
struct Scene {
    std::size_t first = 0, end = 0;
};
using Scenes = std::vector<Scene>;

constexpr double kSaccade = 1.5;  // degrees, root mean square increment at 30 frames a second, unseen

/// A weak pull to straight ahead, without which a clip that shows no eyes has no solution.
void add_prior(Eigen::MatrixXd& information, Eigen::VectorXd& pull) {
    const Eigen::Vector4d own = kUnseen.cwiseAbs2().cwiseInverse() / kFixation / 100;
    information.diagonal() += own;
    pull[2] += own[2] * straight_ahead()[2];
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

/// increments: from each frame to the next; those over cuts do not count.
BlockBanded joined(std::vector<Eigen::MatrixXd> information, const std::vector<Eigen::VectorXd>& increments,
                   const Scenes& scenes) {
    BlockBanded matrix;
    matrix.diagonal = std::move(information);
    matrix.first.assign(matrix.diagonal.size(), Eigen::VectorXd::Zero(4));
    matrix.second = matrix.first;
    for (const Scene& scene : scenes) {
        for (std::size_t t = scene.first; t + 1 < scene.end; ++t) {
            matrix.diagonal[t].diagonal() += increments[t];
            matrix.diagonal[t + 1].diagonal() += increments[t];
            matrix.first[t] = -increments[t];
        }
    }
    return matrix;
}

bool is_any_seen(const std::array<IrisTurn, 2>& both) { return both[0].is_seen || both[1].is_seen; }

/// As the irises of a scene are seen, frames without one on straight lines between their neighbours.
void see(const Turns& turns, const Scene& scene, Sequence& states) {
    std::optional<std::size_t> last;
    const auto bridge = [&](std::size_t to) {
        const std::size_t from = last.value_or(to);
        for (std::size_t t = last ? from + 1 : scene.first; t < to; ++t) {
            const double share = last ? static_cast<double>(t - from) / static_cast<double>(to - from) : 1;
            states[t] = (1 - share) * states[from] + share * states[to];
        }
    };
    for (std::size_t t = scene.first; t < scene.end; ++t) {
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
    for (std::size_t t = last.value_or(scene.end) + 1; t < scene.end; ++t) {
        states[t] = states[t - 1];
    }
}

Sequence smoothed(const Turns& turns, const Scenes& scenes, double fps) {
    constexpr int kRounds = 10;
    Sequence states(turns.size(), straight_ahead());
    for (const Scene& scene : scenes) {
        see(turns, scene, states);
    }
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
        Sequence next(turns.size(), Eigen::VectorXd::Zero(4));
        for (std::size_t t = 0; t < turns.size(); ++t) {
            const State present = states[t];
            add_irises(turns[t], &present, information[t], next[t]);
            add_prior(information[t], next[t]);
        }
        BlockBandedFactor(joined(std::move(information), increments_of(states, fps), scenes)).solve(next);
        states = std::move(next);
    }
    return states;
}

/// Variances of the four angles in every frame, by the jitter and what may happen unseen.
std::vector<Eigen::Vector4d> variances_of(const Turns& turns, const Scenes& scenes, double fps) {
    std::vector<Eigen::MatrixXd> information(turns.size(), Eigen::MatrixXd::Zero(4, 4));
    Eigen::VectorXd unused = Eigen::VectorXd::Zero(4);
    for (std::size_t t = 0; t < turns.size(); ++t) {
        add_irises(turns[t], nullptr, information[t], unused);
        information[t].diagonal() += kUnseen.cwiseAbs2().cwiseInverse() / kFixation;
    }
    const double pace = 30 / fps;
    const Eigen::VectorXd increment =
        (Eigen::Vector4d(kSaccade, kSaccade, .2, .2).cwiseAbs2() * pace).cwiseInverse();
    const std::vector<Eigen::VectorXd> increments(turns.size() - 1, increment);
    std::vector<Eigen::Vector4d> variances;
    const Eigen::Matrix4d eyes = eyes_by_state();
    for (const Eigen::MatrixXd& block :
         BlockBandedFactor(joined(information, increments, scenes)).inverse_diagonal()) {
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
void stand_as_usual(const Turns& turns, const Scene& scene, const UsualGaze& usual, Sequence& states) {
    const auto first = static_cast<std::ptrdiff_t>(scene.first), end = static_cast<std::ptrdiff_t>(scene.end);
    if (usual.num_seen > 0 && std::none_of(turns.begin() + first, turns.begin() + end, is_any_seen)) {
        std::fill(states.begin() + first, states.begin() + end, usual.median);
    }
}

Scenes scenes_of(std::size_t count, const std::vector<int>& scene_starts) {
    std::set<std::size_t> bounds{0, count};
    for (const int start : scene_starts) {
        if (start < 0 || static_cast<std::size_t>(start) >= count) {
            throw InvalidInput("gaze: a scene starts at frame " + std::to_string(start) + " of " +
                               std::to_string(count));
        }
        bounds.insert(static_cast<std::size_t>(start));
    }
    Scenes scenes;
    for (auto first = bounds.begin(), end = std::next(first); end != bounds.end(); ++first, ++end) {
        scenes.push_back({*first, *end});
    }
    return scenes;
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
    Turns turns;
    const UsualOpening openings = usual_opening(frames);
    for (const GazeFrame& frame : frames) {
        turns.push_back(
            {iris_turn(camera, eyes, frame, 0, openings), iris_turn(camera, eyes, frame, 1, openings)});
    }
    const Scenes scenes = scenes_of(frames.size(), scene_starts);
    Sequence states = smoothed(turns, scenes, fps);
    const std::vector<Eigen::Vector4d> variances = variances_of(turns, scenes, fps);
    const UsualGaze usual = usual_of(states, turns);
    for (const Scene& scene : scenes) {
        stand_as_usual(turns, scene, usual, states);
    }
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
