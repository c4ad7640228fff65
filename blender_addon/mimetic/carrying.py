# SPDX-License-Identifier: GPL-3.0-or-later
"""An operator that runs beside a window which is closed goes on beside another one.

Blender ends it with its window. What it knows is kept, and an operator of its kind is begun with
that as soon as the window is gone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy

from . import clips

KEPT_KINDS = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}  # of properties; others are read at once


@dataclass(frozen=True)
class Carried:
    """What an operator that was ended knows; nothing of it is Blender's."""

    kind: type
    properties: dict[str, Any]  # that were given
    state: dict[str, Any]  # what it has noted itself
    subject: str  # the clip that it works on


handed: Carried | None = None  # while an operator of its kind is begun with it


def is_closed(window: int) -> bool:
    """Whether a window, as `as_pointer` has it, is gone while Blender goes on beside another."""
    left = bpy.context.window_manager.windows
    return bool(_lasting()) and all(window != other.as_pointer() for other in left)


def carried(operator, subject: str) -> Carried:
    """What `begin` needs of an operator that Blender is about to end."""
    properties = operator.properties
    given = {
        known.identifier: _plain(known, getattr(operator, known.identifier))
        for known in properties.bl_rna.properties
        if known.type in KEPT_KINDS and properties.is_property_set(known.identifier)
    }
    return Carried(type(operator), given, dict(vars(operator)), subject)


def take_over(operator) -> bool:
    """Gives an operator that begins what another one knew; says whether there is any."""
    global handed
    if not is_handed_to(type(operator)):
        return False
    vars(operator).update(handed.state)
    handed = None
    return True


def is_handed_to(kind: type) -> bool:
    return handed is not None and handed.kind is kind


def begin(carried: Carried) -> bool:
    """Begins an operator beside a window that is left; says whether it runs."""
    global handed
    place = _place(carried.subject)
    if not place:
        return False
    operator, handed = carried.kind.bl_idname, carried
    try:
        with bpy.context.temp_override(**place):
            begun = _named(operator)("INVOKE_DEFAULT", **carried.properties)
    except (RuntimeError, TypeError) as error:
        print(f"Mimetic: {operator} cannot go on in another window: {error}")
        return False
    finally:
        handed = None
    return begun == {"RUNNING_MODAL"}


def _named(idname: str):
    """An operator of bpy.ops; a registered class has its name as C has it."""
    module, name = idname.lower().replace("_ot_", ".").split(".")
    return getattr(getattr(bpy.ops, module), name)


def _place(subject: str) -> dict:
    """A window left, and its clip editor with the clip: buttons ask for the one on show."""
    windows = _lasting()
    for window in windows if subject else ():
        for area in window.screen.areas:
            if area.type == "CLIP_EDITOR" and clips.name_of(area.spaces.active.clip) == subject:
                region = next(region for region in area.regions if region.type == "WINDOW")
                return {"window": window, "area": area, "region": region}
    return {"window": windows[0]} if windows else {}


def _lasting() -> list[bpy.types.Window]:
    """Without those of preferences, renders and files to choose."""
    windows = bpy.context.window_manager.windows
    return [window for window in windows if not window.screen.is_temporary]


def _plain(known: bpy.types.Property, value):
    """A value that is there after its operator."""
    if known.type == "ENUM" or not getattr(known, "is_array", False):
        return set(value) if isinstance(value, set) else value
    return tuple(value)
