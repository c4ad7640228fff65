# SPDX-License-Identifier: GPL-3.0-or-later
"""All that operators of ours write into a scene, for what is to be the same before and after."""

import json

import bpy
import numpy as np


def in_window(operator) -> None:
    """Of Blender's own, which loses the window that it was called in."""
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    place = {"window": window, "screen": window.screen, "area": area, "region": area.regions[-1]}
    with bpy.context.temp_override(**place):
        assert operator("EXEC_DEFAULT", True) == {"FINISHED"}  # with its step for undo


def state(extension) -> dict:
    """All that our operators write, as numbers, texts and arrays."""
    scene = bpy.context.scene
    scene.frame_set(scene.frame_current)
    return written_into(scene, extension)


def written_into(scene: bpy.types.Scene, extension) -> dict:
    """The same as it stands, without a frame that is set for it."""
    written = {"settings": settings_of(scene.mimetic)}
    marks = [(marker.name, marker.frame) for marker in scene.timeline_markers]
    written["markers"] = sorted(marks)
    written["assets"] = sorted(
        (action.name, *action.frame_range, action.asset_data.description)
        for action in bpy.data.actions
        if action.asset_data
    )
    for shown in scene.objects:
        written[shown.name] = np.array(shown.matrix_world)
        written[f"{shown.name} curves"] = curves_of(extension, shown)
        written[f"{shown.name} takes"] = [row.name for row in shown.mimetic.takes]
        written[f"{shown.name} controls"] = [
            [entry.name, *(getattr(entry, name) for name in extension("control_rows").FIELDS)]
            for entry in shown.mimetic.controls
        ]
        if shown.type == "CAMERA":
            lens = shown.data
            written[f"{shown.name} lens"] = (lens.lens, lens.shift_x, lens.shift_y)
        if shown.type == "MESH" and shown.data.shape_keys:
            written |= keys_of(extension, shown)
    for clip in bpy.data.movieclips:
        for followed in clip.tracking.objects:
            for track in followed.tracks:
                name = f"{clip.name} {followed.name} {track.name}"
                written[name] = np.array([(m.frame, *m.co) for m in track.markers])
    return written


def settings_of(settings) -> dict:
    head = settings.head
    kept = [settings.performance_path, head.bone, head.neck]
    names = [bool(part) and part.name for part in (settings.clip, settings.face, settings.camera)]
    of_clip = settings.clip.mimetic.footage[:1] if settings.clip else []
    kept += [footage.performance_path for footage in of_clip]
    kept += [row.performance_path for footage in of_clip for row in footage.captured]
    kept += [footage.corrections for footage in of_clip]
    kept += [(look.name, look.state, look.frame, look.sliders) for look in settings.live.looks]
    fit = [json.loads(footage.face_fit or "{}") for footage in of_clip]  # of few digits
    return {"kept": kept, "names": names, "at": head.rest_frame, "fit": fit}


def curves_of(extension, block) -> dict:
    holder = extension("compat").curves(block)
    return {
        f"{curve.data_path}[{curve.array_index}]": np.array(
            [p.co[:] for p in curve.keyframe_points]
        )
        for curve in (holder.fcurves if holder else ())
    }


def keys_of(extension, head) -> dict:
    keys = head.data.shape_keys
    levels = {modifier.name: modifier.levels for modifier in head.modifiers}
    written = {f"{head.name} modifiers": levels, "values": curves_of(extension, keys)}
    tracks = keys.animation_data.nla_tracks if keys.animation_data else ()
    written[f"{head.name} strips"] = [
        (strip.action.name, strip.frame_start, strip.frame_end, strip.influence)
        for track in tracks
        for strip in track.strips
    ]
    for key in keys.key_blocks:
        points = np.empty(3 * len(key.points), dtype=np.float32)
        key.points.foreach_get("co", points)
        limits = (key.slider_min, key.slider_max)
        written[f"{head.name} {key.name}"] = {"points": points, "limits": limits, "at": key.value}
    return written


def assert_same(before, after, where="") -> None:
    if isinstance(before, dict):
        assert before.keys() == after.keys(), where
        for name in before:
            assert_same(before[name], after[name], f"{where} / {name}")
    elif isinstance(before, list):
        assert_same(dict(enumerate(before)), dict(enumerate(after)), where)
    elif isinstance(before, np.ndarray | float):
        np.testing.assert_allclose(after, before, rtol=1e-6, atol=1e-5, err_msg=where)
    else:
        assert before == after, where
