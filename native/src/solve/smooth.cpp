// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>

#include "block_banded.hpp"
#include "detail_solver.hpp"
#include "motion_prior.hpp"

namespace mimetic {

namespace {

using Blocks = std::vector<Eigen::VectorXd>;

/// Frames of a clip in the time of one of 24 to 30 a second, for which what counts frames was chosen.
double frames_a_frame(const SmootherOptions& options) {
    // Beyond these, of pictures that an hour lies between, one tells nothing of the next
    const double rate = std::clamp(options.frame_rate, 1., 1000.);
    return rate / std::clamp(rate, 24., 30.);
}

/// What standard deviations of second differences are multiplied by: variance a time of a random force.
double acceleration_factor(const SmootherOptions& options) { return std::pow(frames_a_frame(options), -1.5); }

FaceState state_of(const FrameEstimate& estimate) { return {estimate.camera_from_head, estimate.values}; }

/// Steps of all frames from their estimates: 1/2 d' matrix d - pull' d, values within bounds.
struct SequenceProblem {
    BlockBanded matrix;
    Blocks pull;
    Blocks lower;  // of the values' steps
    Blocks upper;
};

void add_acceleration(const std::vector<FrameEstimate>& estimates, const Eigen::VectorXd& weights,
                      SequenceProblem& problem) {
    problem.matrix.add_second_differences(weights);
    for (std::size_t t = 1; t + 1 < estimates.size(); ++t) {
        const FaceState before = state_of(estimates[t - 1]), here = state_of(estimates[t]),
                        after = state_of(estimates[t + 1]);
        const Eigen::VectorXd bend =
            weights.cwiseProduct(after.difference_from(here).flat - here.difference_from(before).flat);
        problem.pull[t - 1] -= bend;
        problem.pull[t] += 2 * bend;
        problem.pull[t + 1] -= bend;
    }
}

/// Frames that nothing was seen of: a movement that was cut off comes to rest in them, where small
/// accelerations alone would carry a head on for as long as it is lost. weights: of accelerations.
void add_standstill(const std::vector<FrameEstimate>& estimates, const Eigen::VectorXd& weights,
                    double frames, SequenceProblem& problem) {
    // Frames in which an acceleration of one deviation brings about a speed of one, 70 degrees a second of a
    // head: turns between two frames that were measured, or corrected, are usually slower
    constexpr double kGatherSpeed = 4;
    const Eigen::VectorXd slow = weights / std::pow(kGatherSpeed * frames, 2);
    for (std::size_t t = 0; t + 1 < estimates.size(); ++t) {
        if (estimates[t].held || estimates[t + 1].held) {
            const Eigen::VectorXd moved =
                slow.cwiseProduct(state_of(estimates[t + 1]).difference_from(state_of(estimates[t])).flat);
            problem.matrix.diagonal[t].diagonal() += slow;
            problem.matrix.diagonal[t + 1].diagonal() += slow;
            problem.matrix.first[t] -= slow;
            problem.pull[t] += moved;
            problem.pull[t + 1] -= moved;
        }
    }
}

/// What is moved in a frame or soon before or after it, M a frame: a movement rises and falls over several
/// frames, and one that was pulled to rest until it is large would seem to begin late.
Blocks shown_around(const std::vector<FrameEstimate>& estimates, const Blocks& steps,
                    const RestPull& rest_pull, double frames) {
    constexpr double kAround = 5;  // frames
    const int reach = std::max(1, static_cast<int>(std::lround(kAround * frames)));
    const int count = static_cast<int>(estimates.size());
    Blocks shown;
    for (int t = 0; t < count; ++t) {
        const Eigen::VectorXd& values = estimates[t].values;
        shown.push_back(rest_pull.shown(values + steps[t].tail(values.size())));
    }
    Blocks around = shown;
    for (int t = 0; t < count; ++t) {
        for (int other = std::max(0, t - reach); other <= std::min(count - 1, t + reach); ++other) {
            around[t] = around[t].cwiseMax(shown[other]);
        }
    }
    return around;
}

/// State of the alternating directions (ADMM); a similar problem starts from the last one's.
struct BoundedSteps {
    Blocks within, dual;
};

/// Frames that keep their states: their neighbours' accelerations know them, nothing moves them.
void fix_ends(const SmootherOptions& options, SequenceProblem& problem, BoundedSteps& start) {
    const auto count = static_cast<int>(problem.pull.size());
    const auto is_fixed = [&](int t) {
        return t < options.fixed_first || (t < count && t >= count - options.fixed_last);
    };
    for (int t = 0; t < count; ++t) {
        const auto at = static_cast<std::size_t>(t);
        if (is_fixed(t)) {
            problem.pull[at].setZero();
            start.within[at].setZero();
            start.dual[at].setZero();
        }
        if (is_fixed(t) || is_fixed(t + 1)) {
            problem.matrix.first[at].setZero();
        }
        if (is_fixed(t) || is_fixed(t + 2)) {
            problem.matrix.second[at].setZero();
        }
    }
}

SequenceProblem make_problem(const std::vector<FrameEstimate>& estimates, const Blocks& steps,
                             const FaceMotion& motion, const Eigen::VectorXd& upper,
                             const RestPull* rest_pull, const SmootherOptions& options) {
    const Eigen::Index num_values = motion.lower.size();
    const Eigen::Index size = 6 + num_values;
    constexpr double kDeadZone = 12;
    Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(size, size);
    rest.diagonal().head<6>().setConstant(1e-3);
    // A state lasts for several frames and each must not count the prior in full; but most of a measurement's
    // error is the model's, the same in all of them, so they must not add up against it either.
    constexpr double kFramesPerState = 6;
    const double frames = frames_a_frame(options), factor = acceleration_factor(options);
    rest.bottomRightCorner(num_values, num_values) =
        rest_covariance(motion).inverse() / std::max(1., kFramesPerState * frames);
    Eigen::VectorXd weights(size);
    weights.head<3>().setConstant(std::pow(factor * options.rotation_acceleration, -2));
    weights.segment<3>(3).setConstant(std::pow(factor * options.translation_acceleration, -2));
    weights.tail(num_values) =
        (factor * options.value_acceleration / .3 * motion.prior_std).cwiseAbs2().cwiseInverse();
    if (motion.quickness.size() > 0) {
        weights.tail(num_values).array() /= motion.quickness.array().square();
    }

    const Blocks shown = rest_pull ? shown_around(estimates, steps, *rest_pull, frames) : Blocks();
    SequenceProblem problem;
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        const FrameEstimate& estimate = estimates[t];
        problem.matrix.diagonal.push_back(estimate.information + rest);
        problem.matrix.first.push_back(Eigen::VectorXd::Zero(size));
        problem.matrix.second.push_back(Eigen::VectorXd::Zero(size));
        problem.pull.push_back(estimate.gradient);
        problem.pull.back() -= rest.rightCols(num_values) * estimate.values;
        if (rest_pull && !estimate.held) {
            const RestPull::Terms terms =
                rest_pull->at(estimate.values, estimate.values + steps[t].tail(num_values), shown[t],
                              estimate.values_std(), kDeadZone);
            problem.matrix.diagonal.back().diagonal().tail(num_values) += terms.information;
            problem.pull.back().tail(num_values) += terms.pull;
        }
        problem.lower.push_back(motion.lower - estimate.values);
        problem.upper.push_back(upper - estimate.values);
    }
    add_acceleration(estimates, weights, problem);
    add_standstill(estimates, weights, frames, problem);
    return problem;
}

/// ADMM: a smooth solve, then the bounds, until both agree [Boyd et al. 2011, over-relaxed as in 3.4.3]. Slow
/// movements are nearly free of the measurements, at a clip's ends above all: what is left of those after too
/// few rounds is not small, whatever the measured frames look like.
void solve_bounded(SequenceProblem problem, int max_iterations, const Progress& progress,
                   BoundedSteps& bounded) {
    const std::size_t count = problem.pull.size();
    const Eigen::Index size = problem.pull.front().size();
    const Eigen::Index num_values = problem.lower.front().size();
    Eigen::VectorXd penalty = Eigen::VectorXd::Zero(size);
    for (const Eigen::MatrixXd& block : problem.matrix.diagonal) {
        penalty.tail(num_values) += block.diagonal().tail(num_values) / static_cast<double>(count);
    }
    constexpr double kPenalty = .1;
    penalty *= kPenalty;
    for (Eigen::MatrixXd& block : problem.matrix.diagonal) {
        block.diagonal() += penalty;
    }
    const BlockBandedFactor factor(problem.matrix);
    auto& [within, dual] = bounded;
    Blocks steps;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
        steps = problem.pull;
        for (std::size_t t = 0; t < count; ++t) {
            steps[t] += penalty.cwiseProduct(within[t] - dual[t]);
        }
        factor.solve(steps);
        double apart = 0, moved = 0;
        for (std::size_t t = 0; t < count; ++t) {
            constexpr double kRelaxation = 1.8;
            Eigen::VectorXd wanted = steps[t] + dual[t];
            wanted.tail(num_values) += (kRelaxation - 1) * (steps[t] - within[t]).tail(num_values);
            Eigen::VectorXd inside = wanted;
            inside.tail(num_values) =
                wanted.tail(num_values).cwiseMax(problem.lower[t]).cwiseMin(problem.upper[t]);
            apart = std::max(apart, (inside - steps[t]).tail(num_values).cwiseAbs().maxCoeff());
            moved = std::max(moved, (inside - within[t]).tail(num_values).cwiseAbs().maxCoeff());
            dual[t] = wanted - inside;
            within[t] = inside;
        }
        constexpr double kAgreed = 1e-4;
        if (std::max(apart, moved) < kAgreed ||
            (progress && !progress(static_cast<double>(iteration + 1) / max_iterations))) {
            break;
        }
    }
}

