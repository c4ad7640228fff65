# SPDX-License-Identifier: GPL-3.0-or-later
"""Editors are not of the document: what an undo takes from them a redo must bring back."""

import bpy
import pytest
from scene_state import in_window


@pytest.fixture
def editor():
    area = bpy.context.window_manager.windows[0].screen.areas[0]
    before, area.type = area.type, "CLIP_EDITOR"
    yield area.spaces.active
    area.type = before


def test_a_redo_shows_the_clip_again_that_an_undo_took(scene, footage, editor):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mimetic.load_clip("EXEC_DEFAULT", True, filepath=str(footage))
    assert editor.clip is not None
    in_window(bpy.ops.ed.undo)
    assert editor.clip is None
    in_window(bpy.ops.ed.redo)
    assert editor.clip is not None
    assert editor.clip == bpy.context.scene.mimetic.clip


def test_an_editor_that_somebody_emptied_stays_empty(scene, footage, editor):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mimetic.load_clip("EXEC_DEFAULT", True, filepath=str(footage))
    in_window(bpy.ops.ed.undo)
    in_window(bpy.ops.ed.redo)
    editor.clip = None
    bpy.ops.ed.undo_push(message="emptied")
    in_window(bpy.ops.ed.undo)
    assert bpy.context.scene.mimetic.clip is not None
    assert editor.clip is None
