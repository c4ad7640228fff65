// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase_shape.hpp"

#include <mimetic/shared/checks.hpp>

namespace mimetic {

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
    check_range("PhaseOptions.exponent_std", exponent_std, 0, 100);
    check_range("PhaseOptions.shape_error", shape_error, 0, 100);
    check_range("PhaseOptions.num_draws", num_draws, 0, 10000);
}

}  // namespace mimetic