struct Solution {
    BoundedSteps bounded;
    SequenceProblem problem;
    Eigen::VectorXd upper;  ///< M: of the values
};

/// Upper bounds, none of a muscle above the first that it is to have.
Eigen::VectorXd first_bounds(const FaceMotion& motion, const SmootherOptions& options) {
    Eigen::VectorXd upper = motion.upper;
    upper.head(motion.num_muscles) =
        motion.upper.head(motion.num_muscles).cwiseMin(options.first_muscle_bound);
    return upper;
}

/// Upper bounds with headroom for each muscle that stands at its first in a frame that was measured.
Eigen::VectorXd with_headroom(const std::vector<FrameEstimate>& estimates, const Solution& solution,
                              const Eigen::VectorXd& first, const FaceMotion& motion, double headroom) {
    constexpr double kAtBound = 1e-6;
    Eigen::VectorXd upper = solution.upper;
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        for (Eigen::Index i = 0; i < (estimates[t].held ? 0 : motion.num_muscles); ++i) {
            const double value = estimates[t].values[i] + solution.bounded.within[t][6 + i];
            if (value > first[i] - kAtBound) {
                upper[i] = headroom * motion.upper[i];
            }
        }
    }
    return upper;
}

/// Which values are active, and so not pulled to rest, is known once the sequence has been solved without
/// that pull (which is in the states of frames that are fixed, so that they move along there); which muscles
/// need headroom, once it has been solved within the bounds. What is active stays so as bounds are raised: no
/// work moves to other muscles, or to other frames.
Solution solve_sequence(const std::vector<FrameEstimate>& estimates, const FaceMotion& motion,
                        const SmootherOptions& options, const Progress& progress) {
    const Blocks none(estimates.size(), Eigen::VectorXd::Zero(6 + motion.lower.size()));
    const Eigen::VectorXd first = first_bounds(motion, options);
    Solution solution{{none, none}, {}, first};
    const RestPull rest_pull(motion);
    Blocks unpulled = none;
    constexpr int kBounded = 2, kMostRaises = 3;  // a muscle that goes further may take others along
    const bool may_raise = options.muscle_headroom > 1 || first != motion.upper;
    const int num_passes = may_raise ? kBounded + kMostRaises : kBounded;
    for (int pass = 0; pass < num_passes; ++pass) {
        if (pass >= kBounded) {
            const Eigen::VectorXd raised =
                with_headroom(estimates, solution, first, motion, options.muscle_headroom);
            if (raised == solution.upper) {
                break;
            }
            solution.upper = raised;
        }
        solution.problem = make_problem(estimates, unpulled, motion, solution.upper,
                                        pass > 0 ? &rest_pull : nullptr, options);
        if (pass > 0) {
            fix_ends(options, solution.problem, solution.bounded);
        }
        const Progress part = [&](double fraction) {
            return !progress || progress((pass + fraction) / num_passes);
        };
        solve_bounded(solution.problem, options.max_iterations, part, solution.bounded);
        if (pass == 0) {
            unpulled = solution.bounded.within;
        }
    }
    return solution;
}

