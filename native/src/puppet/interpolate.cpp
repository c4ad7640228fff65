// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/puppet/interpolate.hpp>
#include <mimetic/shared/checks.hpp>
#include <vector>

#include "shared/robust.hpp"
#include "solve/bounded_step.hpp"

namespace mimetic {

namespace {

constexpr int kFolds = 5;  // of neighbours in time, which are much alike: left out together
// Widths of the Gaussian that are tried, in the examples' median distance
constexpr std::array<double, 4> kWidths{.25, .5, 1, 2};
constexpr double kSumWeight = 1e4;                   // of the weights' sum being 1, beside the state
constexpr double kLeastSpread = .01;                 // of a template's scores: less is noise
constexpr double kRidge = 1e-8;                      // makes the solution unique where corners coincide
constexpr double kLeastMu = 1e-8, kGreatestMu = 10;  // tried by cross-validation, in powers of ten

/// Rows x columns of distances between rows.
Eigen::MatrixXd distances_between(const MatrixRows& a, const MatrixRows& b) {
    Eigen::MatrixXd all(a.rows(), b.rows());
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
        all.col(j) = (a.rowwise() - b.row(j)).rowwise().norm();
    }
    return all;
}

/// Values of the basis, of the order of 1.
Eigen::MatrixXd basis_of(Basis basis, const Eigen::MatrixXd& distances, double width) {
    if (basis == Basis::linear) {
        return distances / width;
    }
    return (-.5 * (distances / width).array().square()).exp();
}

/// c of a = C g: K x m.
Eigen::MatrixXd solve_weights(const Eigen::MatrixXd& square, const Eigen::MatrixXd& right, double mu) {
    const double scale = square.trace() / static_cast<double>(square.rows());
    Eigen::MatrixXd damped = square;
    damped.diagonal().array() += mu * std::max(scale, 1e-12) + 1e-14;
    return damped.ldlt().solve(right);
}

/// Which fold each example is left out with.
std::vector<int> folds_of(Eigen::Index count) {
    const Eigen::Index number = count < 2 * kFolds ? count : kFolds;
    std::vector<int> folds(static_cast<std::size_t>(count));
    for (Eigen::Index k = 0; k < count; ++k) {
        folds[static_cast<std::size_t>(k)] = static_cast<int>(k * number / count);
    }
    return folds;
}

/// What is missed when folds are left out, for several strengths of regularisation.
struct Validation {
    std::vector<Eigen::VectorXd> squares;  // of each strength: m, summed
    std::vector<double> nearest;           // of each example from those that are not left out with it
};

Validation validate(const Eigen::MatrixXd& g, const Eigen::MatrixXd& distances, const MatrixRows& states,
                    const std::vector<double>& strengths) {
    Validation validation;
    validation.squares.assign(strengths.size(), Eigen::VectorXd::Zero(states.cols()));
    const std::vector<int> folds = folds_of(g.rows());
    for (int fold = 0; fold <= folds.back(); ++fold) {
        std::vector<int> inside, outside;
        for (int k = 0; k < g.rows(); ++k) {
            (folds[static_cast<std::size_t>(k)] == fold ? outside : inside).push_back(k);
        }
        const Eigen::MatrixXd own = g(inside, inside), across = g(outside, inside);
        const Eigen::MatrixXd square = own * own, right = own * states(inside, Eigen::all);
        for (std::size_t i = 0; i < strengths.size(); ++i) {
            const Eigen::MatrixXd missed =
                across * solve_weights(square, right, strengths[i]) - states(outside, Eigen::all);
            validation.squares[i] += missed.colwise().squaredNorm().transpose();
        }
        for (const int k : outside) {
            validation.nearest.push_back(distances(k, inside).minCoeff());
        }
    }
    return validation;
}

/// What is missed of all values, each counted by its spread.
double missed_by(const Eigen::VectorXd& squares, const MatrixRows& states) {
    const Eigen::ArrayXd spread = states.colwise().squaredNorm().transpose().array();
    return (squares.array() / (spread + 1e-3 * static_cast<double>(states.rows()))).sum();
}

std::vector<double> strengths_of(const InterpolationOptions& options) {
    if (options.regularisation > 0) {
        return {options.regularisation};
    }
    std::vector<double> strengths;
    for (double mu = kLeastMu; mu <= 1.01 * kGreatestMu; mu *= 10) {
        strengths.push_back(mu);
    }
    return strengths;
}

double positive(double width) { return std::isfinite(width) && width > 1e-9 ? width : 1; }

std::vector<double> widths_of(Basis basis, const Eigen::MatrixXd& distances) {
    std::vector<double> apart;
    for (Eigen::Index k = 0; k < distances.rows(); ++k) {
        for (Eigen::Index l = 0; l < k; ++l) {
            apart.push_back(distances(k, l));
        }
    }
    const double usual = upper_median(apart);
    if (basis == Basis::linear) {
        return {positive(usual)};
    }
    std::vector<double> widths;
    widths.reserve(kWidths.size());
    for (const double factor : kWidths) {
        widths.push_back(positive(factor * usual));
    }
    return widths;
}

}  // namespace

