// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase_shape.hpp"

#include <mimetic/shared/checks.hpp>

namespace mimetic {

double PhaseShape::value(double frame) const {
    const double share = phase_share(model, frame, onset, rise, hold, exponent, release_time, relaxation_time,
                                     relaxed_share, drift);
    return phase_value(frame, rest, amplitude, before, apex(), share);
}

double PhaseShape::fall_time() const {
    constexpr double kLeft = .1;
    if (model == PhaseModel::linear_ramp) {
        return (1 - kLeft) * release_time;
    }
    const double alone = -std::log(kLeft);  // time constants that one exponential takes
    if (model == PhaseModel::one_exponential) {
        return alone * release_time;
    }
    // Two exponentials fall later than the quicker would alone, and earlier than the slower
    double early = alone * std::min(release_time, relaxation_time);
    double late = alone * std::max(release_time, relaxation_time);
    for (int i = 0; i < 60; ++i) {
        const double middle = .5 * (early + late);
        const double left = (1 - relaxed_share) * std::exp(-middle / release_time) +
                            relaxed_share * std::exp(-middle / relaxation_time);
        (left > kLeft ? early : late) = middle;
    }
    return .5 * (early + late);
}

void PhaseOptions::check() const {
    check_range("PhaseOptions.least_amplitude", least_amplitude, 1e-6, 1);
    check_range("PhaseOptions.least_drop", least_drop, .01, 1);
    check_range("PhaseOptions.certainty", certainty, 0, 100);
    check_range("PhaseOptions.robust_scale", robust_scale, 1e-6, 1e3);
    check_range("PhaseOptions.timing_std", timing_std, 0, 100);
    check_range("PhaseOptions.measured_std", measured_std, 0, 1e3);
    check_range("PhaseOptions.exponent_std", exponent_std, 0, 100);
    check_range("PhaseOptions.shape_error", shape_error, 0, 100);
    check_range("PhaseOptions.num_draws", num_draws, 0, 10000);
}

}  // namespace mimetic
