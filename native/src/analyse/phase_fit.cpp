// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/jet.h>

#include <cmath>

namespace mimetic {
namespace {

constexpr double kUsualNoise = .01;
constexpr int kIterations = 60;
constexpr double kEarly = .65;     // of the height, at which the application of a long event may have ended
constexpr double kTauOfFall = .6;  // an exponential's, over the frames of a straight fall like it

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
    if (!data.rows.ends_after) {
        shape.hold = std::clamp(data.frames[data.frames.size() - 1] - shape.apex(), 0., shape.hold);
    }
    shape.drift = p[kDrift];
    shape.exponent = model == PhaseModel::linear_ramp ? 0 : p[kExponent];
    shape.release_time = std::exp(p[kRelease]);
    if (model == PhaseModel::two_exponentials) {
        shape.relaxation_time = std::exp(p[kRelease] + p[kRelaxation]);
        shape.relaxed_share = p[kShare];
    }
    return shape;
}

/// Residual of each frame that a release comes after the rows, which show that there was one.
constexpr double kBeyondRows = 1;

/// The weighted, robust distance of the smoothed model from the curve.
class PhaseResidual : public ceres::CostFunction {
public:
    /// exponent_weight: of the exponent itself, which is expected about 0
    PhaseResidual(const FittedEvent& data, PhaseModel model, double robust_scale, double exponent_weight)
        : data_(data), model_(model), robust_scale_(robust_scale), exponent_weight_(exponent_weight) {
        set_num_residuals(static_cast<int>(data.frames.size()) + 2);
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
        const Jet beyond = p[kOnset] + rise + hold - data_.frames[n - 1];
        const double weight = !data_.rows.ends_after && beyond.a > 0 ? kBeyondRows : 0;
        residuals[n + 1] = weight * beyond.a;
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<MatrixRows> jacobian(jacobians[0], n + 2, kPhaseParameters);
            jacobian.topRows(n) = table.rightCols<kPhaseParameters>();
            jacobian.row(n).setZero();
            jacobian(n, kExponent) = exponent_weight_;
            jacobian.row(n + 1) = weight * beyond.v.transpose();
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

/// Frames about which a fit begins: of the foot and the top of the rise, and of the fall.
struct RoughTimes {
    double begin, full, leave, end;
};

/// Row at which the curve passes a share of its height: out from a row while it is above it, or in from one
/// of the ends while it is below.
int crossing(const FittedEvent& data, double share, int row, int step, bool is_out) {
    const int n = static_cast<int>(data.frames.size()), top = data.rows.top - data.rows.first;
    const double low = (is_out ? step : -step) < 0 && data.before ? *data.before : data.values.minCoeff();
    const double level = low + share * (data.values[top] - low);
    while (row + step >= 0 && row + step < n && (data.values[row] > level) == is_out) {
        row += step;
    }
    return row;
}

/// Of what is above a share of the height without a break about the top, on its way up and down.
RoughTimes times_about_top(const FittedEvent& data, double up, double down) {
    const int top = data.rows.top - data.rows.first;
    const auto at = [&](double share, int step) {
        return data.frames[crossing(data, share, top, step, true)];
    };
    return {at(.15, -1), at(up, -1), at(down, 1), at(.15, 1)};
}

/// Of all from the first to the last row above a share of the height, whatever dips are between them.
RoughTimes times_of_whole(const FittedEvent& data, double share) {
    const int full = crossing(data, share, 0, 1, false);
    const int leave = crossing(data, share, static_cast<int>(data.frames.size()) - 1, -1, false);
    const int begin = crossing(data, .15, full, -1, true), end = crossing(data, .15, leave, 1, true);
    return {data.frames[begin], data.frames[full], data.frames[leave], data.frames[end]};
}

/// early: the share of the height at which the application may have ended, with the level drifting on.
PhaseParameters starting_point(const FittedEvent& data, PhaseModel model, const RoughTimes& times,
                               double exponent, double early) {
    const double low = data.values.minCoeff(), high = data.values.maxCoeff();
    const double rise = std::max(2.0, 1.3 * (times.full - times.begin));
    const double fall = std::max(2.0, times.end - times.leave);
    PhaseParameters p;
    p << low, early * (high - low), times.begin - .15 * rise, std::log(rise),
        std::log1p(std::max(0.0, times.leave - times.full)), exponent,
        std::log(model == PhaseModel::linear_ramp ? fall : kTauOfFall * fall), std::log(4.), .25,
        1 / early - 1;
    return p;
}

std::vector<PhaseParameters> starting_points(const FittedEvent& data, PhaseModel model) {
    std::vector<PhaseParameters> starts;
    const auto add = [&](const RoughTimes& times, double early) {
        if (model == PhaseModel::linear_ramp) {
            starts.push_back(starting_point(data, model, times, 0, early));
            return;
        }
        for (const double exponent : {-2., 1.5}) {
            starts.push_back(starting_point(data, model, times, exponent, early));
        }
    };
    add(times_about_top(data, .9, .9), 1);
    add(times_about_top(data, 1, 1), 1);
    add(times_of_whole(data, .9), 1);
    add(times_of_whole(data, .5), 1);
    if (data.rows.is_long) {
        add(times_about_top(data, .9 * kEarly, .9), kEarly);
        RoughTimes whole = times_of_whole(data, .5);
        whole.leave = .5 * (whole.full + whole.leave);  // let go slowly, from long before the last
        add(whole, kEarly);
    }
    return starts;
}

/// What one model found, for another to begin at.
PhaseParameters as_start(const PhaseParameters& found, PhaseModel from, PhaseModel to) {
    PhaseParameters p = found;
    if (from == PhaseModel::linear_ramp) {
        p[kRelease] += std::log(kTauOfFall);
    }
    if (to == PhaseModel::linear_ramp) {
        p[kRelease] -= std::log(kTauOfFall);
        p[kExponent] = 0;
    }
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

/// Once its noise is known, from the least cost at the usual one.
void finish_fit(const FittedEvent& data, PhaseModel model, const PhaseOptions& options, ModelFit& fit) {
    score_fit(data, model, fit);
    if (options.exponent_std > 0 && model != PhaseModel::linear_ramp) {
        minimise(data, model, options, std::sqrt(fit.variance), kIterations, fit.parameters);
        score_fit(data, model, fit);
    }
    const int count = kPhaseParameters - static_cast<int>(fixed_parameters(model, data.rows).size());
    const double variance = std::max(fit.variance, kLeastNoise * kLeastNoise), worth = worth_of(data);
    fit.bic = worth * std::log(variance) + count * std::log(worth);
    if (options.exponent_std > 0) {
        fit.bic += std::pow(fit.shape.exponent / options.exponent_std, 2);
    }
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

std::array<ModelFit, kNumPhaseModels> fit_models(const FittedEvent& data, const PhaseOptions& options) {
    std::array<ModelFit, kNumPhaseModels> fits;
    std::array<double, kNumPhaseModels> least{};
    least.fill(std::numeric_limits<double>::infinity());
    const auto try_start = [&](std::size_t m, PhaseParameters p) {
        const double cost = minimise(data, static_cast<PhaseModel>(m), options, kUsualNoise, kIterations, p);
        if (cost < least[m]) {
            least[m] = cost;
            fits[m].parameters = p;
        }
    };
    for (std::size_t m = 0; m < fits.size(); ++m) {
        for (const PhaseParameters& start : starting_points(data, static_cast<PhaseModel>(m))) {
            try_start(m, start);
        }
    }
    // Each has minima that another does not stop in
    for (std::size_t m = 0; m < fits.size(); ++m) {
        for (std::size_t other = 0; other < fits.size(); ++other) {
            if (other != m) {
                try_start(m, as_start(fits[other].parameters, static_cast<PhaseModel>(other),
                                      static_cast<PhaseModel>(m)));
            }
        }
    }
    for (std::size_t m = 0; m < fits.size(); ++m) {
        finish_fit(data, static_cast<PhaseModel>(m), options, fits[m]);
    }
    return fits;
}

PhaseShape refit_model(const FittedEvent& drawn, const ModelFit& fit, const PhaseOptions& options) {
    constexpr int kFew = 12;
    PhaseParameters p = fit.parameters;
    minimise(drawn, fit.shape.model, options, std::sqrt(fit.variance), kFew, p);
    return shape_of(fit.shape.model, drawn, p);
}

}  // namespace mimetic
