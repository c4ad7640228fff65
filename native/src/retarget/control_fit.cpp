// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/retarget/bounded_fit.hpp>
#include <mimetic/retarget/control_fit.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kReadingRidge = 1e-3;  // of a source's own response: sources that do nearly the same share
constexpr double kMostNumbers = 2e8;    // of displacements, 1.6 GB
constexpr int kMostHolds = 12;          // rounds in which pairs come to be held, or are let go
constexpr Eigen::Index kBlock = 1024;   // vertices weighted at once

void check_range_rows(MatrixIn range, Eigen::Index count, const char* what) {
    require(range.rows() == count && range.cols() == 2 && range.allFinite() &&
                (count == 0 || (range.col(0).maxCoeff() <= 0 && range.col(1).minCoeff() >= 0)),
            std::string("each of the ") + what + " needs a lowest value up to 0 and a highest from 0");
}

/// How far the displacements (K x 3V) move each pair apart, along its way: K x P.
Eigen::MatrixXd apart(MatrixIn displacements, const TiedVertices& tied) {
    Eigen::MatrixXd lengths(displacements.rows(), tied.pairs.rows());
    for (Eigen::Index p = 0; p < tied.pairs.rows(); ++p) {
        lengths.col(p) = (displacements.middleCols(3 * Eigen::Index{tied.pairs(p, 0)}, 3) -
                          displacements.middleCols(3 * Eigen::Index{tied.pairs(p, 1)}, 3)) *
                         tied.ways.row(p).transpose();
    }
    return lengths;
}

double share_left(double squared, double dot, double length) {
    return length > 0 ? 1 - (squared - 2 * dot + length) / length : 0;
}

}  // namespace

void ControlFitOptions::check() const {
    check_range("ControlFitOptions.sparsity", sparsity, 0, 1);
    check_range("ControlFitOptions.ridge", ridge, 0, 10);
    check_range("ControlFitOptions.unmatched_motion", unmatched_motion, 1e-12, 1);
    check_range("ControlFitOptions.least_explained", least_explained, 0, 1);
    check_range("ControlFitOptions.value_match", value_match, 0, 10);
    check_range("ControlFitOptions.tied_reading", tied_reading, 0, 10);
    check_range("ControlFitOptions.hold_shut", hold_shut, 0, 1000);
    check_range("ControlFitOptions.hold_slack", hold_slack, 0, 1000);
}

ControlFit::ControlFit(MatrixIn controls, MatrixIn sources, VectorIn weights, MatrixIn control_range,
                       MatrixIn source_range, const ControlFitOptions& options, const TiedVertices& tied)
    : options_(options), tied_(tied), control_range_(control_range), source_range_(source_range) {
    options.check();
    require(controls.cols() == 3 * weights.size() && sources.cols() == controls.cols(),
            "controls and sources must displace the same vertices, each of which has a weight");
    require(static_cast<double>(controls.size()) + static_cast<double>(sources.size()) <= kMostNumbers,
            "there are too many controls for so many vertices");
    require(controls.allFinite() && sources.allFinite(), "displacements must be finite");
    require(weights.allFinite() && (weights.size() == 0 || weights.minCoeff() >= 0),
            "weights of vertices must be finite and at least 0");
    check_range_rows(control_range, controls.rows(), "controls");
    check_range_rows(source_range, sources.rows(), "sources");
    of_controls_ = Eigen::MatrixXd::Zero(controls.rows(), controls.rows());
    of_sources_ = Eigen::MatrixXd::Zero(sources.rows(), sources.rows());
    of_both_ = Eigen::MatrixXd::Zero(controls.rows(), sources.rows());
    for (Eigen::Index begin = 0; begin < weights.size(); begin += kBlock) {
        const Eigen::Index count = std::min(kBlock, weights.size() - begin);
        const Eigen::RowVectorXd scale =
            weights.segment(begin, count).transpose().replicate(3, 1).reshaped().transpose();
        const auto own = controls.middleCols(3 * begin, 3 * count);
        const auto other = sources.middleCols(3 * begin, 3 * count);
        const MatrixRows weighted = other.array().rowwise() * scale.array();
        of_controls_ += (own.array().rowwise() * scale.array()).matrix() * own.transpose();
        of_sources_ += weighted * other.transpose();
        of_both_ += own * weighted.transpose();
    }
    tied.check(weights.size());
    parted_ = apart(controls, tied);
    left_apart_ = apart(sources, tied);
    read();
    tie();
    weigh_sources();
}

