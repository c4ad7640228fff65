# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes with a take that is removed, in files of earlier versions of Blender."""

import bpy
import pytest
from last_result import result


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="our properties are among the user's own")
@pytest.mark.parametrize("is_used", [False, True])
def test_actions_go_with_a_take_in_spite_of_copies_of_an_earlier_version(bake, sheet, is_used):
    """Blender 5 copies our properties, and leaves them among the user's, in files of before."""
    face = bake(sheet)
    bake(sheet, "again")
    actions = [part.action for row in face.mimetic.takes for part in row.parts]
    names = {part.action.name for part in face.mimetic.takes["hero"].parts}
    face["mimetic"] = {"takes": [{"parts": [{"action": action} for action in actions]}]}
    if is_used:
        for action in actions[:2]:
            face[f"mine {action.name}"] = action
    assert bpy.ops.mimetic.remove_take(take="hero") == {"FINISHED"}
    assert set(result()["actions"]) == (set() if is_used else names)
    assert (names <= {action.name for action in bpy.data.actions}) == is_used
    assert ("its actions are used elsewhere" in result()["message"]) == is_used


def test_actions_that_were_removed_before_are_not_called_used(bake, sheet):
    face = bake(sheet)
    for action in list(bpy.data.actions):
        bpy.data.actions.remove(action)
    assert bpy.ops.mimetic.remove_take() == {"FINISHED"}
    assert result()["message"] == "hero is removed"
    assert len(face.mimetic.takes) == 0
