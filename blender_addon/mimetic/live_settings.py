# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene remembers of live sessions: `scene.mimetic.live`."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import compat

SOURCES = (
    ("CAMERA", "Camera", "A camera of this computer"),
    ("CLIP", "Clip", "A video file, at its own speed, in a camera's place"),
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
        description="camera:0, camera:1 and so on; camera:NAME as the system names it",
    )
    clip_path: StringProperty(
        name="Clip",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="A video of a face; empty takes the scene's footage",
    )
    microphone: StringProperty(
        name="Microphone",
        description="Recorded beside a camera: its name, on Linux `default`; empty records none",
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
    use_subdivision: BoolProperty(
        name="Subdivision",
        description="Keep the face's subdivision while it is driven; without a graphics card that "
        "does it, drawing takes far longer",
    )
    countdown: IntProperty(
        name="Countdown", default=0, min=0, max=60, description="Seconds before a take begins"
    )