void ControlFit::read() {
    const Eigen::Index num_controls = of_controls_.rows(), num_sources = of_sources_.rows();
    readings_ = MatrixRows::Zero(num_controls, num_sources);
    readable_ = Eigen::VectorXd::Zero(num_controls);
    const Eigen::MatrixXd seen = left_apart_ * (options_.tied_reading * tied_.weights).asDiagonal();
    const Eigen::MatrixXd both = of_both_ + parted_ * seen.transpose();
    BoundedProblem problem;
    problem.hessian = of_sources_ + seen * left_apart_.transpose();
    problem.hessian.diagonal() *= 1 + kReadingRidge;
    problem.sparsity = options_.sparsity * problem.hessian.diagonal();
    for (Eigen::Index k = 0; k < num_controls; ++k) {
        // Within the sources' bounds, as a capture would see it: lids that are shut are a full blink, however
        // far the character's own key takes them
        const double reach = of_controls_(k, k);
        problem.linear = both.row(k).transpose();
        problem.lowest = source_range_.col(0);
        problem.highest = source_range_.col(1);
        const Eigen::VectorXd reading = fit_bounded(problem, Eigen::VectorXd::Zero(num_sources));
        readings_.row(k) = reading.transpose();
        const double made = reading.dot(of_sources_ * reading);
        const double along = std::max(0., of_both_.row(k).dot(reading));
        readable_[k] = made > 0 && reach > 0 ? std::min(1., along * along / (made * reach)) : 0;
    }
    // A control stands for what sources can make of it, and a little for all of itself: the more, the less of
    // it they can make, as others that do nearly nothing else would cost nothing
    whole_ = readable_.unaryExpr(
        [&](double readable) { return std::pow(options_.unmatched_motion, .5 * readable); });
    const Eigen::MatrixXd own = whole_.asDiagonal();
    const Eigen::MatrixXd read = (1 - whole_.array()).matrix().asDiagonal() * readings_;
    const Eigen::MatrixXd crossed = own * of_both_ * read.transpose();
    hessian_ =
        own * of_controls_ * own + read * of_sources_ * read.transpose() + crossed + crossed.transpose();
    slopes_ = read * of_sources_ + own * of_both_;
    const Eigen::MatrixXd matched = read * (options_.value_match * of_sources_.diagonal()).asDiagonal();
    hessian_ += matched * read.transpose();
    slopes_ += matched;
    scale_ = hessian_.diagonal();
}

void ControlFit::tie() {
    // As in the fit itself, a control stands for its reading: lids that a key takes further than shut are
    // shut
    const Eigen::MatrixXd played =
        whole_.asDiagonal() * parted_ + (1 - whole_.array()).matrix().asDiagonal() * readings_ * left_apart_;
    const Eigen::MatrixXd weighted = played * tied_.weights.asDiagonal();
    hessian_ += weighted * played.transpose();
    slopes_ += weighted * left_apart_.transpose();
}

BoundedProblem ControlFit::problem() const {
    BoundedProblem problem;
    problem.hessian = hessian_;
    problem.hessian.diagonal() += options_.ridge * scale_;
    problem.sparsity = options_.sparsity * scale_;
    problem.lowest = control_range_.col(0);
    problem.highest = control_range_.col(1);
    return problem;
}

MatrixRows ControlFit::frames(MatrixIn values, MatrixIn expected) const {
    const Eigen::Index num_controls = of_controls_.rows();
    require(values.cols() == of_sources_.rows() && values.allFinite(),
            "a row of values needs a finite one for each source");
    require(expected.rows() == values.rows() && expected.cols() == num_controls && expected.allFinite(),
            "a row of expected values needs a finite one for each control");
    const MatrixRows slopes = slopes_ * (source_explained_.array() < options_.least_explained)
                                            .select(0., Eigen::VectorXd::Ones(values.cols()).array())
                                            .matrix()
                                            .asDiagonal();
    BoundedProblem now = problem();
    MatrixRows fitted(values.rows(), num_controls);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(num_controls);
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
        now.linear = slopes * values.row(i).transpose() +
                     options_.ridge * scale_.cwiseProduct(expected.row(i).transpose());
        start = fit_bounded(now, start);
        fitted.row(i) = held_shut(now, start, most_apart(values.row(i).transpose())).transpose();
    }
    return fitted;
}

