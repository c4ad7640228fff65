# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage's camera, and the footage behind what it sees."""

from __future__ import annotations

import bpy
from mathutils import Matrix

from .. import compat, native
from . import actions

NAME = "Footage Camera"
LONGEST = 1048574  # Blender's own limit of a frame number
NEAREST = 0.01  # metres: a face may fill the picture


def ensure(scene, lens, world_from_camera) -> bpy.types.Object:
    """The scene's camera object with a `mimetic.placement.Lens`; made active."""
    seen_through = scene.mimetic.camera
    if seen_through is None or seen_through.name not in scene.objects:
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


def show_footage(seen_through, clip, timing, performance, take: str) -> None:
    """Puts the clip behind the camera's view, fitted whole into the picture.

    Blender shows one clip frame a scene frame. Where the rates differ, the file is shown as an
    image whose frame is keyed, so that it keeps to the seconds as the face does.
    """
    camera = seen_through.data
    camera.show_background_images = True
    images = camera.background_images
    behind = images[0] if images else images.new()
    keyed = native.part("timing").frame_steps(
        performance.frame,
        performance.fps,
        timing.scene_rate,
        timing.frame_start,
        timing.frame_offset,
    )
    if keyed is None:
        behind.source = "MOVIE_CLIP"
        behind.clip = clip
    else:
        behind.source = "IMAGE"
        behind.image = bpy.data.images.load(clip.filepath, check_existing=True)
        behind.image.source = "MOVIE"
        behind.image_user.frame_start = timing.frame_start
        behind.image_user.frame_duration = LONGEST
        behind.image_user.use_auto_refresh = True
        holder = actions.new_take(camera, f"{take} footage")
        path = "background_images[0].image_user.frame_offset"
        curve = compat.new_curve(holder, path, 0, "Footage")
        actions.fill(curve, keyed.scene_frames, keyed.offsets, actions.CONSTANT)
    behind.frame_method = "FIT"
    behind.display_depth = "BACK"
    behind.alpha = 1.0


def look_through(context) -> None:
    """Turns every 3D view on screen to the scene's camera."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
