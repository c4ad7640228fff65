# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes are known by slots of their actions, which users rename and remove."""

import dataclasses

import bpy
import pytest
from test_takes import KINDS, playing, value

pytestmark = pytest.mark.skipif(bpy.app.version < (4, 4), reason="Blender 4.4 brought slots")


def rename_slots() -> None:
    for action in bpy.data.actions:
        for number, slot in enumerate(action.slots):
            slot.name_display = f"Anna {number}"


@pytest.mark.parametrize("to", KINDS)
def test_a_take_plays_by_slots_that_were_renamed(extension, scene, bake, sheet, to):
    weak = dataclasses.replace(sheet, activations=0.5 * sheet.activations)
    face = bake(sheet, to=to)
    bake(weak, "again", to=to)
    rename_slots()
    assert playing(extension, face) == "again"
    assert not extension("scene_out").take_list.is_edited(face.mimetic.takes["hero"])
    for name, given in (("hero", sheet), ("again", weak)):
        assert bpy.ops.mimetic.play_take(take=name) == {"FINISHED"}
        assert playing(extension, face) == name
        assert value(scene, face, 7) == pytest.approx(given.activations[6, 0], abs=1e-5)


@pytest.mark.parametrize("slot", ["KEKey", ""], ids=["no handle", "made before slots"])
def test_a_row_of_an_earlier_file_plays_by_the_only_slot(extension, scene, bake, sheet, slot):
    face = bake(sheet)
    bake(sheet, "again")
    rename_slots()
    part = face.mimetic.takes["hero"].parts["KEYS"]
    part.handle, part.slot = 0, slot
    assert bpy.ops.mimetic.play_take(take="hero") == {"FINISHED"}
    assert playing(extension, face) == "hero"
    assert value(scene, face, 7) == pytest.approx(sheet.activations[6, 0], abs=1e-5)


def test_a_slot_that_is_gone_is_said_and_changes_nothing(extension, bake, sheet):
    face = bake(sheet)
    bake(sheet, "again")
    action = face.mimetic.takes["hero"].parts["KEYS"].action
    action.slots.remove(action.slots[0])
    with pytest.raises(RuntimeError, match="hero muscles no longer has the slot"):
        bpy.ops.mimetic.play_take(take="hero")
    assert playing(extension, face) == "again"
