// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/analyse/delays.hpp>
#include <mimetic/shared/checks.hpp>
#include <optional>
#include <utility>

#include "drawn_range.hpp"
#include "events.hpp"

namespace mimetic {
namespace {

constexpr double kQuiet = .15;  // of the event's own rates (root mean square): noise at rest
constexpr int kAround = 4;      // frames before the earlier onset and after the later apex

Eigen::VectorXd rates_of(const Eigen::VectorXd& values) {
    const Eigen::Index n = values.size();
    Eigen::VectorXd rates = Eigen::VectorXd::Zero(n);
    rates.segment(1, n - 2) = (values.tail(n - 2) - values.head(n - 2)) / 2;
    return rates;
}

/// Rows in which both applications happen.
struct Span {
    int first, last;
};

/// Correlation of the leader's rates in the span with another's rates `lag` rows later, 0 beyond the ends.
double correlate(const Eigen::VectorXd& leader, const Eigen::VectorXd& other, Span span, int lag) {
    double product = 0, one = 0, two = 0;
    const int count = static_cast<int>(other.size());
    for (int i = span.first; i <= span.last; ++i) {
        const int at = i + lag;
        const double later = at >= span.first && at <= span.last && at < count ? other[at] : 0;
        product += leader[i] * later;
        one += leader[i] * leader[i];
        two += other[i] * other[i];
    }
    return one > 0 && two > 0 ? product / std::sqrt(one * two) : 0;
}

/// Where the correlation is highest, between rows by a parabola.
double best_lag(const Eigen::VectorXd& leader, const Eigen::VectorXd& other, Span span, int max_lag) {
    std::vector<double> at;
    for (int lag = -max_lag - 1; lag <= max_lag + 1; ++lag) {
        at.push_back(correlate(leader, other, span, lag));
    }
    const auto best = std::max_element(at.begin() + 1, at.end() - 1);
    const double before = *(best - 1), here = *best, after = *(best + 1);
    const double bend = before - 2 * here + after;
    const double part = bend < 0 ? std::clamp(.5 * (before - after) / bend, -.5, .5) : 0;
    return static_cast<double>(best - at.begin()) - max_lag - 1 + part;
}

/// Rates of a curve as captured, and with its event as fitted.
struct Rates {
    Eigen::VectorXd own, fitted;
};

struct Match {
    double lag, correlation;
};

/// The lag by the fitted rates, and how the curves' own correlate there: of captured curves the peak would be
/// off, of fitted ones all events would look alike.
Match match_of(const Rates& leader, const Rates& other, Span span, int max_lag) {
    const double lag = best_lag(leader.fitted, other.fitted, span, max_lag);
    const int before = static_cast<int>(std::floor(lag));
    const double share = lag - before;
    return {lag, (1 - share) * correlate(leader.own, other.own, span, before) +
                     share * correlate(leader.own, other.own, span, before + 1)};
}

int row_of(VectorIn frames, double frame) {
    const auto* end = frames.data() + frames.size();
    const auto row = static_cast<int>(std::lower_bound(frames.data(), end, frame) - frames.data());
    return std::clamp(row, 0, static_cast<int>(frames.size()) - 1);
}

/// The curve with its event replaced by another course of it.
Eigen::VectorXd with_event(VectorIn values, const PhaseFit& fit, const Eigen::VectorXd& event) {
    Eigen::VectorXd replaced = values;
    replaced.segment(fit.first, event.size()) = event;
    return replaced;
}

/// What is captured is smoothed and drawn to rest, so that a slow foot is cut off and the middle of its rates
/// moves: the event as fitted has it.
Rates rates_with_fit(VectorIn frames, VectorIn values, const PhaseFit& fit) {
    const Eigen::VectorXd event =
        frames.segment(fit.first, fit.last - fit.first + 1).unaryExpr([&](double frame) {
            return fit.shape.value(frame);
        });
    return {rates_of(values), rates_of(with_event(values, fit, event))};
}

/// Both curves at every frame of the stretch of rows in which their events are, as straight lines have them.
struct EvenCurves {
    Eigen::VectorXd frames, leader, curve;
    PhaseFit leader_fit, fit;
};

Eigen::VectorXd at_frames(VectorIn at, VectorIn frames, VectorIn values) {
    return at.unaryExpr([&](double frame) {
        const int after = std::clamp(row_of(frames, frame), 1, static_cast<int>(frames.size()) - 1);
        const double share = (frame - frames[after - 1]) / (frames[after] - frames[after - 1]);
        return (1 - share) * values[after - 1] + share * values[after];
    });
}

/// None where the events are in different stretches.
std::optional<EvenCurves> on_even_frames(VectorIn frames, VectorIn leader, const PhaseFit& leader_fit,
                                         VectorIn curve, const PhaseFit& fit,
                                         const std::vector<double>& scene_starts) {
    for (const Stretch& stretch : stretches(frames, scene_starts)) {
        const auto has = [&](const PhaseFit& one) {
            return one.first >= stretch.first && one.last <= stretch.last;
        };
        if (!has(leader_fit) || !has(fit)) {
            continue;
        }
        const int count = stretch.last - stretch.first + 1;
        const Eigen::VectorXd own = frames.segment(stretch.first, count);
        const auto num_even = static_cast<Eigen::Index>(std::floor(own[count - 1] - own[0] + 1e-6)) + 1;
        EvenCurves even{
            Eigen::VectorXd::LinSpaced(num_even, own[0], own[0] + static_cast<double>(num_even - 1)),
            leader.segment(stretch.first, count), curve.segment(stretch.first, count), leader_fit, fit};
        for (PhaseFit* one : {&even.leader_fit, &even.fit}) {
            one->first = row_of(even.frames, frames[one->first]);
            one->last = row_of(even.frames, frames[one->last]);
        }
        if (num_even != count || (even.frames - own).cwiseAbs().maxCoeff() > 1e-9) {
            even.leader = at_frames(even.frames, own, even.leader);
            even.curve = at_frames(even.frames, own, even.curve);
        }
        return even;
    }
    return std::nullopt;
}

/// Of what the noise about both fits makes of the lag. How the capture bends a curve's shape is left out: it
/// moves onset and exponent against each other, hardly the middle of an application, which a lag depends on.
Interval lag_interval(const EvenCurves& even, Span span, const DelayOptions& options, double lag) {
    PhaseFit leader_fit = even.leader_fit, fit = even.fit;
    leader_fit.shape_std = fit.shape_std = 0;
    const Eigen::MatrixXd first = draw_curves(leader_fit, even.frames, options.num_draws, options.seed);
    const Eigen::MatrixXd second = draw_curves(fit, even.frames, options.num_draws, options.seed + 1);
    std::vector<double> lags;
    lags.reserve(static_cast<std::size_t>(options.num_draws));
    for (int k = 0; k < options.num_draws; ++k) {
        lags.push_back(best_lag(rates_of(with_event(even.leader, leader_fit, first.col(k))),
                                rates_of(with_event(even.curve, fit, second.col(k))), span, options.max_lag));
    }
    const std::optional<DrawnRange> range = range_of(std::move(lags));
    if (!range) {
        return {lag, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    }
    // The draws give the spread of a lag; they are centred on the fitted shapes' lag, which differs
    const double spread = std::max(.5 * (range->upper - range->lower), std::abs(range->median - lag));
    const double half = std::hypot(spread, 1.96 * options.timing_std);
    return {lag, lag - half, lag + half};
}

/// How often a curve that is shifted about its own clip, so that nothing in it can belong to the leader's
/// event, correlates as well at the lag that it then has.
double chance_of(const Rates& leader, const Rates& other, Span span, int max_lag, double correlation) {
    const int count = static_cast<int>(other.own.size());
    int shifts = 0, as_good = 0;
    Rates shifted{Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (int shift = 2 * max_lag + 1; shift < count - 2 * max_lag; ++shift) {
        const int rest = count - shift;
        shifted.own << other.own.tail(rest), other.own.head(shift);
        shifted.fitted << other.fitted.tail(rest), other.fitted.head(shift);
        // A quiet stretch is no match however alike its noise is; of others the size does not count, as it
        // does not for the event's own
        double energy = 0, own = 0;
        for (int i = span.first; i <= span.last; ++i) {
            energy += shifted.own[i] * shifted.own[i];
            own += other.own[i] * other.own[i];
        }
        const bool is_quiet = energy <= kQuiet * kQuiet * own;
        as_good += !is_quiet && match_of(leader, shifted, span, max_lag).correlation >= correlation;
        ++shifts;
    }
    return shifts == 0 ? 1 : (1. + as_good) / (1. + shifts);
}

/// 0 where no draws tell it.
double onset_std(const PhaseFit& fit) {
    const double width = fit.onset.upper - fit.onset.lower;
    return std::isfinite(width) ? width / (2 * 1.96) : 0;
}

}  // namespace

void DelayOptions::check() const {
    check_range("DelayOptions.max_lag", max_lag, 1, 200);
    check_range("DelayOptions.timing_std", timing_std, 0, 100);
    check_range("DelayOptions.num_draws", num_draws, 0, 10000);
}

std::optional<Delay> estimate_delay(VectorIn frames, VectorIn leader, const PhaseFit& leader_fit,
                                    VectorIn curve, const PhaseFit& fit, const DelayOptions& options) {
    options.check();
    require(leader.size() == frames.size() && curve.size() == frames.size(),
            "estimate_delay: curves and frames must be as long as each other");
    require(leader_fit.last < frames.size() && fit.last < frames.size(),
            "estimate_delay: the fits are of other curves");
    const double apart = fit.shape.onset - leader_fit.shape.onset;
    if (frames.size() < 5 || !leader_fit.is_certain || !fit.is_certain || leader_fit.begins_before ||
        fit.begins_before || std::abs(apart) > options.max_lag) {
        return std::nullopt;
    }
    const auto even = on_even_frames(frames, leader, leader_fit, curve, fit, options.scene_starts);
    if (!even || even->frames.size() < 5) {
        return std::nullopt;
    }
    const double begin = std::min(fit.shape.onset, leader_fit.shape.onset) - kAround;
    const double end = std::max(fit.shape.apex(), leader_fit.shape.apex()) + kAround;
    const Span span{row_of(even->frames, begin), row_of(even->frames, end)};
    const Rates first = rates_with_fit(even->frames, even->leader, even->leader_fit);
    const Rates second = rates_with_fit(even->frames, even->curve, even->fit);
    const Match match = match_of(first, second, span, options.max_lag);
    Delay delay;
    delay.correlation = match.correlation;
    delay.lag = lag_interval(*even, span, options, match.lag);
    delay.onset_lag = apart;
    delay.apex_lag = fit.shape.apex() - leader_fit.shape.apex();
    delay.chance = chance_of(first, second, span, options.max_lag, delay.correlation);
    // Groups that differ in shape alone have rates apart, and neither begins later
    const bool begins_apart = std::abs(apart) > std::hypot(onset_std(leader_fit), onset_std(fit));
    const bool checks = begins_apart && match.lag * delay.onset_lag > 0 && match.lag * delay.apex_lag > 0;
    delay.is_delayed = checks && (delay.lag.lower > 0 || delay.lag.upper < 0) && delay.chance < .05;
    return delay;
}

}  // namespace mimetic
