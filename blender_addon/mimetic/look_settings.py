# SPDX-License-Identifier: GPL-3.0-or-later
"""A look to teach, as a scene's list has it."""

import json

import bpy
from bpy.props import EnumProperty, IntProperty, PointerProperty, StringProperty

from . import native
from .scene_out import expressions

# As the package's words for parts, in capitals
PARTS = (
    ("BROWS", "Brows", "Both brows"),
    ("EYES", "Eyes", "Both eyes, with lids and gaze"),
    ("MOUTH", "Mouth", "Mouth and chin"),
)
STATES = (
    ("LIVE", "As Seen", "What is measured live while the look is kept"),
    ("SLIDERS", "Sliders", "What the face's sliders were at when Take Sliders was pressed"),
    ("EXPRESSION", "Expression", "A kept expression, at its peak"),
)


def _is_expression(self, candidate) -> bool:
    return expressions.is_expression(candidate)


class MimeticLook(bpy.types.PropertyGroup):
    """`name` is the look's; that of the face at rest is called neutral."""

    parts: EnumProperty(
        name="Parts",
        items=PARTS,
        options={"ENUM_FLAG"},
        description="Of which the look is; none takes all in which it differs from the others",
    )
    state: EnumProperty(
        name="Drives", items=STATES, description="What the character's face does for this look"
    )
    sliders: StringProperty(name="Sliders", description="Values by muscle, as JSON")
    expression: PointerProperty(
        name="Expression",
        type=bpy.types.Action,
        poll=_is_expression,
        description="The kept expression that is driven",
    )
    frame: IntProperty(
        name="Frame",
        min=0,
        description="Footage frame in which a clip in the camera's place shows the look; 0 keeps "
        "it when Keep Look is pressed",
    )


def obstacle(look: MimeticLook) -> str:
    """Why a look cannot be kept, or ""."""
    if look.state == "SLIDERS" and not look.sliders:
        return "Press Take Sliders first: the look has no values of its own"
    if look.state == "EXPRESSION" and look.expression is None:
        return "Choose an expression first, or have the look drive what is seen"
    return ""


def as_look(look: MimeticLook, frame: int = 0):
    """The package's Look; raises InvalidInput."""
    text = look.name + (":" if look.parts else "") + ",".join(sorted(look.parts)).lower()
    parsed = native.puppet("taught_look").parse_shown_look(text)
    values = None
    if look.state == "SLIDERS":
        values = json.loads(look.sliders)
    elif look.state == "EXPRESSION":
        values = expressions.peak_values(look.expression)
    return native.puppet("taught_look").Look(parsed.name, frame, parsed.parts, values)
