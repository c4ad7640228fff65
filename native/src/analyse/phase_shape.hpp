// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/phases.hpp>
#include <optional>

namespace mimetic {

/// The parameters that a fit turns, all of one size: rest, amplitude, onset, log rise, log(1 + hold),
/// exponent, log release time, log of relaxation over release time, relaxed share, drift.
inline constexpr int kPhaseParameters = 10;
inline constexpr int kRest = 0;
inline constexpr int kAmplitude = 1;
inline constexpr int kOnset = 2;
inline constexpr int kRise = 3;
inline constexpr int kHold = 4;
inline constexpr int kExponent = 5;
inline constexpr int kRelease = 6;
inline constexpr int kRelaxation = 7;
inline constexpr int kShare = 8;
inline constexpr int kDrift = 9;

/// (e^(k s) - 1) / (e^k - 1), s between 0 and 1; straight as k goes to 0.
template <typename T>
T applied_share(const T& s, const T& k) {
    using std::abs;
    using std::expm1;
    if (abs(k) < 1e-4) {
        return s + .5 * k * s * (s - 1.);
    }
    return expm1(k * s) / expm1(k);
}

/// Of the amplitude at a frame, 0 to 1, of what is applied from rest.
template <typename T>
T phase_share(PhaseModel model, double frame, const T& onset, const T& rise, const T& hold, const T& exponent,
              const T& release_time, const T& relaxation_time, const T& share, const T& drift) {
    using std::exp;
    if (frame <= onset) {
        return T(0);
    }
    if (frame < onset + rise) {
        const T s = (frame - onset) / rise;
        return model == PhaseModel::linear_ramp ? s : applied_share(s, exponent);
    }
    const T since = frame - onset - rise - hold;
    if (since <= 0.) {
        return hold > 1e-9 ? T(1. + drift * (1. + since / hold)) : T(1);
    }
    const T level = 1. + drift;
    switch (model) {
        case PhaseModel::linear_ramp:
            return since < release_time ? T(level * (1. - since / release_time)) : T(0);
        case PhaseModel::one_exponential:
            return level * exp(-since / release_time);
        default:
            return level *
                   ((1. - share) * exp(-since / release_time) + share * exp(-since / relaxation_time));
    }
}

/// Value of an event that is applied from a level above rest where there is one; share: `phase_share`.
template <typename T>
T phase_value(double frame, const T& rest, const T& amplitude, const std::optional<double>& before,
              const T& apex, const T& share) {
    if (before && frame < apex) {
        return *before + (rest + amplitude - *before) * share;
    }
    return rest + amplitude * share;
}

}  // namespace mimetic
