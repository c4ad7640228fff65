// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/skin/skin_dynamics.hpp>

namespace mimetic {

/// Coefficients of a step of either scheme. With e the decay of the overstrain p within the step:
///   (mass M + stiffness K) du = f + M (mass_velocity v + mass_acceleration a) + K (stiffness_velocity v - u
///   - e p) v <- velocity du + keep_velocity v,  a <- acceleration du + from_velocity v + keep_acceleration
///   a, p <- decay p + build_up du            (exact where u changes linearly within the step)
struct TimeStep {
    explicit TimeStep(const DynamicsOptions& options);

    double mass, stiffness;
    double mass_velocity, mass_acceleration, stiffness_velocity;
    double velocity, keep_velocity;
    double acceleration, from_velocity, keep_acceleration;
    double decay, build_up;
};

}  // namespace mimetic
