// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// A curve by few keys, with straight handles a third of the way to the next key: a cubic between two keys,
/// smooth through them, as animation programs draw it.
struct SparseCurve {
    Eigen::VectorXd frames;  ///< K, of the dense curve's own, rising
    Eigen::VectorXd values;  ///< K
    Eigen::VectorXd slopes;  ///< K, a frame
    double error = 0;        ///< farthest from the dense curve at any of its frames
    double value(double frame) const;
};

/// The fewest keys that were found to stay within `tolerance` (above 0) of a dense curve. Keys lie first at
/// the change points of its events, rest before and after each among them, then where the error is
/// largest. What is at rest stays at rest. frames, values: N, frames rising. Throws InvalidInput.
SparseCurve reduce_curve(VectorIn frames, VectorIn values, double tolerance);

/// The same of C curves that are keyed at the same frames, as the parts of a rotation are: one each.
/// values: N x C. Throws InvalidInput.
std::vector<SparseCurve> reduce_together(VectorIn frames, const Eigen::Ref<const Eigen::MatrixXd>& values,
                                         double tolerance);

/// One curve with keys at the phases of its events.
struct PhaseKeys {
    SparseCurve curve;
    std::vector<int> keys_of_event;  ///< one an event: keys from its onset to where it is at rest again
};

/// Keys first at each event's onset, apex, release, and where it is at rest again; then, in the events that
/// are still off by more than `tolerance`, where the error is largest; then anywhere. stds: N, of the values.
/// Throws InvalidInput.
PhaseKeys reduce_by_phases(VectorIn frames, VectorIn values, VectorIn stds, double tolerance);

}  // namespace mimetic
