// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/head/pose_smoothing.hpp>
#include <mimetic/shared/covariance.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

namespace mimetic {

namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

constexpr std::size_t kJudgedFrames = 600;  // enough to estimate how much a head moves
constexpr double kUnknownRate = 3;          // rad/s and m/s, standard deviation before the first frame
constexpr double kLongestGap = .5;          // seconds: what comes later says nothing of the motion before
constexpr double kLeastStd = 1e-6;          // rad and m: a floor, so that a covariance of 0 can be inverted

/// Densities of angular (rad^2/s^3) and linear (m^2/s^3) acceleration.
using Liveliness = Eigen::Vector2d;

/// Poses as vectors about the clip's mean, with their noise.
struct Measurements {
    std::vector<Vector6> values;
    std::vector<Matrix6> noise;
    std::vector<double> seconds;
    std::vector<bool> counts;

    double step(std::size_t i) const { return seconds[i] - seconds[i - 1]; }
};

/// Frames from one that counts to another, without a long gap between.
struct Stretch {
    std::size_t first, last;
};

std::vector<Stretch> stretches_of(const Measurements& measured) {
    std::vector<Stretch> stretches;
    for (std::size_t i = 0; i < measured.counts.size(); ++i) {
        if (!measured.counts[i]) {
            continue;
        }
        if (stretches.empty() ||
            measured.seconds[i] - measured.seconds[stretches.back().last] > kLongestGap) {
            stretches.push_back({i, i});
        }
        stretches.back().last = i;
    }
    return stretches;
}

struct Belief {
    Vector12 state;
    Matrix12 spread;
};

Belief first_belief(const Measurements& measured, std::size_t first) {
    Belief belief;
    belief.state << measured.values[first], Vector6::Zero();
    belief.spread = kUnknownRate * kUnknownRate * Matrix12::Identity();
    belief.spread.topLeftCorner<6, 6>() = measured.noise[first];
    return belief;
}

/// The state a step (seconds) later, by its rates.
Matrix12 ahead(double step) {
    Matrix12 matrix = Matrix12::Identity();
    matrix.topRightCorner<6, 6>().diagonal().setConstant(step);
    return matrix;
}

/// Covariance that random accelerations add in a step.
Matrix12 acceleration(double step, const Liveliness& liveliness) {
    Vector6 density;
    density << Eigen::Vector3d::Constant(liveliness[0]), Eigen::Vector3d::Constant(liveliness[1]);
    Matrix12 added = Matrix12::Zero();
    added.topLeftCorner<6, 6>().diagonal() = density * (step * step * step / 3);
    added.topRightCorner<6, 6>().diagonal() = density * (step * step / 2);
    added.bottomLeftCorner<6, 6>().diagonal() = density * (step * step / 2);
    added.bottomRightCorner<6, 6>().diagonal() = density * step;
    return added;
}

Belief predicted(const Belief& belief, double step, const Liveliness& liveliness) {
    const Matrix12 forward = ahead(step);
    return {forward * belief.state,
            forward * belief.spread * forward.transpose() + acceleration(step, liveliness)};
}

/// Updates with a measurement; returns the logarithm of its likelihood but for a constant, twice.
double correct(Belief& belief, const Vector6& value, const Matrix6& noise) {
    const Vector6 innovation = value - belief.state.head<6>();
    const Matrix6 expected = belief.spread.topLeftCorner<6, 6>() + noise;
    const Eigen::PartialPivLU<Matrix6> solver(expected);
    const Eigen::Matrix<double, 12, 6> gain = solver.solve(belief.spread.topRows<6>()).transpose();
    belief.state += gain * innovation;
    belief.spread -= gain * expected * gain.transpose();
    belief.spread = .5 * (belief.spread + belief.spread.transpose()).eval();
    const double log_determinant = solver.matrixLU().diagonal().array().abs().log().sum();
    return -innovation.dot(solver.solve(innovation)) - log_determinant;
}

double log_likelihood(const Measurements& measured, const Liveliness& liveliness) {
    const std::size_t end = std::min(measured.values.size(), kJudgedFrames);
    double total = 0;
    for (const Stretch& stretch : stretches_of(measured)) {
        Belief belief = first_belief(measured, stretch.first);
        for (std::size_t i = stretch.first + 1; i <= stretch.last && i < end; ++i) {
            belief = predicted(belief, measured.step(i), liveliness);
            if (measured.counts[i]) {
                total += correct(belief, measured.values[i], measured.noise[i]);
            }
        }
    }
    return total;
}

/// The densities, from a still head to a shaken one, under which the poses are most likely.
Liveliness judge_liveliness(const Measurements& measured) {
    constexpr int kNumDensities = 9;
    constexpr std::array<int, 2> kLeastPower{-5, -7};
    Liveliness best(.1, 1e-3);
    if (stretches_of(measured).front().first + 1 >= kJudgedFrames) {
        return best;
    }
    for (const int axis : {0, 1, 0}) {
        double largest = -std::numeric_limits<double>::infinity();
        Liveliness tried = best;
        for (int k = 0; k < kNumDensities; ++k) {
            tried[axis] = std::pow(10., kLeastPower[static_cast<std::size_t>(axis)] + k);
            const double likelihood = log_likelihood(measured, tried);
            if (likelihood > largest) {
                largest = likelihood;
                best[axis] = tried[axis];
            }
        }
    }
    return best;
}

/// Smoothed states of a stretch's frames.
std::vector<Belief> smoothed(const Measurements& measured, const Stretch& stretch,
                             const Liveliness& liveliness) {
    std::vector<Belief> beliefs{first_belief(measured, stretch.first)}, expected;
    for (std::size_t i = stretch.first + 1; i <= stretch.last; ++i) {
        expected.push_back(predicted(beliefs.back(), measured.step(i), liveliness));
        beliefs.push_back(expected.back());
        if (measured.counts[i]) {
            correct(beliefs.back(), measured.values[i], measured.noise[i]);
        }
    }
    for (std::size_t i = beliefs.size() - 1; i-- > 0;) {
        const Matrix12 forward = ahead(measured.step(stretch.first + i + 1));
        const Matrix12 gain =
            beliefs[i].spread * forward.transpose() * expected[i].spread.partialPivLu().inverse();
        beliefs[i].state += gain * (beliefs[i + 1].state - expected[i].state);
        beliefs[i].spread += gain * (beliefs[i + 1].spread - expected[i].spread) * gain.transpose();
    }
    return beliefs;
}

/// Between stretches evenly from one to the next; before the first and after the last one the head stays.
void bridge_gaps(const std::vector<Stretch>& stretches, const std::vector<double>& seconds,
                 std::vector<Vector6>& states) {
    std::fill(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(stretches.front().first),
              states[stretches.front().first]);
    std::fill(states.begin() + static_cast<std::ptrdiff_t>(stretches.back().last), states.end(),
              Vector6(states[stretches.back().last]));
    for (std::size_t k = 0; k + 1 < stretches.size(); ++k) {
        const std::size_t from = stretches[k].last, to = stretches[k + 1].first;
        for (std::size_t i = from + 1; i < to; ++i) {
            const double share = (seconds[i] - seconds[from]) / (seconds[to] - seconds[from]);
            states[i] = (1 - share) * states[from] + share * states[to];
        }
    }
}

void check(const PoseSequence& motion, VectorIn seconds, const std::vector<bool>& measured, double strength) {
    if (!std::isfinite(strength) || strength < 0) {
        throw InvalidInput("smoothing is " + std::to_string(strength) + "; it must be 0 or more");
    }
    const std::size_t count = motion.poses.size();
    if (motion.covariances.size() != count || static_cast<std::size_t>(seconds.size()) != count ||
        measured.size() != count) {
        throw InvalidInput(std::to_string(count) + " poses with " +
                           std::to_string(motion.covariances.size()) + " covariances, " +
                           std::to_string(seconds.size()) + " times and " + std::to_string(measured.size()) +
                           " marks: there must be one of each a pose");
    }
    for (Eigen::Index i = 1; i < seconds.size(); ++i) {
        if (!(seconds[i] > seconds[i - 1])) {
            throw InvalidInput("the times of poses must rise: " + std::to_string(seconds[i]) + " s follows " +
                               std::to_string(seconds[i - 1]) + " s");
        }
    }
}

Measurements about(const PoseSequence& motion, const Eigen::Matrix3d& reference, VectorIn seconds,
                   const std::vector<bool>& counts, double strength) {
    Measurements measured;
    Rotations turns;
    for (const Eigen::Isometry3d& pose : motion.poses) {
        turns.push_back(pose.linear() * reference.transpose());
    }
    const Points vectors = rotation_vectors(turns);
    for (std::size_t i = 0; i < motion.poses.size(); ++i) {
        const Eigen::Vector3d vector = vectors.row(static_cast<Eigen::Index>(i)).transpose();
        Vector6 value;
        value << vector, motion.poses[i].translation();
        measured.values.push_back(value);
        Matrix6 to_local = Matrix6::Identity();
        to_local.topLeftCorner<3, 3>() = inverse_left_jacobian(vector);
        const Matrix6 covariance = motion.covariances[i] + kLeastStd * kLeastStd * Matrix6::Identity();
        measured.noise.push_back(strength * strength * to_local * covariance * to_local.transpose());
    }
    measured.seconds.assign(seconds.begin(), seconds.end());
    measured.counts = counts;
    return measured;
}

}  // namespace

