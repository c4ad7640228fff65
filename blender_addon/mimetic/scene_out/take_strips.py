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
    compat.leave_tweak_mode(block)
    for track in _ours(block):
        used = {strip.action for strip in track.strips}
        if of_actions is not None and not used.intersection(of_actions):
            continue
        if _is_inherited(track):
            track.mute = True  # removed, its strips would come back in the place of our own
        else:
            block.animation_data.nla_tracks.remove(track)


def add(block: bpy.types.ID, take: str, part, influence: float) -> bpy.types.NlaStrip:
    """A strip of a take's part over what is there, which it covers by its influence."""
    animation = block.animation_data or block.animation_data_create()
    track = animation.nla_tracks.new()
    track.name = f"{TRACK}{take}"
    start = float(part.action.frame_range[0])
    strip = compat.add_strip(track, take, start, part.action, part.slot_now)
    strip.extrapolation = "HOLD"
    strip.blend_type = "REPLACE"
    if influence != 1:
        strip.use_animated_influence = True  # makes the curve that is keyed here
        strip.fcurves.find("influence").keyframe_points.insert(start, influence)
    return strip


def top(block: bpy.types.ID) -> bpy.types.NlaStrip | None:
    """The uppermost strip of ours, which plays where its influence is full."""
    strips = strips_of(block)
    return strips[-1] if strips else None


def strips_of(block: bpy.types.ID) -> list[bpy.types.NlaStrip]:
    """Ours, from below."""
    return [strip for track in _ours(block) for strip in track.strips]


def play(blocks: dict[str, bpy.types.ID], layers: list[tuple]) -> None:
    """Has takes play as strips alone, each over the ones before it; layers: a take's row and its
    influence. Actions that were assigned are no longer, or they would hide the strips."""
    for owner, block in blocks.items():
        clear(block)
        parts = [(row, row.parts[owner], share) for row, share in layers if owner in row.parts]
        if not parts:
            continue
        compat.unassign(block)
        for row, part, share in parts:
            add(block, row.name, part, share)


def _ours(block: bpy.types.ID) -> list[bpy.types.NlaTrack]:
    """Our tracks, less those that `clear` silenced on a library override."""
    animation = block.animation_data
    tracks = animation.nla_tracks if animation is not None else ()
    ours = [track for track in tracks if track.name.startswith(TRACK)]
    return [track for track in ours if not (track.mute and _is_inherited(track))]


def _is_inherited(track: bpy.types.NlaTrack) -> bool:
    """Whether a library override has a track from the file that it comes from."""
    block = track.id_data
    owner = block.user if isinstance(block, bpy.types.Key) else block
    return owner.override_library is not None and track.is_override_data
