// SPDX-License-Identifier: GPL-3.0-or-later
#include <ceres/ceres.h>
#include <ceres/jet.h>

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
#include "phase_shape.hpp"

namespace mimetic {
namespace {

using Parameters = Eigen::Matrix<double, kPhaseParameters, 1>;
constexpr double kLeastNoise = .002;

struct Limits {
    Parameters lower, upper;
};

/// Which parameters a model has: the others stay.
std::vector<int> fixed_parameters(PhaseModel model, const EventRows& rows) {
    std::vector<int> fixed;
    if (!rows.is_long) {
        fixed.push_back(kDrift);
    }
    if (model == PhaseModel::linear_ramp || rows.begins_before) {
        fixed.push_back(kExponent);
    }
    if (model != PhaseModel::two_exponentials || rows.ends_after) {
        fixed.insert(fixed.end(), {kRelaxation, kShare});
    }
    return fixed;
}

PhaseShape shape_of(PhaseModel model, const Parameters& p) {
    PhaseShape shape;
    shape.model = model;
    shape.rest = p[kRest];
    shape.amplitude = p[kAmplitude];
    shape.onset = p[kOnset];
    shape.rise = std::exp(p[kRise]);
    shape.hold = std::expm1(p[kHold]);
    shape.drift = p[kDrift];
    shape.exponent = model == PhaseModel::linear_ramp ? 0 : p[kExponent];
    shape.release_time = std::exp(p[kRelease]);
    if (model == PhaseModel::two_exponentials) {
        shape.relaxation_time = std::exp(p[kRelease] + p[kRelaxation]);
        shape.relaxed_share = p[kShare];
    }
    return shape;
}

/// Rows of one event: what is fitted, and with which weight.
struct Fitted {
    Eigen::VectorXd frames, values, weights;  // n; a weight of 0 leaves the row out
    EventRows rows;
    const CurveNoise* noise;
};

/// The weighted, robust distance of the smoothed model from the curve.
class PhaseResidual : public ceres::CostFunction {
public:
    PhaseResidual(const Fitted& data, PhaseModel model, double robust_scale)
        : data_(data), model_(model), robust_scale_(robust_scale) {
        set_num_residuals(static_cast<int>(data.frames.size()));
        mutable_parameter_block_sizes()->push_back(kPhaseParameters);
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        using Jet = ceres::Jet<double, kPhaseParameters>;
        Jet p[kPhaseParameters];
        for (int i = 0; i < kPhaseParameters; ++i) {
            p[i] = Jet(parameters[0][i], i);
        }
        const Jet rise = exp(p[kRise]), hold = expm1(p[kHold]), release = exp(p[kRelease]);
        const Jet relaxation = exp(p[kRelease] + p[kRelaxation]);
        const Eigen::Index n = data_.frames.size();
        Eigen::MatrixXd table(n, kPhaseParameters + 1);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Jet share = phase_share(model_, data_.frames[i], p[kOnset], rise, hold, p[kExponent],
                                          release, relaxation, p[kShare], p[kDrift]);
            const Jet value = p[kRest] + p[kAmplitude] * share;
            table(i, 0) = value.a;
            table.row(i).tail<kPhaseParameters>() = value.v.transpose();
        }
        table = data_.noise->smoothed(table);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double r = data_.weights[i] * (table(i, 0) - data_.values[i]);
            const double root = std::sqrt(1 + r * r / (robust_scale_ * robust_scale_));
            // The square root of soft L1's 2 c^2 (sqrt(1 + r^2 / c^2) - 1), with the sign of r
            const double softened = r * std::sqrt(2 / (root + 1));
            residuals[i] = softened;
            const double slope = std::abs(r) < 1e-9 ? 1 : r / (root * softened);
            table.row(i) *= slope * data_.weights[i];
        }
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<MatrixRows>(jacobians[0], n, kPhaseParameters) = table.rightCols<kPhaseParameters>();
        }
        return table.allFinite();
    }

private:
    const Fitted& data_;
    PhaseModel model_;
    double robust_scale_;
};

Limits limits_of(const Fitted& data, PhaseModel model) {
    const double first = data.frames[0], last = data.frames[data.frames.size() - 1], length = last - first;
    const EventRows& rows = data.rows;
    Limits limits;
    const double before = rows.begins_before ? length : 2;
    limits.lower << -.1, .01, first - before, std::log(1.), 0, -6, std::log(.3), std::log(2.), .05, -.7;
    limits.upper << 1, 1.5, last - 1, std::log(length + before), std::log1p(2 * length), 6,
        std::log(2 * length), std::log(20.), .8, 1;
    if (model == PhaseModel::linear_ramp) {
        limits.lower[kRelease] = 0;
    }
    return limits;
}

