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

/// Rows between which no frame is missing and no scene begins.
struct Stretch {
    int first = 0, last = 0;
};

/// All stretches, in order; scene_starts: frames at which scenes begin.
std::vector<Stretch> stretches(VectorIn frames, const std::vector<double>& scene_starts);

/// Events of a curve: peaks that the curve falls from on both sides by enough, each with the rows that it
/// alone has. None is in more than one stretch, and none that a
/// stretch shows no onset of (or no fall) is taken for one that begins (or ends) within it.
std::vector<EventRows> find_events(VectorIn frames, VectorIn values, const PhaseOptions& options);

}  // namespace mimetic
