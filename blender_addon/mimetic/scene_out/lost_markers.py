# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a take's face was lost, as markers of the timeline. The user's own are never touched: ours
are known by their names, and one that is renamed is the user's."""

from __future__ import annotations

import bpy

LOST, BACK = "Lost (Mimetic)", "Seen Again (Mimetic)"


def ours(scene: bpy.types.Scene) -> list[bpy.types.TimelineMarker]:
    return [marker for marker in scene.timeline_markers if marker.name in (LOST, BACK)]


def clear(scene: bpy.types.Scene) -> int:
    """Removes our markers; returns how many there were."""
    markers = ours(scene)
    for marker in markers:
        scene.timeline_markers.remove(marker)
    return len(markers)


def show(scene: bpy.types.Scene, row) -> int:
    """Marks the lost ranges of a take, instead of those of another; returns how many."""
    clear(scene)
    for lost in row.lost:
        scene.timeline_markers.new(LOST, frame=round(lost.first))
        scene.timeline_markers.new(BACK, frame=round(lost.last) + 1)
    return len(row.lost)