/// Where the curve passes a share of its height, walking from the top.
double crossing(const Fitted& data, double share, int step) {
    const int n = static_cast<int>(data.frames.size());
    int i = data.rows.top - data.rows.first;
    const double low = data.values.minCoeff(), level = low + share * (data.values[i] - low);
    while (i + step >= 0 && i + step < n && data.values[i] > level) {
        i += step;
    }
    return data.frames[i];
}

/// early: the share of the height at which the application may have ended, with the level drifting on.
Parameters starting_point(const Fitted& data, PhaseModel model, double exponent, double early) {
    const double low = data.values.minCoeff(), high = data.values.maxCoeff();
    const double begin = crossing(data, .15, -1), full = crossing(data, .9 * early, -1);
    const double leave = crossing(data, .9, 1), end = crossing(data, .15, 1);
    const double rise = std::max(2.0, 1.3 * (full - begin)), fall = std::max(2.0, end - leave);
    Parameters p;
    p << low, early * (high - low), begin - .15 * rise, std::log(rise),
        std::log1p(std::max(0.0, leave - full)), exponent,
        std::log(model == PhaseModel::linear_ramp ? fall : .6 * fall), std::log(4.), .25, 1 / early - 1;
    return p;
}

double minimise(const Fitted& data, PhaseModel model, const PhaseOptions& options, int iterations,
                Parameters& p) {
    const Limits limits = limits_of(data, model);
    p = p.cwiseMax(limits.lower).cwiseMin(limits.upper);
    ceres::Problem problem;
    problem.AddResidualBlock(new PhaseResidual(data, model, options.robust_scale), nullptr, p.data());
    for (int i = 0; i < kPhaseParameters; ++i) {
        problem.SetParameterLowerBound(p.data(), i, limits.lower[i]);
        problem.SetParameterUpperBound(p.data(), i, limits.upper[i]);
    }
    const std::vector<int> fixed = fixed_parameters(model, data.rows);
    if (!fixed.empty()) {
        problem.SetManifold(p.data(), new ceres::SubsetManifold(kPhaseParameters, fixed));
    }
    ceres::Solver::Options how;
    how.linear_solver_type = ceres::DENSE_QR;
    how.max_num_iterations = iterations;
    how.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(how, &problem, &summary);
    return summary.final_cost;
}

Eigen::VectorXd model_values(const Fitted& data, const PhaseShape& shape) {
    Eigen::VectorXd values(data.frames.size());
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        values[i] = shape.value(data.frames[i]);
    }
    return data.noise->smoothed(values);
}

struct ModelFit {
    Parameters parameters;
    PhaseShape shape;
    double bic = std::numeric_limits<double>::infinity();
    double variance = 0, explained = 0;
};

ModelFit fit_model(const Fitted& data, PhaseModel model, const PhaseOptions& options) {
    ModelFit fit;
    double least = std::numeric_limits<double>::infinity();
    for (const double early : {1., .65}) {
        for (const double exponent : {-2., 1.5}) {
            Parameters p = starting_point(data, model, exponent, early);
            const double cost = minimise(data, model, options, 60, p);
            if (cost < least) {
                least = cost;
                fit.parameters = p;
            }
            if (model == PhaseModel::linear_ramp) {
                break;
            }
        }
        if (!data.rows.is_long) {
            break;
        }
    }
    fit.shape = shape_of(model, fit.parameters);
    const Eigen::VectorXd error = model_values(data, fit.shape) - data.values;
    const Eigen::ArrayXd used = (data.weights.array() > 0).cast<double>();
    const double n = std::max(1.0, used.sum());
    fit.variance = (error.array().square() * used).sum() / n;
    const double mean = (data.values.array() * used).sum() / n;
    fit.explained =
        1 - fit.variance * n / std::max(1e-12, ((data.values.array() - mean).square() * used).sum());
    const int count = kPhaseParameters - static_cast<int>(fixed_parameters(model, data.rows).size());
    const double worth = data.noise->effective_count() * n / static_cast<double>(data.frames.size());
    const double variance = std::max(fit.variance, kLeastNoise * kLeastNoise);
    fit.bic = worth * std::log(variance) + count * std::log(worth);
    return fit;
}

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

/// Parameters of fits to the parametric bootstrap's curves.
struct Draws {
    std::vector<double> onset, apex, release, amplitude, exponent;  // of all models that may be right
    std::vector<double> release_time, relaxation_time, share;       // of the best one: others lack them
};

