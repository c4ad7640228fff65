# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes as strips of the NLA, one over the other with an influence. Tracks of the user's own are
never touched: ours are known by their names."""

from __future__ import annotations

from collections.abc import Collection

import bpy

from .. import compat

TRACK = "Mimetic: "


def clear(block: bpy.types.ID, of_actions: Collection | None = None) -> None:
    """Removes our tracks; of_actions: those alone that play one of these."""
    animation = block.animation_data
    if animation is None:
        return
    for track in [track for track in animation.nla_tracks if track.name.startswith(TRACK)]:
        used = {strip.action for strip in track.strips}
        if of_actions is None or used.intersection(of_actions):
            animation.nla_tracks.remove(track)


def add(block: bpy.types.ID, take: str, part, influence: float) -> bpy.types.NlaStrip:
    """A strip of a take's part over what is there, which it covers by its influence."""
    animation = block.animation_data or block.animation_data_create()
    track = animation.nla_tracks.new()
    track.name = f"{TRACK}{take}"
    start = float(part.action.frame_range[0])
    strip = compat.add_strip(track, take, start, part.action, part.slot)
    strip.extrapolation = "HOLD"
    strip.blend_type = "REPLACE"
    if influence != 1:
        strip.use_animated_influence = True  # makes the curve that is keyed here
        strip.fcurves.find("influence").keyframe_points.insert(start, influence)
    return strip


def top(block: bpy.types.ID) -> bpy.types.NlaStrip | None:
    """The uppermost strip of ours, which plays where its influence is full."""
    animation = block.animation_data
    tracks = animation.nla_tracks if animation is not None else ()
    strips = [s for track in tracks if track.name.startswith(TRACK) for s in track.strips]
    return strips[-1] if strips else None


def play(blocks: dict[str, bpy.types.ID], layers: list[tuple]) -> None:
    """Has takes play as strips alone, each over the ones before it; layers: a take's row and its
    influence. Actions that were assigned are no longer, or they would hide the strips."""
    for owner, block in blocks.items():
        clear(block)
        parts = [(row, row.parts[owner], share) for row, share in layers if owner in row.parts]
        if not parts:
            continue
        if block.animation_data is not None:
            block.animation_data.action = None
        for row, part, share in parts:
            add(block, row.name, part, share)
