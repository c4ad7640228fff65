# SPDX-License-Identifier: GPL-3.0-or-later
"""When muscles follow a landmark that was dragged; tests/window drags one with the mouse."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from scene_state import in_window
from test_attach_muscles import new_head, offsets_of, put_landmarks

pytestmark = pytest.mark.oldest_and_newest

STEP = 0.6  # seconds, longer than a landmark must keep still


@pytest.fixture
def followed(extension):
    """Looks at what Blender evaluates, as it does where Blender has a window."""
    module, handlers = extension("dragged_landmarks"), extension("handlers")
    handlers.add(module.HANDLERS)
    yield module
    handlers.remove(module.HANDLERS)


@pytest.fixture
def head(parts, followed):
    """With muscles, and its landmarks seen where they are."""
    head = new_head(parts[0], parts[1].tolist())
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert due(followed, 0.0) == ""
    return head


def due(followed, now: float) -> str:
    """The head that muscles are attached to again, as the timer has it: it looks before."""
    if followed._is_stale:
        followed.look(now)
    found = followed.next_due(now)
    return found[1].name if found else ""


def mark_of(name: str) -> bpy.types.Object:
    head = bpy.data.objects["Bust"]
    return next(mark for mark in head.children if mark.mimetic.landmark == name)


def drag(name: str, down: float = 1.0) -> None:
    """By so many centimetres, as whoever drags it has it."""
    mark = mark_of(name)
    mark.location[2] -= down
    bpy.context.view_layer.objects.active = mark
    bpy.context.view_layer.update()


def step(message: str) -> None:
    bpy.ops.ed.undo_push(message=message)


def test_a_dragged_landmark_is_followed_once_it_keeps_still(followed, head):
    drag("chin")
    assert due(followed, 1.0) == ""
    drag("chin")
    assert due(followed, 1.4) == ""  # it moved on
    assert due(followed, 1.8) == ""
    assert due(followed, 1.4 + STEP) == "Bust"
    assert due(followed, 9.0) == ""  # once, whatever came of it
    drag("mouth_corner.L", 0.001)  # a hundredth of a millimetre, as far off as the chin still is
    assert due(followed, 10.0) == ""
    assert due(followed, 10 + STEP) == "Bust"
    drag("chin", -2.0)
    drag("mouth_corner.L", -0.001)
    assert due(followed, 20.0) == due(followed, 20 + STEP) == ""  # where the muscles have them


def test_what_moves_by_itself_is_no_drag(followed, head):
    head.location[2] += 0.4
    bpy.context.view_layer.update()
    assert due(followed, 1.0) == due(followed, 1 + STEP) == ""
    mark = mark_of("chin")
    mark.keyframe_insert("location", frame=1)
    mark.location[2] -= 2
    mark.keyframe_insert("location", frame=20)
    for frame, now in ((1, 2.0), (20, 3.0)):
        bpy.context.scene.frame_set(frame)
        assert due(followed, now) == due(followed, now + STEP) == ""
    drag("nose_tip", 0.2)
    assert due(followed, 4.0) == ""
    assert due(followed, 4 + STEP) == "Bust"


def test_the_setting_and_the_size_say_whether(followed, head, extension, monkeypatch):
    assert head.mimetic.use_live_landmarks
    head.mimetic.use_live_landmarks = False
    drag("chin")
    assert due(followed, 1.0) == due(followed, 1 + STEP) == ""
    head.mimetic.use_live_landmarks = True
    assert due(followed, 2.0) == due(followed, 2 + STEP) == ""  # what was dragged before stays lit
    assert extension("heads").moved_landmarks(bpy.context.scene, head) == ["chin"]
    monkeypatch.setattr(
        extension("scene_out.foreign"), "MOST_FOLLOWED", len(head.data.vertices) - 1
    )
    assert bpy.ops.mimetic.attach_muscles(others="NONE") == {"FINISHED"}
    assert head.mimetic.use_live_landmarks  # it had muscles: as the user has it
    assert head.mimetic.others == "NONE"
    head.mimetic.landmarks.clear()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert not head.mimetic.use_live_landmarks


def test_it_waits_for_what_it_would_disturb(followed, head, extension, monkeypatch):
    jobs, editors = extension("jobs"), extension("editors")
    drag("chin")
    assert due(followed, 1.0) == ""
    with monkeypatch.context() as held:
        held.setattr(editors, "is_dragging", lambda: True)
        assert due(followed, 2.0) == ""
    assert due(followed, 2.4) == ""  # half a second from the end of the drag on
    bpy.context.view_layer.objects.active = head
    bpy.ops.object.mode_set(mode="EDIT")
    assert due(followed, 4.0) == ""
    bpy.ops.object.mode_set(mode="OBJECT")
    with monkeypatch.context() as held:
        held.setattr(jobs, "running", extension("job_run").Run("Another"))
        assert due(followed, 5.0) == ""
    assert due(followed, 6.0) == "Bust"


def test_undo_and_redo_bring_what_belongs_there_and_nothing_follows(followed, head, extension):
    moved = extension("heads").moved_landmarks

    def rest(now: float) -> list[str]:
        """Nothing is followed; which landmarks are lit."""
        assert due(followed, now) == due(followed, now + STEP) == ""
        return moved(bpy.context.scene, bpy.data.objects["Bust"])

    before = offsets_of(head, "mentalis.L")
    step("attached")
    drag("chin")
    step("dragged")
    assert due(followed, 1.0) == ""
    assert due(followed, 1 + STEP) == "Bust"
    assert bpy.ops.mimetic.attach_muscles("EXEC_DEFAULT", True) == {"FINISHED"}
    assert rest(2.0) == []
    after = offsets_of(bpy.data.objects["Bust"], "mentalis.L")
    assert np.abs(after - before).max() > 1e-3
    in_window(bpy.ops.ed.undo)  # the update
    assert rest(3.0) == ["chin"]
    np.testing.assert_array_equal(offsets_of(bpy.data.objects["Bust"], "mentalis.L"), before)
    in_window(bpy.ops.ed.undo)  # the drag
    assert rest(4.0) == []
    in_window(bpy.ops.ed.redo)
    assert rest(5.0) == ["chin"]
    in_window(bpy.ops.ed.redo)
    assert rest(6.0) == []
    np.testing.assert_array_equal(offsets_of(bpy.data.objects["Bust"], "mentalis.L"), after)
    drag("nose_tip", 0.2)  # it goes on from there
    assert due(followed, 7.0) == ""
    assert due(followed, 7 + STEP) == "Bust"


def test_a_drag_or_an_undo_ends_the_job_that_follows_the_one_before(
    followed, head, extension, monkeypatch
):
    jobs, run = extension("jobs"), extension("job_run").Run("Attach Muscles")
    step("attached")
    drag("chin")
    step("dragged")
    assert due(followed, 1.0) == ""
    monkeypatch.setattr(jobs, "running", run)
    places = followed._watched["Bust"].places
    monkeypatch.setattr(followed, "_following", followed.Following("Bust", places, run))
    head.location[2] += 0.1
    bpy.context.view_layer.update()
    followed.look(2.0)
    assert not run.stop.is_set()
    in_window(bpy.ops.ed.undo)
    assert run.stop.is_set()
    monkeypatch.setattr(jobs, "running", None)
    assert due(followed, 3.0) == due(followed, 3 + STEP) == ""


def test_a_deleted_landmark_is_missed_at_the_next_drag_alone(followed, head):
    bpy.data.objects.remove(mark_of("eye_inner.L"))
    bpy.context.view_layer.update()
    assert due(followed, 1.0) == due(followed, 1 + STEP) == ""
    drag("chin")
    assert due(followed, 2.0) == ""
    assert due(followed, 2 + STEP) == "Bust"
    with pytest.raises(RuntimeError, match=r"landmarks lack eye_inner\.L"):
        bpy.ops.mimetic.attach_muscles()
    assert due(followed, 3.0) == due(followed, 3 + STEP) == ""


def test_no_job_writes_in_the_middle_of_a_drag(extension, monkeypatch):
    jobs, run = extension("jobs"), extension("job_run").Run("Attach Muscles")
    operator = extension("operators.foreign").MIMETIC_OT_attach_muscles
    job = SimpleNamespace(needs_object_mode=operator.needs_object_mode, _elsewhere=lambda _: "")
    monkeypatch.setattr(jobs, "running", run)
    assert jobs.Job._hindrance(job, bpy.context) == ""
    monkeypatch.setattr(extension("editors"), "is_dragging", lambda: True)
    assert "nothing is dragged" in jobs.Job._hindrance(job, bpy.context)


@pytest.mark.parametrize("keeps_part", [False, True])
def test_a_job_that_is_stopped_as_it_ends_writes_only_what_it_keeps(
    extension, monkeypatch, keeps_part
):
    jobs, run = extension("jobs"), extension("job_run").Run("A job", keeps_part=keeps_part)
    run.result = "all of it"
    run.stop.set()
    written = []
    job = SimpleNamespace(
        needs_object_mode=False,
        leave=lambda _: None,
        _write=lambda _, result, stopped: written.append((result, stopped)),
    )
    monkeypatch.setattr(jobs, "running", run)
    jobs.Job._end(job, bpy.context)
    assert written == [("all of it" if keeps_part else None, True)]
