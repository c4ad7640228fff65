# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the face covers the footage in the camera's view, and the face as lines.

The state is where Blender has it: a second image of the camera, before everything, whose opacity
lets the footage through; the object's display type. Both work in solid mode and material preview.
"""

from __future__ import annotations

import bpy

from .. import compat

WIRE = "WIRE"
SHOWN_AS = "mimetic_shown_as"  # property of a face shown as lines: its display type before
ALIKE = (
    *("source", "clip", "image", "frame_method", "use_flip_x", "use_flip_y", "scale", "rotation"),
    "offset",
)
FRAMES_ALIKE = ("frame_start", "frame_duration", "frame_offset", "use_auto_refresh")


def of(camera: bpy.types.Camera) -> float:
    """1: the face alone; 0: the footage alone."""
    front = front_of(camera)
    return 1.0 - front.alpha if front is not None and front.show_background_image else 1.0


def set_to(camera: bpy.types.Camera, cover: float) -> None:
    """Does nothing for a camera without footage behind what it sees."""
    if not camera.background_images:
        return
    front = front_of(camera)
    if front is None:
        if cover >= 1.0:
            return
        front = camera.background_images.new()
        front.display_depth = "FRONT"
        match(camera, front)
    front.alpha = 1.0 - cover
    front.show_background_image = cover < 1.0  # or it would be drawn for nothing


def front_of(camera: bpy.types.Camera) -> bpy.types.CameraBackgroundImage | None:
    """The image that shows before the face what the first one shows behind it."""
    images = camera.background_images
    if not images:
        return None
    shown = _picture(images[0])
    return next(
        (i for i in images[1:] if i.display_depth == "FRONT" and _picture(i) == shown), None
    )


def match(camera: bpy.types.Camera, front: bpy.types.CameraBackgroundImage) -> None:
    """Has an image show what the first one shows, frame by frame."""
    images = camera.background_images
    behind = images[0]
    for name in ALIKE:
        setattr(front, name, getattr(behind, name))
    for part in ("image_user", "clip_user"):
        for name in FRAMES_ALIKE if part == "image_user" else ("use_render_undistorted",):
            setattr(getattr(front, part), name, getattr(getattr(behind, part), name))
    path = "background_images[{}].image_user.frame_offset"
    number = next(i for i, image in enumerate(images) if image == front)
    camera.driver_remove(path.format(number))
    if front.source == "IMAGE":
        compat.follow(camera, path.format(number), camera, "CAMERA", path.format(0))


def _picture(image: bpy.types.CameraBackgroundImage) -> tuple:
    return image.source, image.clip, image.image


def is_wire(face: bpy.types.Object) -> bool:
    return face.display_type == WIRE


def show_wire(face: bpy.types.Object, is_on: bool) -> None:
    """As lines through which the footage is seen, or again as it was."""
    if is_on == is_wire(face):
        return
    if is_on:
        face[SHOWN_AS] = face.display_type
        face.display_type = WIRE
    else:
        face.display_type = face.pop(SHOWN_AS, "TEXTURED")
