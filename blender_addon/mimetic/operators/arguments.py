# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of panels as properties of operators too: a script gives them in the call.

What a call does not give is as the panel has it. The redo panel hides them: they stand in the
panel already.
"""

from __future__ import annotations

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty

from .. import native, scene_in

OF_ONE_CALL = {"HIDDEN", "SKIP_SAVE"}


def like(group, name: str):
    """The property of an operator that stands for a panel's, declared as that is."""
    declaration = group.__annotations__[name]
    keywords = {key: value for key, value in declaration.keywords.items() if key != "update"}
    options = OF_ONE_CALL | ({"ENUM_FLAG"} & keywords.get("options", set()))
    return declaration.function(**{**keywords, "options": options})


def is_given(operator, name: str) -> bool:
    return operator.properties.is_property_set(name)


def chosen(operator, name: str, settings):
    """What the call gives, else what the panel's settings have."""
    return getattr(operator if is_given(operator, name) else settings, name)


class FrameRange:
    """Mixin of operators that take a part of the clip."""

    frame_first: IntProperty(
        name="First",
        min=0,
        options=OF_ONE_CALL,
        description="First footage frame; 0: as the panel has it",
    )
    frame_last: IntProperty(
        name="Last",
        min=0,
        options=OF_ONE_CALL,
        description="Last footage frame; 0: as the panel has it",
    )


def frame_range(operator, context) -> tuple[int | None, int | None] | None:
    """First and last footage frame, None for the whole clip; raises InvalidInput."""
    given = operator.frame_first or None, operator.frame_last or None
    frames = scene_in.frame_range(context.scene) if given == (None, None) else given
    check_order(*(frames or (None, None)))
    return frames


def check_order(first: int | None, last: int | None) -> None:
    """Raises InvalidInput."""
    if first and last and last < first:
        raise native.invalid_input(
            rpt_("frames {first}:{last}: the first is after the last").format(
                first=first, last=last
            )
        )


def set_given(operator, names: tuple[str, ...], settings) -> None:
    """Puts what a call gives into the panel's settings."""
    for name in names:
        if is_given(operator, name):
            setattr(settings, name, getattr(operator, name))