bool fits_detail(const FrameEstimate& estimate, Eigen::Index num_detail) {
    const DetailEstimate& detail = estimate.detail;
    const Eigen::Index num_measured = estimate.held ? 0 : num_detail;
    return detail.coefficients.size() == num_detail &&
           (num_measured == 0 ||
            (detail.pull.size() == num_detail && detail.information.rows() == num_detail &&
             detail.information.cols() == num_detail && detail.coupling.rows() == num_detail &&
             detail.coupling.cols() == estimate.gradient.size() && detail.pull.allFinite() &&
             detail.information.allFinite() && detail.coupling.allFinite()));
}

void check_estimates(const std::vector<FrameEstimate>& estimates, const FaceMotion& motion) {
    const Eigen::Index size = 6 + motion.lower.size(), num_detail = motion.detail_std.size();
    if (motion.modes.rows() != motion.lower.size()) {
        throw InvalidInput("smooth: the motion has " + std::to_string(motion.modes.rows()) + " modes for " +
                           std::to_string(motion.lower.size()) + " values");
    }
    check_correlation(motion);
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        const FrameEstimate& estimate = estimates[t];
        if (estimate.values.size() + 6 != size || estimate.gradient.size() != size ||
            estimate.information.rows() != size || estimate.information.cols() != size ||
            !estimate.gradient.allFinite() || !estimate.information.allFinite() ||
            !estimate.camera_from_head.matrix().allFinite() || !fits_detail(estimate, num_detail)) {
            throw InvalidInput("smooth: estimate " + std::to_string(t) + " does not fit a face of " +
                               std::to_string(size - 6) + " values and " + std::to_string(num_detail) +
                               " detail modes or is not finite");
        }
    }
}

}  // namespace

