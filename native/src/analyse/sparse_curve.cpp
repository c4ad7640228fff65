// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iterator>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/analyse/sparse_curve.hpp>
#include <mimetic/shared/checks.hpp>
#include <set>

#include "events.hpp"
#include "key_fit.hpp"
#include "key_thinning.hpp"

namespace mimetic {
namespace {

/// Where the curve leaves rest and comes back to it, and its events' tops.
std::set<int> change_rows(VectorIn frames, VectorIn values, double tolerance) {
    const int count = static_cast<int>(values.size());
    std::set<int> rows{0, count - 1};
    PhaseOptions options;
    options.least_amplitude = std::max(2 * tolerance, 1e-6);
    const double rest = values.minCoeff() + .25 * tolerance;
    for (const EventRows& event : find_events(frames, values, options)) {
        int begin = event.top, end = event.top;
        while (begin > event.first && values[begin] > rest) {
            --begin;
        }
        while (end < event.last && values[end] > rest) {
            ++end;
        }
        rows.insert({begin, event.top, end});
    }
    return rows;
}

/// Rows of one event's keys, from its onset to where it is at rest again.
struct EventKeys {
    int first = 0, last = 0;
    std::set<int> rows;
};

int row_near(VectorIn frames, double frame, int first, int last) {
    const double* begin = frames.data() + first;
    const double* end = frames.data() + last + 1;
    const int after = static_cast<int>(std::lower_bound(begin, end, frame) - frames.data());
    const int row = std::clamp(after, first, last);
    return row > first && frame - frames[row - 1] < frames[row] - frame ? row - 1 : row;
}

/// Onset and end are moved outward to where the curve rests, so that a drag between them ends there.
EventKeys keys_at_phases(const PhaseFit& fit, VectorIn frames, VectorIn values, double tolerance) {
    const auto rows = values.segment(fit.first, fit.last - fit.first + 1);
    const double before = rows.head(rows.size() / 2 + 1).minCoeff() + .5 * tolerance;
    const double after = rows.tail(rows.size() / 2 + 1).minCoeff() + .5 * tolerance;
    const auto near = [&](double frame) { return row_near(frames, frame, fit.first, fit.last); };
    const int apex = near(fit.shape.apex()), release = near(fit.shape.release());
    EventKeys keys;
    keys.first = std::min(near(fit.shape.onset), apex);
    while (keys.first > fit.first && values[keys.first] > before) {
        --keys.first;
    }
    keys.last = std::max(apex, release);
    while (keys.last < fit.last && values[keys.last] > after) {
        ++keys.last;
    }
    keys.rows = {keys.first, apex, release, keys.last};
    return keys;
}

std::vector<EventKeys> phase_rows(VectorIn frames, VectorIn values, VectorIn stds, double tolerance) {
    PhaseOptions options;
    options.least_amplitude = std::max(2 * tolerance, 1e-6);
    options.num_draws = 0;
    const std::vector<bool> usable(static_cast<std::size_t>(values.size()), true);
    std::vector<EventKeys> events;
    for (const PhaseFit& fit : fit_phases(frames, values, stds, usable, options)) {
        events.push_back(keys_at_phases(fit, frames, values, tolerance));
    }
    return events;
}

void check_curve(VectorIn frames, VectorIn values, double tolerance) {
    require(frames.size() == values.size() && frames.size() > 0 && values.allFinite() && frames.allFinite(),
            "reduce_curve: frames and values must be finite and as many as each other");
    check_range("tolerance of a curve", tolerance, 1e-9, 1e9);
    for (Eigen::Index i = 1; i < frames.size(); ++i) {
        require(frames[i] > frames[i - 1], "reduce_curve: frames must rise");
    }
}

bool is_still(VectorIn frames, VectorIn values, double tolerance) {
    return frames.size() == 1 || values.maxCoeff() - values.minCoeff() <= tolerance;
}

SparseCurve one_key(VectorIn frames, VectorIn values, double tolerance) {
    const double middle = values.minCoeff() < tolerance && values.minCoeff() >= 0
                              ? values.minCoeff()
                              : .5 * (values.minCoeff() + values.maxCoeff());
    return {frames.head(1), Eigen::VectorXd::Constant(1, middle), Eigen::VectorXd::Zero(1),
            (values.array() - middle).abs().maxCoeff()};
}

/// Adds keys where the error is largest until it is within the tolerance, or every row is a key.
SparseCurve refined(VectorIn frames, VectorIn values, double tolerance, std::set<int>& rows) {
    const CurveExtent extent(values);
    for (;;) {
        SparseCurve curve = fit_keys(frames, values, rows, extent, tolerance);
        const int worst = farthest_row(curve, frames, values, rows);
        if (curve.error <= tolerance || worst < 0) {
            return curve;
        }
        rows.insert(worst);
    }
}

}  // namespace

SparseCurve reduce_curve(VectorIn frames, VectorIn values, double tolerance) {
    check_curve(frames, values, tolerance);
    if (is_still(frames, values, tolerance)) {
        return one_key(frames, values, tolerance);
    }
    std::set<int> rows = change_rows(frames, values, tolerance);
    refined(frames, values, tolerance, rows);
    thin_out(frames, values, tolerance, rows, {});
    return refined(frames, values, tolerance, rows);
}

std::vector<SparseCurve> reduce_together(VectorIn frames, const Eigen::Ref<const Eigen::MatrixXd>& values,
                                         double tolerance) {
    std::set<int> rows{0, static_cast<int>(frames.size()) - 1};
    bool all_still = true;
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
        check_curve(frames, values.col(c), tolerance);
        if (!is_still(frames, values.col(c), tolerance)) {
            all_still = false;
            rows.merge(change_rows(frames, values.col(c), tolerance));
        }
    }
    std::vector<SparseCurve> curves(static_cast<std::size_t>(values.cols()));
    for (;;) {
        int worst = -1;
        double most = tolerance;
        for (Eigen::Index c = 0; c < values.cols(); ++c) {
            SparseCurve& curve = curves[static_cast<std::size_t>(c)];
            curve = all_still ? one_key(frames, values.col(c), tolerance)
                              : fit_keys(frames, values.col(c), rows, CurveExtent(values.col(c)), tolerance);
            const int row = all_still ? -1 : farthest_row(curve, frames, values.col(c), rows);
            if (curve.error > most && row >= 0) {
                most = curve.error;
                worst = row;
            }
        }
        if (worst < 0) {
            return curves;
        }
        rows.insert(worst);
    }
}

PhaseKeys reduce_by_phases(VectorIn frames, VectorIn values, VectorIn stds, double tolerance) {
    check_curve(frames, values, tolerance);
    if (is_still(frames, values, tolerance)) {
        return {one_key(frames, values, tolerance), {}};
    }
    const std::vector<EventKeys> events = phase_rows(frames, values, stds, tolerance);
    std::set<int> rows{0, static_cast<int>(values.size()) - 1};
    for (const EventKeys& event : events) {
        rows.insert(event.rows.begin(), event.rows.end());
    }
    const std::set<int> phases = rows;
    refined(frames, values, tolerance, rows);
    thin_out(frames, values, tolerance, rows, phases);
    PhaseKeys keys{refined(frames, values, tolerance, rows), {}};
    for (const EventKeys& event : events) {
        keys.keys_of_event.push_back(
            static_cast<int>(std::distance(rows.lower_bound(event.first), rows.upper_bound(event.last))));
    }
    return keys;
}

}  // namespace mimetic
