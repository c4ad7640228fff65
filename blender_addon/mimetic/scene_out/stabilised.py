# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage with the head held still: the clip's own stabilisation, by two tracks that we write.

It is a view of the clip and changes no file: the clip editor shows it by Stabilised Footage
(show_stable), a sequencer strip by 2D Stabilised Clip, the compositor by its Stabilize 2D node.
"""

from __future__ import annotations

from contextlib import contextmanager

import bpy

from .. import editors, native, own_tracks, writable


def hold_still(clip: bpy.types.MovieClip, performance) -> int:
    """Holds the head of a `mimetic.performance.Performance` still; returns the number of frames."""
    writable.check(writable.no_tracks(clip))
    places = native.stabilisation().anchors(performance)
    parts = native.projection()
    release(clip)
    names = []
    for i, name in enumerate(own_tracks.HELD_BY):
        at = parts.picture_coordinates(places[:, i], performance.image_size)
        names.append(_write_track(clip, name, performance.frame - clip.frame_offset, at))
    clip.mimetic.held_by = "\n".join(names)
    _stabilise_by(clip, *names)
    stabilisation = clip.tracking.stabilization
    best = native.projection().reference_index(performance)
    stabilisation.anchor_frame = int(performance.frame[best]) - clip.frame_offset
    stabilisation.use_2d_stabilization = True
    stabilisation.use_stabilize_rotation = True
    stabilisation.use_stabilize_scale = True
    stabilisation.use_autoscale = False  # it would zoom until no edge shows, past the face
    _show(clip)
    return len(performance.frame)


def release(clip: bpy.types.MovieClip) -> None:
    """Removes our tracks, and with them their stabilisation."""
    for name in own_tracks.held_by(clip):
        _call(clip, bpy.ops.clip.delete_track, (name,))
    clip.mimetic.held_by = ""
    if not len(clip.tracking.stabilization.tracks):
        clip.tracking.stabilization.use_2d_stabilization = False


def _write_track(clip, name: str, frames, places) -> str:
    # Stabilisation reads the tracks of the camera, which is always the first object
    track = clip.tracking.objects[0].tracks.new(name=name, frame=int(frames[0]))
    for frame, place in zip(frames.tolist(), places.tolist(), strict=True):
        track.markers.insert_frame(frame, co=place)
    track.lock = True
    track.hide = True
    return track.name


def _stabilise_by(clip, centre: str, above: str) -> None:
    _call(clip, bpy.ops.clip.stabilize_2d_add, (centre,))
    _call(clip, bpy.ops.clip.stabilize_2d_rotation_add, (above,))


def _show(clip) -> None:
    for area in editors.open_editors("CLIP_EDITOR"):
        if area.spaces.active.clip == clip:
            area.spaces.active.show_stable = True
            area.tag_redraw()


def _call(clip, operator, names) -> None:
    """Runs one of the clip editor's operators on some tracks: there is no other interface."""
    tracking = clip.tracking
    camera = tracking.objects[0]
    before = tracking.objects.active
    selection = {track.name: track.select for track in camera.tracks}
    tracking.objects.active = camera
    for track in camera.tracks:
        track.select = track.name in names
        track.hide = track.hide and track.name not in names
        if track.name in names:
            track.lock = False
    try:
        with _clip_editor(clip) as editor, bpy.context.temp_override(**editor):
            operator()
    finally:
        for track in camera.tracks:
            track.select = selection.get(track.name, False)
        tracking.objects.active = before


@contextmanager
def _clip_editor(clip):
    """A context in a clip editor with the clip; without one, another area becomes one meanwhile."""
    window = bpy.context.window or bpy.context.window_manager.windows[0]
    areas = list(window.screen.areas)
    area = next((a for a in areas if a.type == "CLIP_EDITOR"), areas[0])
    kind = area.ui_type
    area.ui_type = "CLIP_EDITOR"
    space = area.spaces.active
    clip_before, mode = space.clip, space.mode
    space.clip, space.mode = clip, "TRACKING"
    region = next(region for region in area.regions if region.type == "WINDOW")
    try:
        yield {
            "window": window,
            "screen": window.screen,
            "area": area,
            "region": region,
            "space_data": space,
        }
    finally:
        space.mode = mode
        if clip_before is not None:
            space.clip = clip_before
        area.ui_type = kind
