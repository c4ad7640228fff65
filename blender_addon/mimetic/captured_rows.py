# SPDX-License-Identifier: GPL-3.0-or-later
"""What a clip remembers of its captured takes: the performance files that were captured, refined or
loaded. What was baked of them is remembered by faces (`take_rows`)."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from . import compat


class NamesCapture:
    """Mixin of what names a performance file, by a `performance_path`."""

    performance_folder: StringProperty(
        description="What // stood for as that was written, the whole path of the .blend's folder"
    )
    capture: StringProperty(description="Digest of what was measured, as that file had it then")


class MimeticCapturedTake(NamesCapture, bpy.types.PropertyGroup):
    """A captured take; its name is its file's, without what all end in."""

    performance_path: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="The file (.npz)",
    )
    first: IntProperty(name="First", description="Footage frame")
    last: IntProperty(name="Last", description="Footage frame")
    quality: FloatProperty(name="Quality", description="The median, from 0 to 1")
    num_lost: IntProperty(name="Lost", description="Frames in which the face was lost and is held")
    date: StringProperty(name="Date", description="When its file was written")
    focal_mm: FloatProperty(
        name="Focal Length", description="Of the lens in mm, as on a sensor 36 mm wide"
    )
    is_calibrated: BoolProperty(description="Whether the person was calibrated")
    is_head_alone: BoolProperty(description="Whether muscles were not measured")
    num_corrected: IntProperty(description="Frames that a person corrected, as it has them")


class KeepsCapturedTakes(NamesCapture):
    """Mixin of what belongs to footage."""

    performance_path: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="The captured take of the footage that is used (.npz)",
    )
    captured: CollectionProperty(
        type=MimeticCapturedTake, description="Captured takes of the footage, oldest first"
    )
    active_captured: IntProperty(
        name="Captured Take", description="Number of the row whose details are shown"
    )


CLASSES = (MimeticCapturedTake,)
