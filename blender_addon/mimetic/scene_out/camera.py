# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage's camera, and the footage behind what it sees."""

from __future__ import annotations

import os

import bpy
from mathutils import Matrix

from .. import compat, editors, native, scene_in
from . import actions, clip, cover, opened_view

NAME = "Footage Camera"
LONGEST = 1048574  # Blender's own limit of a frame number
NEAREST = 0.01  # metres: a face may fill the picture


def ensure(scene, lens, world_from_camera) -> bpy.types.Object:
    """The scene's camera object with a `mimetic.placement.Lens`; made active."""
    seen_through = scene.mimetic.camera
    if not scene_in.holds(scene, seen_through):
        seen_through = bpy.data.objects.new(NAME, bpy.data.cameras.new(NAME))
        scene.collection.objects.link(seen_through)
        seen_through.matrix_world = Matrix(world_from_camera)
        scene.mimetic.camera = seen_through
    camera = seen_through.data
    camera.type = "PERSP"
    camera.sensor_fit = lens.fit
    camera.sensor_width = camera.sensor_height = lens.sensor_mm
    camera.lens_unit = "MILLIMETERS"
    camera.lens = lens.focal_mm
    camera.shift_x = lens.shift_x
    camera.shift_y = lens.shift_y
    camera.clip_start = NEAREST
    scene.camera = seen_through
    return seen_through


def show_footage(seen_through, footage, timing, performance, take: str) -> None:
    """Puts the movie clip behind the camera's view, fitted whole into the picture.

    Blender shows one clip frame a scene frame. Where the rates differ, the file is shown as an
    image whose frame is keyed, so that it keeps to the seconds as the face does.
    """
    camera = seen_through.data
    camera.show_background_images = True
    images = camera.background_images
    behind = images[0] if images else images.new()
    front = cover.front_of(camera)
    steps = native.timing().frame_steps(
        performance.frame,
        performance.fps,
        timing.scene_rate,
        timing.frame_start,
        timing.frame_offset,
    )
    if steps is None:
        behind.source = "MOVIE_CLIP"
        behind.clip = footage
    else:
        behind.source = "IMAGE"
        behind.image, first_number = _film(footage)
        behind.image_user.frame_start = timing.frame_start
        behind.image_user.frame_duration = LONGEST
        behind.image_user.use_auto_refresh = True
        holder = actions.new_take(camera, f"{take} footage")
        path = "background_images[0].image_user.frame_offset"
        curve = compat.new_curve(holder, path, 0, "Footage")
        offsets = steps.offsets + first_number - 1
        actions.fill(curve, steps.scene_frames, offsets, actions.CONSTANT)
    clip.show_pixels(footage if steps is None else behind.image, performance.pixel_aspect)
    behind.frame_method = "FIT"
    behind.display_depth = "BACK"
    behind.alpha = 1.0
    if front is not None:
        cover.match(camera, front)


def _film(clip) -> tuple[bpy.types.Image, int]:
    """The clip's file as an image, and the number that Blender gives its first frame.

    One that is missing shows once it is found.
    """
    path = bpy.path.abspath(clip.filepath, library=clip.library)
    if os.path.isfile(path):
        image = bpy.data.images.load(path, check_existing=True)
    else:
        image = bpy.data.images.new(clip.name, 1, 1)
    # As the clip has it: beside the .blend it moves with that
    image.filepath = path if clip.library else clip.filepath
    image.source = clip.source
    if clip.source == "MOVIE":
        return image, 1
    # Of pictures Blender counts by the numbers in their names
    return image, native.footage().number_of(path)


SOLID_TYPES = {"MESH", "CURVE", "CURVES", "SURFACE", "META", "FONT", "VOLUME", "POINTCLOUD"}


def look_through(context, face) -> bool:
    """Turns every 3D view on screen to the scene's camera; says whether any was isolated.

    Whatever else the scene holds may stand before the footage: the start-up cube stands around the
    camera. Then the view shows the face alone (local view), and the scene stays as it is.
    """
    context.view_layer.update()  # what was linked just now is not among its objects yet
    is_isolated = False
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                space = area.spaces.active
                # Out of sight: a local view stays as it was when an undo took the face from it
                is_out = not face.visible_in_viewport_get(space)
                if is_out or _stands_with_others(context, space, face):
                    _isolate(context, window, area, face)
                    is_isolated = True
                space.region_3d.view_perspective = "CAMERA"
                opened_view.show_textures(space.shading)
    return is_isolated


def _stands_with_others(context, space, face) -> bool:
    return any(
        obj.type in SOLID_TYPES and obj != face and obj.visible_in_viewport_get(space)
        for obj in context.view_layer.objects
    )


def _isolate(context, window, area, face) -> None:
    """Local view takes what is selected: the face and its camera, which also stay selected."""
    for obj in context.view_layer.objects:
        obj.select_set(obj in (face, context.scene.camera))
    if area.spaces.active.local_view:
        editors.toggle_local_view(window, area)  # leaves it
    editors.toggle_local_view(window, area)