void add_draws(const Fitted& data, const ModelFit& model, bool is_best, const PhaseOptions& options,
               const Eigen::MatrixXd& curves, Draws& draws) {
    constexpr int kIterations = 12;
    Fitted drawn = data;
    for (Eigen::Index k = 0; k < curves.cols(); ++k) {
        drawn.values = curves.col(k);
        Parameters p = model.parameters;
        minimise(drawn, model.shape.model, options, kIterations, p);
        const PhaseShape shape = shape_of(model.shape.model, p);
        draws.onset.push_back(shape.onset);
        draws.apex.push_back(shape.apex());
        draws.release.push_back(shape.release());
        draws.amplitude.push_back(shape.amplitude);
        draws.exponent.push_back(shape.exponent);
        if (is_best) {
            draws.release_time.push_back(shape.release_time);
            draws.relaxation_time.push_back(shape.relaxation_time);
            draws.share.push_back(shape.relaxed_share);
        }
    }
}

/// Which model is right is not known either: each gets draws in proportion to its weight exp(-BIC / 2).
Draws draw_fits(const Fitted& data, const std::array<ModelFit, kNumPhaseModels>& models, const PhaseFit& fit,
                const PhaseOptions& options, VectorIn frames) {
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
    fit.release_time = interval_of(shape.release_time, draws.release_time);
    fit.relaxation_time = interval_of(shape.relaxation_time, draws.relaxation_time);
    fit.relaxed_share = interval_of(shape.relaxed_share, draws.share);
}

PhaseFit fit_event(const Fitted& data, double value_std, double smoothing, const PhaseOptions& options,
                   VectorIn frames) {
    PhaseFit fit;
    fit.smoothing = smoothing;
    std::array<ModelFit, kNumPhaseModels> models;
    ModelFit best;
    for (std::size_t m = 0; m < models.size(); ++m) {
        models[m] = fit_model(data, static_cast<PhaseModel>(m), options);
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
    fit.is_certain = best.shape.amplitude > options.certainty * value_std;
    set_intervals(best.shape, draw_fits(data, models, fit, options, frames), value_std, options.timing_std,
                  fit);
    return fit;
}

}  // namespace

double PhaseShape::value(double frame) const {
    return rest + amplitude * phase_share(model, frame, onset, rise, hold, exponent, release_time,
                                          relaxation_time, relaxed_share, drift);
}

void PhaseOptions::check() const {
    check_range("PhaseOptions.least_amplitude", least_amplitude, 1e-6, 1);
    check_range("PhaseOptions.least_drop", least_drop, .01, 1);
    check_range("PhaseOptions.certainty", certainty, 0, 100);
    check_range("PhaseOptions.robust_scale", robust_scale, 1e-6, 1e3);
    check_range("PhaseOptions.timing_std", timing_std, 0, 100);
    check_range("PhaseOptions.measured_std", measured_std, 0, 1e3);
    check_range("PhaseOptions.num_draws", num_draws, 0, 10000);
}

std::vector<PhaseFit> fit_phases(VectorIn frames, VectorIn values, VectorIn stds,
                                 const std::vector<bool>& usable, const PhaseOptions& options) {
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
    std::vector<PhaseFit> fits;
    for (const EventRows& rows : find_events(frames, values, options)) {
        const int n = rows.last - rows.first + 1;
        const double value_std = stds.segment(rows.first, n).mean();
        const double measured_std = options.measured_std > 0 ? options.measured_std : value_std;
        const double smoothing = smoothing_ratio(measured_std);
        const CurveNoise noise(n, smoothing);
        Fitted data{frames.segment(rows.first, n), values.segment(rows.first, n), Eigen::VectorXd::Ones(n),
                    rows, &noise};
        for (int i = 0; i < n; ++i) {
            const double std = std::max(1e-6, stds[rows.first + i]);
            data.weights[i] = usable[static_cast<std::size_t>(rows.first + i)]
                                  ? std::min(2.0, std::max(1e-6, value_std) / std)
                                  : 0;
        }
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
    Eigen::VectorXd curve(n);
    for (int i = 0; i < n; ++i) {
        curve[i] = fit.shape.value(frames[fit.first + i]);
    }
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd draws(n, num_draws);
    for (Eigen::Index k = 0; k < draws.size(); ++k) {
        draws(k) = normal(random);
    }
    return (fit.noise * noise.correlated(draws)).colwise() + Eigen::VectorXd(noise.smoothed(curve));
}

}  // namespace mimetic
