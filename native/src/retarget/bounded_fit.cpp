// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/retarget/bounded_fit.hpp>
#include <mimetic/shared/checks.hpp>
#include <vector>

namespace mimetic {
namespace {

constexpr int kMostRounds = 200;
constexpr int kStops = 8;             // of unknowns at 0 or a bound, in one attempt to end exactly
constexpr int kSweeps = 10;           // of coordinate descent, between attempts to end exactly
constexpr double kTolerance = 1e-10;  // of a condition, over the largest of the problem's slopes
constexpr double kLeast = 1e-12;      // of a diagonal, over the largest

/// What is left of a slope once `sparsity` has taken its part.
double shrunk(double slope, double sparsity) {
    return std::copysign(std::max(0., std::abs(slope) - sparsity), slope);
}

class Descent {
public:
    Descent(const BoundedProblem& problem, VectorIn start)
        : problem_(problem), at_(start.cwiseMax(problem.lowest).cwiseMin(problem.highest)) {
        const double least = kLeast * std::max(1e-300, problem.hessian.diagonal().maxCoeff());
        for (Eigen::Index k = 0; k < at_.size(); ++k) {
            if (problem.hessian(k, k) > least) {
                moving_.push_back(k);
            } else {
                at_[k] = 0;
            }
        }
        rest_ = problem.linear - problem.hessian * at_;
        scale_ = std::max(1e-300, problem.linear.cwiseAbs().maxCoeff());
    }

    Eigen::VectorXd run() {
        for (int round = 0; round < kMostRounds && !is_minimum(at_); ++round) {
            for (int i = 0; i < kSweeps; ++i) {
                sweep();
            }
            end_exactly();
        }
        return at_;
    }

private:
    void sweep() {
        for (const Eigen::Index k : moving_) {
            const double diagonal = problem_.hessian(k, k);
            const double slope = shrunk(rest_[k] + diagonal * at_[k], problem_.sparsity[k]);
            const double next = std::clamp(slope / diagonal, problem_.lowest[k], problem_.highest[k]);
            if (next != at_[k]) {
                rest_ -= (next - at_[k]) * problem_.hessian.col(k);
                at_[k] = next;
            }
        }
    }

    /// Towards the minimum over the unknowns that are neither 0 nor at a bound; those that come to 0 or to a
    /// bound on the way stay there.
    void end_exactly() {
        for (int stop = 0; stop < kStops && !step_freely(); ++stop) {
        }
        rest_ = problem_.linear - problem_.hessian * at_;
    }

    /// Whether that minimum was reached, or nothing can be done; else one unknown more is at 0 or a bound.
    bool step_freely() {
        std::vector<Eigen::Index> free;
        for (const Eigen::Index k : moving_) {
            if (at_[k] != 0 && at_[k] > problem_.lowest[k] && at_[k] < problem_.highest[k]) {
                free.push_back(k);
            }
        }
        if (free.empty()) {
            return true;
        }
        Eigen::VectorXd slopes = rest_(free);
        for (std::size_t i = 0; i < free.size(); ++i) {
            slopes[static_cast<Eigen::Index>(i)] -= std::copysign(problem_.sparsity[free[i]], at_[free[i]]);
        }
        const Eigen::MatrixXd block = problem_.hessian(free, free);
        const Eigen::LLT<Eigen::MatrixXd> factor(block);
        if (factor.info() != Eigen::Success) {
            return true;
        }
        const Eigen::VectorXd step = factor.solve(slopes);
        if (!step.allFinite()) {
            return true;
        }
        double share = 1, end = 0;
        Eigen::Index first = -1;
        for (std::size_t i = 0; i < free.size(); ++i) {
            const Eigen::Index k = free[i];
            const double way = step[static_cast<Eigen::Index>(i)];
            const double limit =
                way > 0 ? (at_[k] < 0 ? 0 : problem_.highest[k]) : (at_[k] > 0 ? 0 : problem_.lowest[k]);
            if (way != 0 && (limit - at_[k]) / way < share) {
                share = (limit - at_[k]) / way;
                first = k;
                end = limit;
            }
        }
        at_(free) += share * step;
        if (first >= 0) {
            at_[first] = end;
        }
        rest_ = problem_.linear - problem_.hessian * at_;
        return first < 0;
    }

    bool is_minimum(const Eigen::VectorXd& at) const {
        const Eigen::VectorXd violation = problem_.violation(at);
        return std::all_of(moving_.begin(), moving_.end(),
                           [&](Eigen::Index k) { return violation[k] <= kTolerance * scale_; });
    }

    const BoundedProblem& problem_;
    Eigen::VectorXd at_, rest_;  // rest: the slope that is left without sparsity
    std::vector<Eigen::Index> moving_;
    double scale_ = 1;
};

}  // namespace

void BoundedProblem::check() const {
    const Eigen::Index count = linear.size();
    require(hessian.rows() == count && hessian.cols() == count && sparsity.size() == count &&
                lowest.size() == count && highest.size() == count,
            "a bounded fit needs a slope, a sparsity and two bounds for each unknown");
    require(hessian.allFinite() && linear.allFinite() && lowest.allFinite() && highest.allFinite(),
            "the numbers of a bounded fit must be finite");
    for (Eigen::Index k = 0; k < count; ++k) {
        check_range("sparsity of a bounded fit", sparsity[k], 0, 1e300);
        check_range("lowest of a bounded fit", lowest[k], -1e300, 0);
        check_range("highest of a bounded fit", highest[k], 0, 1e300);
    }
}

double BoundedProblem::value(VectorIn at) const {
    return .5 * at.dot(hessian * at) - linear.dot(at) + sparsity.dot(at.cwiseAbs());
}

Eigen::VectorXd BoundedProblem::violation(VectorIn at) const {
    const Eigen::VectorXd slope = linear - hessian * at;
    Eigen::VectorXd violation(at.size());
    for (Eigen::Index k = 0; k < at.size(); ++k) {
        // How much lower it gets a step upward and a step downward
        const double up = at[k] >= 0 ? slope[k] - sparsity[k] : slope[k] + sparsity[k];
        const double down = at[k] <= 0 ? -slope[k] - sparsity[k] : sparsity[k] - slope[k];
        violation[k] = std::max({0., at[k] < highest[k] ? up : 0, at[k] > lowest[k] ? down : 0});
    }
    return violation;
}

Eigen::VectorXd fit_bounded(const BoundedProblem& problem, VectorIn start) {
    problem.check();
    require(start.size() == problem.linear.size() && start.allFinite(),
            "a bounded fit starts from a finite value for each unknown");
    if (start.size() == 0) {
        return start;  // a character without controls, or a capture without what moves them
    }
    return Descent(problem, start).run();
}

}  // namespace mimetic