/// How far the controls may move each tied pair apart where sources have these values (S): P.
Eigen::VectorXd ControlFit::most_apart(VectorIn values) const {
    const Eigen::VectorXd open = tied_.open + left_apart_.transpose() * values;
    Eigen::VectorXd widest = Eigen::VectorXd::Zero(open.size() > 0 ? tied_.rims.maxCoeff() + 1 : 0);
    for (Eigen::Index p = 0; p < open.size(); ++p) {
        widest[tied_.rims[p]] = std::max(widest[tied_.rims[p]], open[p]);
    }
    return open.cwiseMax(-tied_.pressed) + options_.hold_slack * widest(tied_.rims) - tied_.open;
}

/// The minimum that counts tied pairs too, as far as the controls move them further apart than most (P).
/// fitted: K, the minimum of the problem itself. A problem of one-sided squares, by Newton's method.
Eigen::VectorXd ControlFit::held_shut(const BoundedProblem& problem, const Eigen::VectorXd& fitted,
                                      VectorIn most) const {
    const Eigen::VectorXd weights = options_.hold_shut * tied_.weights;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(most.size());
    Eigen::VectorXd at = fitted, held = none;
    for (int round = 0; round < kMostHolds; ++round) {
        const Eigen::VectorXd over = parted_.transpose() * at - most;
        const Eigen::VectorXd parted = (over.array() > 0).select(weights, none);
        if (parted == held) {
            break;
        }
        held = parted;
        BoundedProblem holding = problem;
        const Eigen::MatrixXd rows = parted_ * held.asDiagonal();
        holding.hessian += rows * parted_.transpose();
        holding.linear += rows * most;
        at = fit_bounded(holding, at);
    }
    return at;
}

MatrixRows ControlFit::mapping() const {
    const Eigen::Index num_controls = of_controls_.rows(), num_sources = of_sources_.rows();
    MatrixRows rows = MatrixRows::Zero(2 * num_sources, num_controls);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(num_controls);
    BoundedProblem now = problem();
    for (Eigen::Index s = 0; s < num_sources; ++s) {
        for (const int side : {1, 0}) {
            const double height = source_range_(s, side);
            if (height != 0) {
                now.linear = height * slopes_.col(s);
                rows.row(2 * s + 1 - side) = fit_bounded(now, none).transpose() / std::abs(height);
            }
        }
    }
    return rows;
}

double ControlFit::explained(MatrixIn values, MatrixIn fitted) const {
    require(values.cols() == of_sources_.rows() && fitted.cols() == of_controls_.rows() &&
                values.rows() == fitted.rows(),
            "values and fitted values must be of the same rows");
    const double whole = (values * of_sources_).cwiseProduct(values).sum();
    const double made = (fitted * of_controls_).cwiseProduct(fitted).sum();
    const double both = (fitted * of_both_).cwiseProduct(values).sum();
    return share_left(made, both, whole);
}

void ControlFit::weigh_sources() {
    const MatrixRows rows = mapping();
    source_explained_ = Eigen::VectorXd::Zero(of_sources_.rows());
    for (Eigen::Index s = 0; s < source_explained_.size(); ++s) {
        const double whole = of_sources_(s, s);
        if (!(whole > 0)) {
            source_explained_[s] = 1;
            continue;
        }
        for (const int side : {0, 1}) {
            const Eigen::VectorXd fitted = (side == 0 ? 1. : -1.) * rows.row(2 * s + side).transpose();
            const double made = fitted.dot(of_controls_ * fitted);
            const double along = std::max(0., fitted.dot(of_both_.col(s)));
            if (made > 0)
                source_explained_[s] = std::max(source_explained_[s], along * along / (made * whole));
        }
    }
}

}  // namespace mimetic
