// SPDX-License-Identifier: GPL-3.0-or-later
#include "time_step.hpp"

#include <cmath>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {

void DynamicsOptions::check() const {
    check_range("step", step, 1e-6, 10);
    check_range("mass_damping", mass_damping, 0, 1e6);
    check_range("stiffness_damping", stiffness_damping, 0, 1e3);
    check_range("relaxation_share", relaxation_share, 0, 1e3);
    check_range("relaxation_time", relaxation_time, 1e-6, 1e6);
}

TimeStep::TimeStep(const DynamicsOptions& options) {
    options.check();
    const double h = options.step;
    const double alpha = options.mass_damping;
    const double beta = options.stiffness_damping;
    const double lapse = h / options.relaxation_time;
    decay = std::exp(-lapse);
    build_up = options.relaxation_share * -std::expm1(-lapse) / lapse;
    if (options.scheme == TimeScheme::newmark) {
        mass = 4 / (h * h) + 2 * alpha / h;
        stiffness = 1 + build_up + 2 * beta / h;
        mass_velocity = 4 / h + alpha;
        mass_acceleration = 1;
        stiffness_velocity = beta;
        velocity = 2 / h;
        keep_velocity = -1;
        acceleration = 4 / (h * h);
        from_velocity = -4 / h;
        keep_acceleration = -1;
    } else {
        mass = 1 / (h * h) + alpha / h;
        stiffness = 1 + build_up + beta / h;
        mass_velocity = 1 / h;
        mass_acceleration = 0;
        stiffness_velocity = 0;
        velocity = 1 / h;
        keep_velocity = 0;
        acceleration = 1 / (h * h);
        from_velocity = -1 / h;
        keep_acceleration = 0;
    }
}

}  // namespace mimetic
