// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/analyse/phases.hpp>

namespace mimetic {

/// Rows of one event with some rest around it, and its highest row.
struct EventRows {
    int first = 0, last = 0, top = 0;
    bool begins_before = false, ends_after = false;
    bool is_long = false;  // held for long enough that its level may drift
};

/// Events of a curve: peaks that the curve falls from on both sides by enough, each with the rows that it
/// alone has. Rows between which frames are missing are never in one event.
std::vector<EventRows> find_events(VectorIn frames, VectorIn values, const PhaseOptions& options);

}  // namespace mimetic
