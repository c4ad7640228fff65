# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job or a click was begun for is gone, or somebody was faster, when its turn comes."""

import contextlib
import json
from types import SimpleNamespace

import bpy
import pytest
from test_operators import end_of, pressed  # noqa: F401 # a fixture


@pytest.mark.parametrize("needs_object_mode", [True, False])
def test_no_other_scene_gets_what_belongs_to_one_that_was_deleted(
    extension,
    pressed,  # noqa: F811
    needs_object_mode,
):
    press, context, kind = pressed
    kind.needs_object_mode = needs_object_mode
    job, behind = press("clip"), press("clip", "Follow")
    context.scene = bpy.data.scenes.new("Other")
    assert job.invoke(context, None) == behind.invoke(context, None) == {"RUNNING_MODAL"}
    bpy.data.scenes.remove(context.scene)
    context.scene = bpy.context.scene
    kind.gates["clip"].set()
    ends = end_of(job, context), end_of(behind, context)
    if needs_object_mode:
        assert ends == ({"CANCELLED"}, {"CANCELLED"}) and kind.written == []
        assert "was deleted" in json.loads(context.window_manager.mimetic_result)["message"]
    else:
        assert ends == ({"FINISHED"}, {"FINISHED"}) and kind.written == ["clip", "clip"]
    assert extension("jobs").running is None


def test_a_face_that_cannot_be_found_now_ends_picking_with_a_word(extension, monkeypatch, footage):
    face, jobs, scene_in = extension("operators.face"), extension("jobs"), extension("scene_in")
    area = SimpleNamespace(regions=[SimpleNamespace(type="WINDOW")])
    monkeypatch.setattr(scene_in, "footage_area", lambda *_: area)
    monkeypatch.setattr(scene_in, "footage_pixel", lambda *_: (3.0, 4.0))
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    monkeypatch.setattr(jobs, "running", jobs.Run("Live", is_endless=True))
    reports = []
    picking = SimpleNamespace(
        _clip_name=bpy.context.scene.mimetic.clip.name,
        _size=(64, 48),
        cancel=lambda _: None,
        report=lambda levels, line: reports.append((*levels, line)),
    )
    click = SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=3, mouse_y=4)
    context = SimpleNamespace(temp_override=lambda **_: contextlib.nullcontext())
    assert face.MIMETIC_OT_pick_face.modal(picking, context, click) == {"CANCELLED"}
    ((level, line),) = reports
    assert level == "WARNING" and "Live is running" in line


def test_one_job_that_waits_is_told_as_one(extension, pressed, monkeypatch):  # noqa: F811
    jobs = extension("jobs")
    monkeypatch.setattr(jobs, "running", jobs.Run("Capture"))
    monkeypatch.setattr(jobs, "waiting", [jobs.Run("Bake")])
    with pytest.raises(RuntimeError, match="1 job waits"):
        bpy.ops.mimetic.stop(index=2)
