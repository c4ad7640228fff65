# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene remembers of live sessions: `scene.mimetic.live`."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from . import compat
from .look_settings import MimeticLook

SOURCES = (
    ("CAMERA", "Camera", "A camera of this computer"),
    ("CLIP", "Clip", "A video file, at its own speed, in a camera's place"),
)
# As the package's uses of a taught set, in capitals
SET_USES = (
    ("SHARPEN", "Sharpen", "Correct what is measured live by what the set says, each by its error"),
    ("DRIVE", "Drive", "Take what the set knows from the set alone"),
)
DRIVEN = (
    ("MUSCLES", "Muscles", "The muscles' sliders of the face"),
    ("CONTROLS", "Own Controls", "The active character's own shape keys, or its face's bones"),
)
CORNERS = (
    ("TOP_LEFT", "Top Left", ""),
    ("TOP_RIGHT", "Top Right", ""),
    ("BOTTOM_LEFT", "Bottom Left", ""),
    ("BOTTOM_RIGHT", "Bottom Right", ""),
)
# As the package's channels, in capitals
CHANNELS = (
    ("HEAD_POSITION", "Position", "Where the head is"),
    ("HEAD_ROTATION", "Rotation", "How the head is turned"),
    ("EYES", "Eyes", "Gaze, lids and what is about the eyes"),
    ("MOUTH", "Mouth", "Jaw, lips, cheeks and nose"),
    ("BROWS", "Brows", "Brows and forehead"),
)


def package_channels(chosen) -> frozenset[str]:
    """As the package names them."""
    return frozenset(channel.lower() for channel in chosen)


class MimeticLive(bpy.types.PropertyGroup):
    source: EnumProperty(name="Source", items=SOURCES, description="What the face is driven by")
    camera: StringProperty(
        name="Camera",
        default="camera:0",
        description="Which one: camera:0, camera:1 and so on; camera:NAME as the system names it",
    )
    clip_path: StringProperty(
        name="Clip",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="A video of a face; empty takes the scene's footage",
    )
    use_fit: BoolProperty(
        name="Known Head",
        default=True,
        description="Start from the person's head, calibration and extents of the muscles that are "
        "known already, if there is a fit; another person is followed as a stranger",
    )
    fit_path: StringProperty(
        name="Fit",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="A fit.json of the person, of any footage; empty takes the face that was found "
        "in the scene's footage",
    )
    microphone: StringProperty(
        name="Microphone",
        description="Recorded beside a camera: its name, on Linux `default`; empty records none",
    )
    driven: EnumProperty(
        name="Drives", items=DRIVEN, description="What of the character a session moves"
    )
    taught_set: StringProperty(
        name="Taught Set",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="Looks of this person that were taught (`mimetic puppet teach`); may be empty",
    )
    set_use: EnumProperty(
        name="Use of the Set", items=SET_USES, description="What the taught set is for"
    )
    use_teaching: BoolProperty(
        name="Teach",
        description="Keep looks for a taught set while a session runs, by Keep Look; a set that is "
        "named is taught again, and does not drive the face meanwhile",
    )
    looks: CollectionProperty(
        type=MimeticLook, name="Looks", description="Looks to teach, in the order of the list"
    )
    active_look: IntProperty(
        name="Look", description="Row of the list, from 0, whose look buttons act on"
    )
    advice: StringProperty(
        name="Advice", description="What the set that was saved last is worth, line by line"
    )
    stillness: FloatProperty(
        name="Stillness",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="0 lags least, 1 jitters least",
    )
    channels: EnumProperty(
        name="Channels",
        items=CHANNELS,
        options={"ENUM_FLAG"},
        default={identifier for identifier, _, _ in CHANNELS},
        description="What moves and is recorded; all else stays, and keeps the curves that it has",
    )
    use_fast_view: BoolProperty(
        name="Fast View",
        default=True,
        description="Draw the 3D view without subdivision of the face, its outline, anti-aliasing "
        "and overlays while a session runs: without a graphics card they take most of the time",
    )
    show_picture: BoolProperty(
        name="Picture",
        default=True,
        description="Show the camera's picture in the 3D view while a session runs",
    )
    show_plots: BoolProperty(
        name="Plots",
        default=True,
        description="Show what groups of muscles, jaw and lids did in the last seconds",
    )
    view_size: IntProperty(
        name="Size",
        default=240,
        min=100,
        max=1000,
        subtype="PIXEL",
        description="Width of picture and plots, at a UI scale of 1",
    )
    view_corner: EnumProperty(
        name="Corner",
        items=CORNERS,
        default="BOTTOM_LEFT",
        description="Where in the 3D view picture and plots are",
    )
    countdown: IntProperty(
        name="Countdown", default=0, min=0, max=60, description="Seconds before a take begins"
    )
