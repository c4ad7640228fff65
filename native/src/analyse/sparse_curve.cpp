// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/analyse/sparse_curve.hpp>
#include <mimetic/shared/checks.hpp>
#include <set>

#include "events.hpp"

namespace mimetic {
namespace {

/// Shares of two keys' values and slopes in a cubic at s, 0 to 1, of a span of so many frames.
Eigen::Vector4d hermite(double s, double span) {
    const double t = s * s, u = t * s;
    return {2 * u - 3 * t + 1, (u - 2 * t + s) * span, -2 * u + 3 * t, (u - t) * span};
}

/// The row before which no key of `keys` lies later, as an index of the span.
Eigen::Index span_of(const Eigen::VectorXd& keys, double frame) {
    const auto* begin = keys.data();
    const auto* end = begin + keys.size();
    const Eigen::Index after = std::upper_bound(begin, end, frame) - begin;
    return std::clamp<Eigen::Index>(after - 1, 0, keys.size() - 2);
}

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

/// Values and slopes at the keys that come nearest to the dense curve, all at once.
SparseCurve fit_keys(VectorIn frames, VectorIn values, const std::set<int>& rows, double tolerance) {
    SparseCurve curve;
    const auto count = static_cast<Eigen::Index>(rows.size());
    curve.frames.resize(count);
    Eigen::VectorXd seen(count);
    Eigen::Index k = 0;
    for (const int row : rows) {
        curve.frames[k] = frames[row];
        seen[k++] = values[row];
    }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * count);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        const Eigen::Index at = span_of(curve.frames, frames[i]);
        const double span = curve.frames[at + 1] - curve.frames[at];
        const Eigen::Vector4d shares = hermite((frames[i] - curve.frames[at]) / span, span);
        for (int a = 0; a < 4; ++a) {
            right[2 * at + a] += shares[a] * values[i];
            for (int b = 0; b < 4; ++b) {
                entries.emplace_back(2 * at + a, 2 * at + b, shares[a] * shares[b]);
            }
        }
    }
    // Keys lie near the curve, and those at rest rest: a drag of another key must not lift them
    const double low = values.minCoeff(), high = values.maxCoeff();
    for (Eigen::Index i = 0; i < count; ++i) {
        const bool rests = seen[i] - low < .5 * tolerance;
        const double hold = rests ? 1e6 : 1e-3;
        entries.emplace_back(2 * i, 2 * i, hold);
        right[2 * i] += hold * (rests ? low : seen[i]);
        entries.emplace_back(2 * i + 1, 2 * i + 1, rests ? 1e6 : 1e-6);
    }
    Eigen::SparseMatrix<double> matrix(2 * count, 2 * count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
    curve.values.resize(count);
    curve.slopes.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        curve.values[i] = std::clamp(solution[2 * i], low, high);
        curve.slopes[i] = solution[2 * i + 1];
    }
    return curve;
}

/// The row that is farthest off, and by how much; rows that are keys already do not count.
int farthest(VectorIn frames, VectorIn values, const std::set<int>& rows, SparseCurve& curve) {
    int worst = -1;
    double most = -1;
    for (int i = 0; i < static_cast<int>(values.size()); ++i) {
        const double off = std::abs(curve.value(frames[i]) - values[i]);
        curve.error = std::max(curve.error, off);
        if (off > most && !rows.contains(i)) {
            most = off;
            worst = i;
        }
    }
    return worst;
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

}  // namespace

double SparseCurve::value(double frame) const {
    if (frames.size() == 1) {
        return values[0];
    }
    const Eigen::Index at = span_of(frames, frame);
    const double span = frames[at + 1] - frames[at];
    const double s = std::clamp((frame - frames[at]) / span, 0., 1.);
    return hermite(s, span).dot(Eigen::Vector4d(values[at], slopes[at], values[at + 1], slopes[at + 1]));
}

namespace {

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
    for (;;) {
        SparseCurve curve = fit_keys(frames, values, rows, tolerance);
        const int worst = farthest(frames, values, rows, curve);
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
                              : fit_keys(frames, values.col(c), rows, tolerance);
            const int row = all_still ? -1 : farthest(frames, values.col(c), rows, curve);
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
    PhaseKeys keys{refined(frames, values, tolerance, rows), {}};
    for (const EventKeys& event : events) {
        keys.keys_of_event.push_back(
            static_cast<int>(std::distance(rows.lower_bound(event.first), rows.upper_bound(event.last))));
    }
    return keys;
}

}  // namespace mimetic
