# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as a file of its own, .blend or for other programs, from a scene made for it."""

from __future__ import annotations

from pathlib import Path

import bpy
from mathutils import Euler

from .. import captured_takes, compat, native, scene_in, takes
from . import (
    bake,
    blend_file,
    clip,
    exports,
    eye_nodes,
    lost_markers,
    opened_view,
    over_footage,
    take_list,
)


def write(
    performance_path: str,
    out: str,
    footage_path: str | None,
    with_detail: bool = False,
    tolerance: float = 0.0,
    with_units: bool = False,
    by_phases: bool = False,
    with_controls: bool = False,
    as_arkit: bool = False,
    curves: dict | None = None,
    with_eye_nodes: bool = False,
) -> str:
    """Bakes into the scene that is open, which must be empty, and writes it whole or not at all.

    Unlike baking into a user's scene this sets the scene's rate, range and resolution to the
    footage's. with_detail: shapes for what the muscles leave unexplained too. tolerance: of few
    keys with handles, 0 for a key a frame. with_units: sliders of action units too.
    by_phases: few keys at the phases of events first. with_controls: curves on a control object.
    as_arkit: ARKit's 52 shapes instead of muscles, with_eye_nodes: eyeballs as objects that turn,
    both for other programs. curves: `takes.load_edited`'s.
    Returns what was written; raises what the package raises for bad input, and OSError.
    """
    performance = takes.load_edited(performance_path, curves)
    if not with_detail:
        performance = performance.without_detail()
    appearance = native.appearance().appearance_of(performance, footage_path)
    scene = bpy.context.scene
    set_up(scene, performance)
    footage = clip.load(scene, footage_path) if footage_path else None
    take = takes.take_name(footage_path or performance_path)
    is_blend = Path(out).suffix == ".blend"
    contact = None if as_arkit else native.contact_shapes().contact_shapes(performance)
    summary = bake(
        scene,
        performance,
        take,
        appearance,
        footage,
        with_groups=is_blend,
        contact_shapes=contact,
        tolerance=tolerance,
        with_units=with_units,
        by_phases=by_phases,
        use_controls=with_controls,
        as_arkit=as_arkit,
    )
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    face, how = scene.mimetic.face, "by mimetic bake"
    row = take_list.note(face, performance, take, performance_path, frames, how, {})
    captured_takes.keep_read(scene, footage, performance_path, performance)
    scene.frame_set(scene.frame_start)
    if is_blend:
        show(scene, performance, row)
        save(out, footage)
        loses = ""
    else:
        loses = _export(scene, out, performance, footage, take if with_eye_nodes else "")
    frames = f"frames {summary.first:.6g} to {summary.last:.6g}"
    return "; ".join(filter(None, (f"{summary.num_curves} curves, {frames}", loses)))


def _export(scene, out: str, performance, footage, eyes_take: str) -> str:
    """The baked face for other programs; says what is lost. eyes_take: of eyes as objects."""
    if eyes_take:
        eye_nodes.split(scene, performance, footage, eyes_take)
    return exports.write(scene, out, scene.mimetic.face)


def set_up(scene: bpy.types.Scene, performance) -> None:
    rate = native.timing().scene_rate(performance.fps)
    scene.render.fps, scene.render.fps_base = rate.fps, rate.fps_base
    scene.render.resolution_x, scene.render.resolution_y = (int(n) for n in performance.image_size)
    scene.frame_start, scene.frame_end = int(performance.frame[0]), int(performance.frame[-1])
    # The skin wears the footage's own colours: show them as they are
    scene.view_settings.view_transform = "Standard"


def show(scene: bpy.types.Scene, performance, take) -> None:
    """Screens that show the face; renders of it over its footage, in a soft light from above; marks
    where it was lost."""
    lost_markers.show(scene, take)
    opened_view.arrange(scene, scene.mimetic.face)
    sun = bpy.data.objects.new("Key Light", bpy.data.lights.new("Key Light", "SUN"))
    sun.data.energy = 2.0
    sun.data.angle = 0.5
    sun.rotation_euler = Euler((0.9, 0.0, 0.35))
    scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("World")
    compat.use_nodes(world).nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    scene.world = world
    over_footage.set_up(scene, scene.mimetic.face, performance, with_lights=False)


def save(out: str, footage: bpy.types.MovieClip | None) -> None:
    path = Path(out).absolute()
    if footage is not None:  # so that the two can move together
        for media in (footage, *(i for i in bpy.data.images if i.source in {"MOVIE", "SEQUENCE"})):
            media.filepath = bpy.path.relpath(media.filepath, start=str(path.parent))
    blend_file.save_copy(path, with_paths_anew=False)
