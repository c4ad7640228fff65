# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: the panel Adjust Last Operation, by the screen's mouse and keys."""

from __future__ import annotations

import bpy
from undoing import at_rest, becomes, difference, editors, on_screen, press, redo, undo
from walk import Steps, Walk, area_of, override

FIRST_ROW, ROW = (
    44,
    23,
)  # pixels from the panel's top to the first row's middle, and from row to row
LAID_OUT = 0.4  # seconds, for Blender to draw the panel as high as this operator's
BLENDERS = {"rna_type", *bpy.types.Operator.bl_rna.properties.keys()}


def last() -> bpy.types.Operator:
    return bpy.context.window_manager.operators[-1]


def values() -> dict:
    """What the last operator was called with, as a script calls it."""
    given = last().properties
    return {
        prop.identifier: value_of(given, prop)
        for prop in given.bl_rna.properties
        if prop.identifier not in BLENDERS
    }


def value_of(given, prop):
    value = getattr(given, prop.identifier)
    return tuple(value) if getattr(prop, "is_array", False) else value


def rows_above(name: str) -> int:
    """How many rows of the panel are above a setting's."""
    shown = [
        prop
        for prop in last().properties.bl_rna.properties
        if prop.identifier not in BLENDERS and not prop.is_hidden
    ]
    before = shown[: [prop.identifier for prop in shown].index(name)]
    return sum(max(getattr(prop, "array_length", 0), 1) for prop in before)


def panel_of(kind: str) -> bpy.types.Region:
    return next(region for region in area_of(kind)[1].regions if region.type == "HUD")


def opened(walk: Walk, name: str, kind: str) -> Steps:
    """Opens the panel in the corner of an editor by a click on its header, where it is closed."""
    yield from walk.until(lambda: panel_of(kind).height > 1, 10, f"{name} has its redo panel")
    yield LAID_OUT
    panel = panel_of(kind)
    if panel.height > 2 * ROW:
        return
    x, y = on_screen(panel.x + 60, panel.y + panel.height - 12)
    yield from walk.ask(f"{name}-open.act", f"mousemove {x} {y} sleep 0.3 click 1")
    yield from walk.until(lambda: panel_of(kind).height > 2 * ROW, 10, "a click opens the panel")
    yield LAID_OUT


def change(walk: Walk, name: str, kind: str, setting: str, typed: str, row: int = -1) -> Steps:
    """Gives a setting of the last operator another value: types, ticks, chooses from its list.

    typed: nothing for a tick box; for a list how often Down is pressed, the first time for what
    is chosen already, or nothing for the next one.
    row: of the panel, where the operator draws its own.
    """
    yield from opened(walk, name, kind)
    before, panel = value_of(last().properties, rna(setting)), panel_of(kind)
    row = rows_above(setting) if row < 0 else row
    x, y = on_screen(panel.x + 0.75 * panel.width, panel.y + panel.height - FIRST_ROW - ROW * row)
    typing = f"click --repeat 2 --delay 60 1 sleep 0.3 key ctrl+a type {typed}"
    do = {"BOOLEAN": "click 1", "ENUM": "click 1 sleep 0.4"}.get(rna(setting).type, typing)
    if rna(setting).type == "ENUM":
        do += " key Down sleep 0.1" * int(typed or 2) + " key Return"
    yield from walk.ask(f"{name}-change.act", f"mousemove {x} {y} sleep 0.3 {do}")
    if do == typing:
        yield from walk.ask(f"{name}-enter.act", "sleep 0.3 key Return")
    claim = f"{setting} of {name} is changed in its redo panel"
    yield from walk.until(lambda: value_of(last().properties, rna(setting)) != before, 15, claim)
    now = value_of(last().properties, rna(setting))
    if do == typing:
        is_typed = now == typed if rna(setting).type == "STRING" else abs(now - float(typed)) < 1e-6
        walk.check("to what was typed", is_typed, now)


def try_out(
    walk: Walk, name: str, before: dict, kind: str, setting: str, typed: str, row: int = -1
) -> Steps:
    """Of the operator that ran last, in an editor: another value in its redo panel gives what a
    call with that value does; undo and redo hold then too. before: the document without it."""
    at_first = yield from at_rest(walk, name)
    yield from opened(walk, name, kind)
    yield from walk.picture(f"{name}-panel")
    room = next(region for region in area_of(kind)[1].regions if region.type == "WINDOW").height
    height = panel_of(kind).height
    walk.check("the panel fits into its editor", height < room - ROW, (height, room))
    yield from change(walk, name, kind, setting, typed, row)
    changed = yield from at_rest(walk, f"{name}, changed")
    walk.check(f"{setting} changes what {name} gives", difference(at_first, changed))
    shown, given = editors(), values()
    operator = getattr(bpy.ops.mimetic, last().bl_idname.removeprefix("MIMETIC_OT_"))
    yield from walk.picture(f"{name}-changed")
    yield from undo(walk, name, before)
    yield from redo(walk, name, changed, shown)
    yield from press(walk, f"{name}-undo", "VIEW_3D", "ctrl+z")
    yield from becomes(walk, before, f"undo leaves nothing of {name} a second time")
    with bpy.context.temp_override(**override(kind)):
        answer = operator("EXEC_DEFAULT", True, **given)
    walk.check(f"a call of {name} with what the panel shows runs", answer == {"FINISHED"}, answer)
    yield from becomes(walk, changed, f"and gives what the redo panel of {name} gave")


def rna(setting: str):
    return last().properties.bl_rna.properties[setting]
