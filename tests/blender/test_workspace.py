# SPDX-License-Identifier: GPL-3.0-or-later
"""Without a window the workspace is refused, and nothing opens it. What it looks like in one is
walked through in tests/window/walk_face_view.py."""

import bpy
import pytest


def test_the_workspace_that_it_begins_as_is_shipped(extension, monkeypatch):
    workspace = extension("workspace")
    path = workspace._shipped_file()
    with bpy.data.libraries.load(path) as (there, _):
        assert workspace.SHIPPED[1] in there.workspaces
    monkeypatch.setattr(bpy.utils, "app_template_paths", lambda path=None: iter(()))
    assert workspace._shipped_file() is None


def test_without_a_window_it_is_refused(extension):
    before = list(bpy.data.workspaces)
    assert extension("workspace").no_workspace() == "Workspaces are for Blender's window"
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.mimetic.open_workspace()
    assert list(bpy.data.workspaces) == before


def test_a_dropped_clip_changes_no_screen_there(scene, footage):
    before = list(bpy.data.workspaces), [len(screen.areas) for screen in bpy.data.screens]
    bpy.ops.mimetic.load_clip("INVOKE_DEFAULT", filepath=str(footage))
    assert scene.mimetic.clip is not None
    assert before == (list(bpy.data.workspaces), [len(s.areas) for s in bpy.data.screens])


def test_nothing_goes_on_when_the_extension_is_switched_off(extension):
    workspace = extension("workspace")
    ticks = []
    workspace._steps = (ticks.append(i) for i in range(9))
    bpy.app.timers.register(workspace._tick)
    workspace.unregister()
    assert not bpy.app.timers.is_registered(workspace._tick)
    assert workspace._steps is None and workspace._tick() is None and ticks == []
