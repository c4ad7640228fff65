// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <mimetic/analyse/curve_noise.hpp>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/shared/checks.hpp>
#include <optional>
#include <random>
#include <utility>

#include "drawn_range.hpp"
#include "events.hpp"
#include "phase_fit.hpp"

namespace mimetic {
namespace {

constexpr double kMostBent = 1;  // of shape_std: beyond it a draw is a step

/// The middle 95 % of draws about an estimate.
Interval interval_of(double value, std::vector<double> draws, double further_std = 0) {
    const std::optional<DrawnRange> range = range_of(std::move(draws));
    if (!range) {
        return {value, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    }
    const double below = std::hypot(value - range->lower, 1.96 * further_std);
    const double above = std::hypot(range->upper - value, 1.96 * further_std);
    return {value, value - std::max(0.0, below), value + std::max(0.0, above)};
}

double length_of(const PhaseShape& shape) { return shape.release() + shape.fall_time() - shape.onset; }

/// Parameters of fits to the parametric bootstrap's curves.
struct Draws {
    std::vector<double> onset, apex, release, amplitude, exponent, length;  // of all models that may be right
    std::vector<double> release_time, relaxation_time, share;  // of the best one: others lack them
};

void add_draws(const FittedEvent& data, const ModelFit& model, bool is_best, const PhaseOptions& options,
               const Eigen::MatrixXd& curves, Draws& draws) {
    FittedEvent drawn = data;
    for (Eigen::Index k = 0; k < curves.cols(); ++k) {
        drawn.values = curves.col(k);
        const PhaseShape shape = refit_model(drawn, model, options);
        draws.onset.push_back(shape.onset);
        draws.apex.push_back(shape.apex());
        draws.release.push_back(shape.release());
        draws.amplitude.push_back(shape.amplitude);
        draws.exponent.push_back(shape.exponent);
        draws.length.push_back(length_of(shape));
        if (is_best) {
            draws.release_time.push_back(shape.release_time);
            draws.relaxation_time.push_back(shape.relaxation_time);
            draws.share.push_back(shape.relaxed_share);
        }
    }
}

/// Which model is right is not known either: each gets draws in proportion to its weight exp(-BIC / 2).
Draws draw_fits(const FittedEvent& data, const std::array<ModelFit, kNumPhaseModels>& models,
                const PhaseFit& fit, const PhaseOptions& options, VectorIn frames) {
    const double least = *std::min_element(fit.bic.begin(), fit.bic.end());
    double whole = 0;
    for (const ModelFit& model : models) {
        whole += std::exp(-.5 * (model.bic - least));
    }
    Draws draws;
    unsigned seed = options.seed;
    for (const ModelFit& model : models) {
        const double weight = std::exp(-.5 * (model.bic - least)) / whole;
        PhaseFit source = fit;
        source.shape = model.shape;
        source.noise = std::max(kLeastNoise, std::sqrt(model.variance));
        const int count = static_cast<int>(std::lround(weight * options.num_draws));
        add_draws(data, model, model.shape.model == fit.shape.model, options,
                  draw_curves(source, frames, count, seed++), draws);
    }
    return draws;
}

void set_intervals(const PhaseShape& shape, const Draws& draws, double value_std, double timing_std,
                   PhaseFit& fit) {
    fit.onset = interval_of(shape.onset, draws.onset, timing_std);
    fit.apex = interval_of(shape.apex(), draws.apex, timing_std);
    fit.release = interval_of(shape.release(), draws.release, timing_std);
    fit.amplitude = interval_of(shape.amplitude, draws.amplitude, value_std);
    fit.exponent = interval_of(shape.exponent, draws.exponent);
    // Of both its ends
    fit.length = interval_of(length_of(shape), draws.length, std::sqrt(2.) * timing_std);
    fit.release_time = interval_of(shape.release_time, draws.release_time);
    fit.relaxation_time = interval_of(shape.relaxation_time, draws.relaxation_time);
    fit.relaxed_share = interval_of(shape.relaxed_share, draws.share);
}

PhaseFit fit_event(const FittedEvent& data, double value_std, double smoothing, const PhaseOptions& options,
                   VectorIn frames) {
    PhaseFit fit;
    fit.smoothing = smoothing;
    const std::array<ModelFit, kNumPhaseModels> models = fit_models(data, options);
    ModelFit best;
    for (std::size_t m = 0; m < models.size(); ++m) {
        fit.bic[m] = models[m].bic;
        if (models[m].bic < best.bic) {
            best = models[m];
        }
    }
    fit.linear_explained = models[0].explained;
    fit.shape = best.shape;
    fit.noise = std::max(kLeastNoise, std::sqrt(best.variance));
    fit.explained = best.explained;
    fit.first = data.rows.first;
    fit.last = data.rows.last;
    fit.begins_before = data.rows.begins_before;
    fit.ends_after = data.rows.ends_after;
    fit.shape_std =
        std::min(kMostBent, options.shape_error * value_std / std::max(best.shape.amplitude, 1e-6));
    fit.is_certain = best.shape.amplitude > options.certainty * value_std;
    set_intervals(best.shape, draw_fits(data, models, fit, options, frames), value_std, options.timing_std,
                  fit);
    return fit;
}

}  // namespace

std::vector<PhaseFit> fit_phases(VectorIn frames, VectorIn values, VectorIn stds,
                                 const std::vector<bool>& usable, const PhaseOptions& options,
                                 const MeasuredGroup& measured) {
    options.check();
    const Eigen::Index count = frames.size();
    require(
        values.size() == count && stds.size() == count && usable.size() == static_cast<std::size_t>(count),
        "fit_phases: frames, values, standard deviations and usable must be as long as each other");
    require(values.allFinite() && stds.allFinite() && (stds.array() >= 0).all(),
            "fit_phases: values or standard deviations are not finite, or negative");
    for (Eigen::Index i = 1; i < count; ++i) {
        require(frames[i] > frames[i - 1], "fit_phases: frames must rise");
    }
    require(measured.courses == nullptr || measured.courses->num_frames() == count,
            "fit_phases: the evidence is of another clip");
    std::vector<PhaseFit> fits;
    for (const EventRows& rows : find_events(frames, values, options)) {
        const int n = rows.last - rows.first + 1;
        const double value_std = stds.segment(rows.first, n).mean();
        const double measured_std = options.measured_std > 0 ? options.measured_std : value_std;
        const double smoothing = measured.courses ? 0 : smoothing_ratio(measured_std);
        const CurveNoise noise(n, smoothing);
        FittedEvent data{frames.segment(rows.first, n), values.segment(rows.first, n),
                         Eigen::VectorXd::Ones(n), rows, &noise};
        if (measured.courses) {
            data.values = measured.courses->course(measured.members, rows.first, rows.last, rows.top);
        }
        for (int i = 0; i < n; ++i) {
            const double std = std::max(1e-6, stds[rows.first + i]);
            data.weights[i] = usable[static_cast<std::size_t>(rows.first + i)]
                                  ? std::min(2.0, std::max(1e-6, value_std) / std)
                                  : 0;
        }
        data.before = level_before(data);
        if ((data.weights.array() > 0).count() > kPhaseParameters - 3) {
            fits.push_back(fit_event(data, value_std, smoothing, options, frames));
        }
    }
    return fits;
}

Eigen::MatrixXd draw_curves(const PhaseFit& fit, VectorIn frames, int num_draws, unsigned seed) {
    const int n = fit.last - fit.first + 1;
    require(fit.first >= 0 && fit.last < frames.size(), "draw_curves: the fit is of another curve");
    const CurveNoise noise(n, fit.smoothing);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd draws(n, num_draws), curves(n, num_draws);
    for (Eigen::Index k = 0; k < draws.size(); ++k) {
        draws(k) = normal(random);
    }
    const PhaseShape& shape = fit.shape;
    for (int k = 0; k < num_draws; ++k) {
        const double power = fit.shape_std > 0 ? std::exp(fit.shape_std * normal(random)) : 1;
        for (int i = 0; i < n; ++i) {
            const double frame = frames[fit.first + i];
            const bool is_applied = frame < shape.apex();
            const double low = is_applied ? shape.before.value_or(shape.rest) : shape.rest;
            const double height = is_applied ? shape.climb() : shape.amplitude;
            const double share = (shape.value(frame) - low) / height;
            curves(i, k) = low + height * std::pow(std::max(0., share), power);
        }
    }
    return fit.noise * noise.correlated(draws) + noise.smoothed(curves);
}

}  // namespace mimetic
