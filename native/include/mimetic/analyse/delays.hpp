// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/analyse/phases.hpp>
#include <optional>

namespace mimetic {

struct DelayOptions {
    int max_lag = 12;        ///< frames, 1 to 200
    double timing_std = .3;  ///< frames: s.d. of a capture's timing between two curves, beside noise
    int num_draws = 200;     ///< of the noise about both fits, 0 to 10000
    unsigned seed = 1;
    std::vector<double> scene_starts;  ///< frames at which scenes begin: events of two have no delay
    void check() const;                ///< throws InvalidInput: field, value, limit
};

/// How much later the application of one curve comes than that of another.
struct Delay {
    Interval lag;  ///< frames, by the peak of the cross-correlation of the fits' rates; above 0: later
    double correlation = 0;  ///< of the curves' own rates at the lag
    double onset_lag = 0;    ///< the same by the fitted onsets, as a check
    double apex_lag = 0;     ///< and by the fitted ends of the application
    /// Share of circular shifts of the other curve whose own rates, at the lag that they have by their
    /// fitted ones, correlate as well.
    double chance = 1;
    bool is_delayed = false;  ///< the interval excludes 0, the chance is under .05, the check agrees in sign
};

/// The delay of an event of `curve` (N) behind one of `leader` (N). None where either is not certain or
/// begins before the clip, where their applications are more than max_lag apart, or a scene begins or frames
/// are missing between them. Frames may be several apart: lags are in frames, not in rows. Throws
/// InvalidInput on other lengths.
std::optional<Delay> estimate_delay(VectorIn frames, VectorIn leader, const PhaseFit& leader_fit,
                                    VectorIn curve, const PhaseFit& fit, const DelayOptions& options = {});

}  // namespace mimetic
