# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a character's own controls, as its object keeps it: `object.mimetic.controls`."""

from __future__ import annotations

from collections.abc import Callable

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from . import native
from .writable import KEPT, KEPT_ROWS

# The last: setting another marks the row as edited
FIELDS = ("is_on", "gain", "offset", "lowest", "highest", "curve", "is_edited")


changed: Callable[[bpy.types.Object], None] | None = None  # heard of each row that is edited


def _edit(self, context) -> None:
    self.is_edited = True
    if changed is not None:
        changed(self.id_data)


def _edit_lowest(self, context) -> None:
    if self.lowest > self.highest:
        self.highest = self.lowest  # the other end moves along: nothing lies in a range turned over
    _edit(self, context)


def _edit_highest(self, context) -> None:
    if self.highest < self.lowest:
        self.lowest = self.highest
    _edit(self, context)


class MimeticControl(bpy.types.PropertyGroup):
    """How a control is driven, by its name."""

    is_on: BoolProperty(
        name="Drive",
        default=True,
        update=_edit,
        override=KEPT,
        description="Let performances move this control",
    )
    gain: FloatProperty(
        name="Gain",
        default=1.0,
        soft_min=0.0,
        soft_max=2.0,
        min=-1000.0,
        max=1000.0,
        update=_edit,
        override=KEPT,
        description="What fitted values are multiplied by",
    )
    offset: FloatProperty(
        name="Offset",
        default=0.0,
        soft_min=-1.0,
        soft_max=1.0,
        min=-1000.0,
        max=1000.0,
        update=_edit,
        override=KEPT,
        description="What is added then, in the control's own units: the character's own rest",
    )
    lowest: FloatProperty(
        name="Lowest",
        min=-1000.0,
        max=1000.0,
        update=_edit_lowest,
        override=KEPT,
        description="Values are cut here, in the control's own units",
    )
    highest: FloatProperty(
        name="Highest",
        default=1.0,
        min=-1000.0,
        max=1000.0,
        update=_edit_highest,
        override=KEPT,
        description="Values are cut here, in the control's own units",
    )
    curve: FloatProperty(
        name="Curve",
        default=1.0,
        min=0.1,
        max=10.0,
        soft_min=0.5,
        soft_max=2.0,
        update=_edit,
        override=KEPT,
        description="Exponent before gain and offset: above 1 small motions become smaller, below "
        "1 larger; full ones stay",
    )
    is_edited: BoolProperty(
        name="Edited",
        override=KEPT,
        description="Changed by hand: fitting again leaves the row as it is",
    )
    remark: StringProperty(
        name="Remark", override=KEPT, description="What the last fit says of the control"
    )


class HasControls:
    """Mixin of the properties of a character."""

    controls: CollectionProperty(
        type=MimeticControl,
        override=KEPT_ROWS,
        description="How performances drive its own shape keys",
    )
    active_control: IntProperty(
        name="Control", override=KEPT, description="The row whose settings are shown"
    )


def rows_of(character: bpy.types.Object) -> list:
    """The table as `mimetic.retarget.ControlRow`s; empty before it was made."""
    row = native.controls().ControlRow
    return [
        row(entry.name, **{name: getattr(entry, name) for name in FIELDS})
        for entry in character.mimetic.controls
    ]


def write(character: bpy.types.Object, rows, remarks=None) -> None:
    """Makes these rows the table. remarks: text by control; None leaves what there is."""
    controls, names = character.mimetic.controls, {row.control for row in rows}
    for place in reversed(range(len(controls))):
        if controls[place].name not in names:
            controls.remove(place)
    for place, row in enumerate(rows):
        # Those that are there stay: a library override has its file's rows beside all new ones
        at = controls.find(row.control)
        entry = controls[at] if at >= 0 else controls.add()
        entry.name = row.control
        for name in FIELDS:
            setattr(entry, name, getattr(row, name))
        if remarks is not None:
            entry.remark = remarks.get(row.control, "")
        controls.move(at if at >= 0 else len(controls) - 1, place)
    last = max(len(controls) - 1, 0)
    character.mimetic.active_control = min(character.mimetic.active_control, last)
