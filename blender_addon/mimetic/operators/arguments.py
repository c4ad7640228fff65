# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of panels as properties of operators too: a script gives them in the call.

What a call does not give is as the panel has it. The redo panel hides them: they stand in the
panel already.
"""

from __future__ import annotations

from bpy.props import IntProperty

from .. import native, scene_in

OF_ONE_CALL = {"HIDDEN", "SKIP_SAVE"}


def like(group, name: str):
    """The property of an operator that stands for a panel's, declared as that is."""
    declaration = group.__annotations__[name]
    keywords = {key: value for key, value in declaration.keywords.items() if key != "update"}
    return declaration.function(**{**keywords, "options": OF_ONE_CALL})


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
    first, last = operator.frame_first or None, operator.frame_last or None
    if first is None and last is None:
        return scene_in.frame_range(context.scene)
    if first and last and last < first:
        raise native.invalid_input(f"frame_last {last} is before frame_first {first}")
    return first, last
