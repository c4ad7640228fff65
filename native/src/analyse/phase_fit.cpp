// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/jet.h>

#include <cmath>

namespace mimetic {
namespace {

struct Limits {
    PhaseParameters lower, upper;
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

PhaseShape shape_of(PhaseModel model, const FittedEvent& data, const PhaseParameters& p) {
    PhaseShape shape;
    shape.before = data.before;
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

/// The weighted, robust distance of the smoothed model from the curve.
class PhaseResidual : public ceres::CostFunction {
public:
    /// exponent_weight: of the exponent itself, which is expected about 0
    PhaseResidual(const FittedEvent& data, PhaseModel model, double robust_scale, double exponent_weight)
        : data_(data), model_(model), robust_scale_(robust_scale), exponent_weight_(exponent_weight) {
        set_num_residuals(static_cast<int>(data.frames.size()) + 1);
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
            const Jet value = phase_value(data_.frames[i], p[kRest], p[kAmplitude], data_.before,
                                          Jet(p[kOnset] + rise), share);
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
        residuals[n] = exponent_weight_ * parameters[0][kExponent];
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<MatrixRows> jacobian(jacobians[0], n + 1, kPhaseParameters);
            jacobian.topRows(n) = table.rightCols<kPhaseParameters>();
            jacobian.row(n).setZero();
            jacobian(n, kExponent) = exponent_weight_;
        }
        return table.allFinite();
    }

private:
    const FittedEvent& data_;
    PhaseModel model_;
    double robust_scale_, exponent_weight_;
};

/// Number of independent values among those that are fitted.
double worth_of(const FittedEvent& data) {
    const auto used = static_cast<double>((data.weights.array() > 0).count());
    return data.noise->effective_count() * std::max(1., used) / static_cast<double>(data.frames.size());
}

/// An expectation of the exponent counts as one value against the independent ones, not against all rows.
double exponent_weight(const FittedEvent& data, double noise, const PhaseOptions& options) {
    if (options.exponent_std <= 0) {
        return 0;
    }
    const auto used = static_cast<double>((data.weights.array() > 0).count());
    return std::max(noise, kLeastNoise) * std::sqrt(std::max(1., used) / worth_of(data)) /
           options.exponent_std;
}

Limits limits_of(const FittedEvent& data, PhaseModel model) {
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
double crossing(const FittedEvent& data, double share, int step) {
    const int n = static_cast<int>(data.frames.size());
    int i = data.rows.top - data.rows.first;
    const double low = step < 0 && data.before ? *data.before : data.values.minCoeff();
    const double level = low + share * (data.values[i] - low);
    while (i + step >= 0 && i + step < n && data.values[i] > level) {
        i += step;
    }
    return data.frames[i];
}

/// early: the share of the height at which the application may have ended, with the level drifting on.
PhaseParameters starting_point(const FittedEvent& data, PhaseModel model, double exponent, double early) {
    const double low = data.values.minCoeff(), high = data.values.maxCoeff();
    const double begin = crossing(data, .15, -1), full = crossing(data, .9 * early, -1);
    const double leave = crossing(data, .9, 1), end = crossing(data, .15, 1);
    const double rise = std::max(2.0, 1.3 * (full - begin)), fall = std::max(2.0, end - leave);
    PhaseParameters p;
    p << low, early * (high - low), begin - .15 * rise, std::log(rise),
        std::log1p(std::max(0.0, leave - full)), exponent,
        std::log(model == PhaseModel::linear_ramp ? fall : .6 * fall), std::log(4.), .25, 1 / early - 1;
    return p;
}

double minimise(const FittedEvent& data, PhaseModel model, const PhaseOptions& options, double noise,
                int iterations, PhaseParameters& p) {
    const Limits limits = limits_of(data, model);
    p = p.cwiseMax(limits.lower).cwiseMin(limits.upper);
    ceres::Problem problem;
    problem.AddResidualBlock(
        new PhaseResidual(data, model, options.robust_scale, exponent_weight(data, noise, options)), nullptr,
        p.data());
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

Eigen::VectorXd model_values(const FittedEvent& data, const PhaseShape& shape) {
    Eigen::VectorXd values(data.frames.size());
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        values[i] = shape.value(data.frames[i]);
    }
    return data.noise->smoothed(values);
}

void score_fit(const FittedEvent& data, PhaseModel model, ModelFit& fit) {
    fit.shape = shape_of(model, data, fit.parameters);
    const Eigen::VectorXd error = model_values(data, fit.shape) - data.values;
    const Eigen::ArrayXd used = (data.weights.array() > 0).cast<double>();
    const double n = std::max(1.0, used.sum());
    fit.variance = (error.array().square() * used).sum() / n;
    const double mean = (data.values.array() * used).sum() / n;
    fit.explained =
        1 - fit.variance * n / std::max(1e-12, ((data.values.array() - mean).square() * used).sum());
}

}  // namespace

std::optional<double> level_before(const FittedEvent& data) {
    constexpr double kRaised = .1;  // of the height above the level after it
    const double none = std::numeric_limits<double>::infinity();
    double before = none, after = none;
    const int top = data.rows.top - data.rows.first;
    for (int i = 0; i < static_cast<int>(data.values.size()); ++i) {
        if (data.weights[i] > 0) {
            double& level = i < top ? before : after;
            level = std::min(level, data.values[i]);
        }
    }
    const bool is_raised = before < none && before - after > kRaised * (data.values.maxCoeff() - after);
    return is_raised && !data.rows.begins_before ? std::optional(before) : std::nullopt;
}

ModelFit fit_model(const FittedEvent& data, PhaseModel model, const PhaseOptions& options) {
    ModelFit fit;
    constexpr double kUsualNoise = .01;
    double least = std::numeric_limits<double>::infinity();
    for (const double early : {1., .65}) {
        for (const double exponent : {-2., 1.5}) {
            PhaseParameters p = starting_point(data, model, exponent, early);
            const double cost = minimise(data, model, options, kUsualNoise, 60, p);
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
    score_fit(data, model, fit);
    if (options.exponent_std > 0 && model != PhaseModel::linear_ramp) {
        minimise(data, model, options, std::sqrt(fit.variance), 60, fit.parameters);
        score_fit(data, model, fit);
    }
    const int count = kPhaseParameters - static_cast<int>(fixed_parameters(model, data.rows).size());
    const double variance = std::max(fit.variance, kLeastNoise * kLeastNoise), worth = worth_of(data);
    fit.bic = worth * std::log(variance) + count * std::log(worth);
    if (options.exponent_std > 0) {
        fit.bic += std::pow(fit.shape.exponent / options.exponent_std, 2);
    }
    return fit;
}

PhaseShape refit_model(const FittedEvent& drawn, const ModelFit& fit, const PhaseOptions& options) {
    constexpr int kIterations = 12;
    PhaseParameters p = fit.parameters;
    minimise(drawn, fit.shape.model, options, std::sqrt(fit.variance), kIterations, p);
    return shape_of(fit.shape.model, drawn, p);
}

}  // namespace mimetic
