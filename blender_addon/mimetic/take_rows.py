# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked takes, each of a captured one (`captured_rows`): what a face or a character remembers of
what was baked on it, `object.mimetic.takes`.

A library override has the rows of the file that it comes from, and keeps its own after them.
"""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import compat
from .captured_rows import NamesCapture
from .writable import KEPT, KEPT_ROWS


class MimeticTakePart(bpy.types.PropertyGroup):
    """An action of a take, and what it moves (its name): OBJECT, KEYS, CONTROL, or KEYS and the
    name of another mesh of the character."""

    action: PointerProperty(type=bpy.types.Action)
    slot: StringProperty(description="Identifier of the action's slot; empty before Blender 4.4")
    handle: IntProperty(description="Of that slot, which may be renamed; 0 if it is not known")

    @property
    def slot_now(self) -> str | None:
        """Identifier of the action's slot as it is called now; None where it is gone."""
        return compat.slot_now(self.action, self.slot, self.handle) if self.action else None


class MimeticLostRange(bpy.types.PropertyGroup):
    """Scene frames in which the face was lost and is held."""

    first: FloatProperty(description="Scene frame in which it begins")
    last: FloatProperty(description="Scene frame with which it ends")


class MimeticTake(NamesCapture, bpy.types.PropertyGroup):
    """A bake of a captured take; its name is the baked take's."""

    clip: StringProperty(name="Clip", description="The footage that it was captured from")
    performance: StringProperty(name="Performance", description="Name of the file")
    performance_path: StringProperty(
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="That file (.npz) as it was baked",
    )
    footage: StringProperty(description="Fingerprint of that footage, if it is known")
    first: IntProperty(name="First", description="Footage frame")
    last: IntProperty(name="Last", description="Footage frame")
    scene_first: FloatProperty(description="Scene frame of the first key")
    scene_last: FloatProperty(description="Scene frame of the last key")
    quality: FloatProperty(name="Quality", description="The median, from 0 to 1")
    num_lost: IntProperty(name="Lost", description="Frames in which the face was lost and is held")
    lost: CollectionProperty(type=MimeticLostRange, override=KEPT_ROWS)
    date: StringProperty(name="Date", description="When it was baked")
    settings: StringProperty(name="Settings", description="How it was baked")
    parts: CollectionProperty(type=MimeticTakePart, override=KEPT_ROWS)
    mark: StringProperty(description="Of its curves as they were baked")
    surface: StringProperty(description="Of the shapes of contact and detail that were made for it")
    is_edited: BoolProperty(
        override=KEPT, description="Whether its curves were seen to differ from the bake's"
    )


class HasTakes:
    """Mixin of the properties of a face."""

    takes: CollectionProperty(
        type=MimeticTake, override=KEPT_ROWS, description="What was baked on it, oldest first"
    )
    active_take: IntProperty(
        name="Take", override=KEPT, description="The row whose details are shown"
    )


CLASSES = (MimeticTakePart, MimeticLostRange, MimeticTake)