void InterpolationOptions::check() const { check_range("regularisation", regularisation, 0, 1e3); }

Interpolation::Interpolation(MatrixIn scores, MatrixIn states, VectorIn lower, VectorIn upper,
                             const InterpolationOptions& options)
    : basis_(options.basis), lower_(lower), upper_(upper) {
    options.check();
    const Eigen::Index count = scores.rows();
    require(count >= 1 && count <= 1000 && scores.cols() >= 1 && scores.cols() <= 1000,
            "1 to 1000 examples by 1 to 1000 templates can be interpolated");
    require(states.rows() == count && states.cols() >= 1, "each example needs its scores and its state");
    require(lower.size() == states.cols() && upper.size() == states.cols(),
            "each value of the state needs a lower and an upper limit");
    require(scores.allFinite() && states.allFinite(), "scores and states must be finite");
    mean_ = states.colwise().mean().transpose();
    const MatrixRows values = states.rowwise() - mean_.transpose();
    // A template whose scores vary little says as much as one whose scores vary a lot
    const Eigen::RowVectorXd middle = scores.colwise().mean();
    per_score_ = ((scores.rowwise() - middle).colwise().squaredNorm() / static_cast<double>(count))
                     .cwiseSqrt()
                     .cwiseMax(kLeastSpread)
                     .cwiseInverse()
                     .transpose();
    scores_ = scores * per_score_.asDiagonal();
    const Eigen::MatrixXd distances = distances_between(scores_, scores_);
    const std::vector<double> widths = widths_of(basis_, distances), strengths = strengths_of(options);
    width_ = widths.front();
    regularisation_ = strengths.front();
    error_ = Eigen::VectorXd::Zero(values.cols());
    double least = std::numeric_limits<double>::infinity();
    for (const double width : count > 1 ? widths : std::vector<double>{}) {
        Validation validation = validate(basis_of(basis_, distances, width), distances, values, strengths);
        usual_distance_ = upper_median(validation.nearest);
        for (std::size_t i = 0; i < strengths.size(); ++i) {
            const double missed = missed_by(validation.squares[i], values);
            if (missed < least) {
                least = missed;
                width_ = width;
                regularisation_ = strengths[i];
                error_ = (validation.squares[i] / static_cast<double>(count)).cwiseSqrt();
            }
        }
    }
    const Eigen::MatrixXd g = basis_of(basis_, distances, width_);
    // Distances to one example say nothing
    weights_ = basis_ == Basis::linear && count == 1 ? Eigen::MatrixXd::Zero(1, values.cols())
                                                     : solve_weights(g * g, g * values, regularisation_);
}

Eigen::VectorXd Interpolation::distances(VectorIn scores) const {
    require(scores.size() == scores_.cols(), "there must be one score a template");
    return (scores_.rowwise() - scores.cwiseProduct(per_score_).transpose()).rowwise().norm();
}

Eigen::VectorXd Interpolation::state(VectorIn scores) const {
    const Eigen::VectorXd g = basis_of(basis_, distances(scores), width_);
    return (mean_ + weights_.transpose() * g).cwiseMax(lower_).cwiseMin(upper_);
}

Eigen::VectorXd Interpolation::std(VectorIn scores) const {
    const double nearest = distances(scores).minCoeff();
    const double further = usual_distance_ > 0 ? std::max(1., nearest / usual_distance_) : 1;
    return further * error_;
}

Eigen::VectorXd hull_weights(MatrixIn corners, VectorIn state) {
    const Eigen::Index count = corners.rows();
    require(count >= 1 && count <= 1000, "a hull has 1 to 1000 corners");
    require(corners.cols() == state.size(), "the state has another number of values than the corners");
    const double scale = std::max(1e-6, corners.rowwise().squaredNorm().maxCoeff());
    Eigen::MatrixXd information = corners * corners.transpose() / scale;
    information.array() += kSumWeight;
    information.diagonal().array() += kRidge;
    const Eigen::VectorXd gradient = (corners * state / scale).array() + kSumWeight;
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(count);
    const Eigen::VectorXd most = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
    const Eigen::VectorXd weights = bounded_step(information, gradient, zero, most).cwiseMax(0);
    return weights / weights.sum();
}

}  // namespace mimetic
