// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <limits>
#include <mimetic/analyse/curve_noise.hpp>
#include <mimetic/analyse/phases.hpp>
#include <optional>

#include "events.hpp"
#include "phase_shape.hpp"

namespace mimetic {

using PhaseParameters = Eigen::Matrix<double, kPhaseParameters, 1>;
inline constexpr double kLeastNoise = .002;

/// Rows of one event: what is fitted, and with which weight.
struct FittedEvent {
    Eigen::VectorXd frames, values, weights;  // n; a weight of 0 leaves the row out
    EventRows rows;
    const CurveNoise* noise;
    std::optional<double> before = std::nullopt;  // `PhaseShape::before`
};

/// One model's best fit to an event.
struct ModelFit {
    PhaseParameters parameters;
    PhaseShape shape;
    double bic = std::numeric_limits<double>::infinity();
    double variance = 0, explained = 0;
};

/// The lowest level before the event's top where it is well above the lowest one after it.
std::optional<double> level_before(const FittedEvent& data);

/// Of each model its best from several starts, and from what the other models found.
std::array<ModelFit, kNumPhaseModels> fit_models(const FittedEvent& data, const PhaseOptions& options);

/// The same model fitted to another draw of the curve, from the fit's parameters.
PhaseShape refit_model(const FittedEvent& drawn, const ModelFit& fit, const PhaseOptions& options);

}  // namespace mimetic