void SmootherOptions::check() const {
    for (const auto& [name, value] : {std::pair{"value_acceleration", value_acceleration},
                                      std::pair{"rotation_acceleration", rotation_acceleration},
                                      std::pair{"translation_acceleration", translation_acceleration},
                                      std::pair{"frame_rate", frame_rate}}) {
        if (!(value > 1e-9 && value < 1e9)) {
            throw InvalidInput(std::string("SmootherOptions.") + name + " is " + std::to_string(value) +
                               "; it must be above 0 and finite");
        }
    }
    check_range("SmootherOptions.max_iterations", max_iterations, 1, 100000);
    check_range("SmootherOptions.muscle_headroom", muscle_headroom, 1., 10.);
    if (!(first_muscle_bound > 0)) {
        throw InvalidInput("SmootherOptions.first_muscle_bound is " + std::to_string(first_muscle_bound) +
                           "; it must be above 0");
    }
    check_range("SmootherOptions.fixed_first", fixed_first, 0, 100000);
    check_range("SmootherOptions.fixed_last", fixed_last, 0, 100000);
}

std::vector<FrameEstimate> smooth(const std::vector<FrameEstimate>& estimates, const FaceMotion& motion,
                                  const SmootherOptions& options, const Progress& progress) {
    options.check();
    check_estimates(estimates, motion);
    if (estimates.empty()) {
        return {};
    }
    const Solution solution = solve_sequence(estimates, motion, options, progress);
    const Blocks& steps = solution.bounded.within;
    const bool any_held =
        std::any_of(estimates.begin(), estimates.end(), [](const auto& e) { return e.held; });
    const std::vector<Eigen::MatrixXd> working =
        any_held ? BlockBandedFactor(solution.problem.matrix).inverse_diagonal()
                 : std::vector<Eigen::MatrixXd>();
    std::vector<FrameEstimate> smoothed = estimates;
    const std::vector<DetailEstimate> details = smooth_detail(
        estimates, steps, motion, acceleration_factor(options) * options.value_acceleration / .3);
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        FaceState state = state_of(estimates[t]);
        state.apply(FaceStep(steps[t]));
        smoothed[t].camera_from_head = state.camera_from_head;
        smoothed[t].values = state.values.cwiseMax(motion.lower).cwiseMin(solution.upper);
        // Model error stays the same from frame to frame: neighbours average noise only, so a measured
        // frame keeps its own uncertainty.
        if (estimates[t].held) {
            smoothed[t].covariance = working[t];
        }
        smoothed[t].gradient = estimates[t].gradient - estimates[t].information * steps[t];
        smoothed[t].detail = details[t];
    }
    return smoothed;
}

}  // namespace mimetic
