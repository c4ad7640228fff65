# SPDX-License-Identifier: GPL-3.0-or-later
"""The lens that a clip was filmed with: that of the clip's camera in Blender, where it was set."""

import math

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.props import EnumProperty

from . import native

NEW = (24.0, 35.0)  # mm: focal length and sensor width that Blender gives every clip
COEFFICIENTS = {  # of Blender's models of a lens's distortion
    "POLYNOMIAL": ("k1", "k2", "k3"),
    "DIVISION": ("division_k1", "division_k2"),
    "NUKE": ("nuke_k1", "nuke_k2"),
    "BROWN": ("brown_k1", "brown_k2", "brown_k3", "brown_k4", "brown_p1", "brown_p2"),
}
NEAR = 1e-4  # of numbers in single precision


class HasLens:
    """Mixin of what a clip keeps."""

    lens: EnumProperty(
        name="Lens",
        items=(
            (
                "AUTO",
                "If Set",
                "The clip's camera, if it was set: to another lens than the 24 mm on a sensor of "
                "35 mm that Blender gives every clip; else as if it were unknown",
            ),
            ("CLIP", "The Clip's", "Focal length and sensor width of the clip's camera"),
            ("UNKNOWN", "Unknown", "As 43 mm on a sensor of 36 mm, which suits webcams"),
        ),
        description="The lens that the head's distance, depth and turns are measured with",
    )


def known(clip: bpy.types.MovieClip, lens: str = ""):
    """The mimetic.fit.known_lens.KnownLens of a clip, or None; lens: as the clip keeps it, if
    empty. Raises InvalidInput."""
    if not is_known(clip, lens):
        return None
    camera = clip.tracking.camera
    return native.known_lens().KnownLens(camera.focal_length, camera.sensor_width)


def is_known(clip: bpy.types.MovieClip, lens: str = "") -> bool:
    lens = lens or clip.mimetic.lens
    camera = clip.tracking.camera
    now = camera.focal_length, camera.sensor_width
    is_new = all(math.isclose(*pair, rel_tol=NEAR) for pair in zip(now, NEW, strict=True))
    return lens == "CLIP" or (lens == "AUTO" and not is_new)


def sensor_of(clip: bpy.types.MovieClip | None, performance) -> float | None:
    """Width in mm of the sensor that a clip was filmed and captured with, None where unknown."""
    try:
        lens = known(clip) if clip else None
    except native.known_errors():
        return None
    is_of_it = lens and native.known_lens().is_fitted_with(lens, performance)
    return lens.sensor_mm if is_of_it else None


def unread(clip: bpy.types.MovieClip) -> str:
    """What to say where the clip's camera was set to what we do not read, or ""."""
    camera = clip.tracking.camera
    lens = COEFFICIENTS.get(camera.distortion_model, ())
    parts = [iface_("principal point")] if any(camera.principal_point) else []
    parts += [iface_("distortion")] if any(getattr(camera, name) for name in lens) else []
    if not parts:
        return ""
    return iface_(
        "Not read of the clip's camera: {parts}; the face is measured as if "
        "the lens drew straight lines about the picture's middle"
    ).format(parts=iface_(" and ").join(parts))


def remark(clip: bpy.types.MovieClip, fit) -> str:
    """What to say where the clip's face was found with another lens than it has now, or ""."""
    try:
        is_same = native.known_lens().is_fitted_with(known(clip), fit)
    except native.known_errors() as error:
        return str(error)
    if is_same:
        return ""
    return "The face was found with another lens: press Find Face"