PoseSequence smooth_poses(const PoseSequence& motion, VectorIn seconds, const std::vector<bool>& measured,
                          double strength) {
    check(motion, seconds, measured, strength);
    if (strength == 0 || std::count(measured.begin(), measured.end(), true) < 3) {
        return motion;
    }
    Rotations counted;
    for (std::size_t i = 0; i < measured.size(); ++i) {
        if (measured[i]) {
            counted.push_back(motion.poses[i].linear());
        }
    }
    const Eigen::Matrix3d reference = mean_rotation(counted);
    const Measurements values = about(motion, reference, seconds, measured, strength);
    const Liveliness liveliness = judge_liveliness(values);
    PoseSequence result = motion;
    std::vector<Vector6> states(motion.poses.size());
    const std::vector<Stretch> stretches = stretches_of(values);
    for (const Stretch& stretch : stretches) {
        const std::vector<Belief> beliefs = smoothed(values, stretch, liveliness);
        for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
            const Belief& belief = beliefs[i - stretch.first];
            states[i] = belief.state.head<6>();
            Matrix6 back = Matrix6::Identity();
            back.topLeftCorner<3, 3>() = inverse_left_jacobian(states[i].head<3>()).inverse();
            const Matrix6 spread = back * belief.spread.topLeftCorner<6, 6>() * back.transpose();
            result.covariances[i] = .5 * (spread + spread.transpose());
        }
    }
    bridge_gaps(stretches, values.seconds, states);
    for (std::size_t i = 0; i < result.poses.size(); ++i) {
        result.poses[i].linear() = rotation_from_vector(states[i].head<3>()) * reference;
        result.poses[i].translation() = states[i].tail<3>();
        if (!result.poses[i].matrix().allFinite() || !is_covariance(result.covariances[i])) {
            throw InvalidInput(
                "the head's motion cannot be smoothed: its covariances or its times are beyond what a "
                "capture "
                "gives; smooth by 0, or capture the footage again");
        }
    }
    return result;
}

}  // namespace mimetic
