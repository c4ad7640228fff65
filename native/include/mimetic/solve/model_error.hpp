// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace mimetic {

/// Error of the model at the true state: a smooth random field over the skin, in the head's x and y, with
/// these standard deviations.
struct ModelError {
    double anyway = 3.5e-4;  ///< metres, constant
    double shape = 5e-4;     ///< metres of depth, visible as the view turns
    double motion = .05;     ///< of the displacement that the modes give

    /// Metres. view_angle_sine: between the view and the reference's; moved: metres.
    double std_of(double view_angle_sine, double moved) const {
        return std::hypot(anyway, shape * view_angle_sine, motion * moved);
    }
};

}  // namespace mimetic
