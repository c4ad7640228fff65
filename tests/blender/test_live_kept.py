# SPDX-License-Identifier: GPL-3.0-or-later
"""A live take that cannot be keyed, or not whole, is kept, and no session stays behind it."""

from types import SimpleNamespace

import bpy
import pytest
from mimetic import InvalidInput
from mimetic.performance.document import Performance
from test_live import curves_of, slider

pytestmark = pytest.mark.newest

GONE = "jaw_open"


@pytest.fixture
def face(scene):
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return bpy.context.active_object


@pytest.fixture
def session(extension, scene, face, acted):
    """One that has recorded a take, without a thread."""
    states = [SimpleNamespace(time=0.0)]
    take = SimpleNamespace(performance=lambda footage: acted[0], states=states)
    thread = SimpleNamespace(
        source=SimpleNamespace(name="camera:0"),
        keep_clip_sound=lambda *_: False,
        is_recording=True,
        stop=lambda: None,
        error=None,
        told=[],
    )

    def end_take():
        thread.is_recording = False
        return take, None

    thread.end_take = end_take
    live, jobs = extension("live"), extension("jobs")
    return live.Session(jobs.Run("Live"), thread, extension("scene_out.live").Puppet(scene, face))


@pytest.fixture
def pressed(extension, monkeypatch, session):
    """The operator in a window, at work, as Blender makes it; `reports` has what it tells."""
    operators, live, jobs = extension("operators.live"), extension("live"), extension("jobs")
    kind = operators.MIMETIC_OT_live

    class Pressed(jobs.Modal):
        bl_idname, leave, handle = kind.bl_idname, kind.leave, kind.handle
        _tick, _obey, _end_take = kind._tick, kind._obey, kind._end_take
        _end, _report_lines = kind._end, kind._report_lines

        def report(self, levels, line):
            self.reports.append((*levels, line))

    monkeypatch.setattr(live, "active", session)
    monkeypatch.setattr(jobs, "running", session.run)
    pressed = Pressed()
    pressed.reports, pressed._run = [], session.run
    return pressed


def fail(error):
    def record(*_):
        raise error

    return record


def test_a_slider_that_was_removed_is_left_out(scene, face, extension, session):
    """It is removed while the session runs, or was before."""
    face.shape_key_remove(face.data.shape_keys.key_blocks[GONE])
    for puppet in (session.puppet, extension("scene_out.live").Puppet(scene, face)):
        session.puppet = puppet
        assert extension("live").end_take(bpy.context, session)
        muscles = curves_of(extension, face.data.shape_keys)
        assert slider(GONE) not in muscles and slider("mentalis.L") in muscles
        assert f"{face.name} has no slider of its own for {GONE}" in session.notes


def test_what_cannot_be_keyed_is_saved_and_named(extension, session, acted):
    session.puppet.record = fail(InvalidInput("the timeline is too short"))
    with pytest.raises(InvalidInput, match="is kept, but not keyed: the timeline is too") as raised:
        extension("live").end_take(bpy.context, session)
    (path,) = session.takes
    assert path in str(raised.value)
    assert Performance.load(path).num_frames == acted[0].num_frames


def test_a_session_goes_on_after_a_take_that_could_not_be_keyed(extension, session, pressed):
    session.puppet.record = fail(InvalidInput("the timeline is too short"))
    session.thread.is_recording = True
    assert pressed._obey(bpy.context, session, "RECORD") is False
    ((level, line),) = pressed.reports
    assert level == "WARNING" and "is kept, but not keyed" in line
    assert extension("live").active is session


@pytest.mark.parametrize("error", [InvalidInput("no such key"), TypeError("no such key")])
def test_nothing_stays_behind_a_take_that_could_not_be_keyed(
    extension, face, session, pressed, error
):
    session.puppet.record = fail(error)
    if isinstance(error, InvalidInput):
        assert pressed._end(bpy.context, session) == {"FINISHED"}
        assert any("is kept, but not keyed: no such key" in line for _, line in pressed.reports)
    else:
        with pytest.raises(TypeError, match="no such key"):
            pressed._end(bpy.context, session)
    assert extension("live").active is None and not extension("jobs").busy()
    assert face.name not in extension("scene_out.contact").still_faces
    assert Performance.load(session.takes[0]).num_frames


def test_a_take_is_kept_when_a_file_is_opened_or_blender_closed(extension, face, session, pressed):
    pressed._window = bpy.context.window_manager.windows[0].as_pointer()  # which is not closed
    pressed.cancel(bpy.context)
    (path,) = session.takes
    assert Performance.load(path).num_frames
    assert curves_of(extension, face.data.shape_keys) == {}
    assert extension("live").active is None and not extension("jobs").busy()


def test_a_take_that_cannot_be_saved_either_keeps_no_session(
    extension, face, session, pressed, monkeypatch, capsys
):
    monkeypatch.setattr(extension("takes"), "save", fail(OSError(28, "No space left on device")))
    pressed._window = bpy.context.window_manager.windows[0].as_pointer()
    pressed.cancel(bpy.context)
    assert "No space left" in capsys.readouterr().out
    assert face.name not in extension("scene_out.contact").still_faces


def test_nothing_of_a_session_stays_when_the_extension_is_switched_off(
    extension, face, session, pressed, monkeypatch
):
    jobs, ended, timers = extension("jobs"), [], []
    manager = SimpleNamespace(
        event_timer_add=lambda *_, **__: timers.append("timer") or "timer",
        event_timer_remove=timers.remove,
        modal_handler_add=lambda _: None,
    )
    context = SimpleNamespace(window=SimpleNamespace(as_pointer=lambda: 1), window_manager=manager)
    monkeypatch.setattr(jobs, "bpy", SimpleNamespace(context=context, data=bpy.data))
    session.view = SimpleNamespace(close=lambda: ended.append("view"))
    session.fast = SimpleNamespace(end=lambda: ended.append("fast view"))
    assert pressed.enter(context, session.run) == {"RUNNING_MODAL"} and timers
    jobs.stop_running()
    assert sorted(ended) == ["fast view", "view"] and timers == []
    assert extension("live").active is None and not jobs.busy()
    assert Performance.load(session.takes[0]).num_frames


def test_a_take_of_a_face_that_was_deleted_is_kept(extension, face, session):
    bpy.data.objects.remove(face)
    with pytest.raises(InvalidInput, match=r"is kept, but not keyed: .*deleted or renamed"):
        extension("live").end_take(bpy.context, session)
    assert Performance.load(session.takes[0]).num_frames


def test_a_take_of_a_face_that_lost_its_shape_keys_is_kept(extension, face, session):
    face.shape_key_clear()
    session.puppet.restore()
    with pytest.raises(InvalidInput, match=r"is kept, but not keyed: .*lost its shape keys"):
        extension("live").end_take(bpy.context, session)


def test_a_look_whose_name_is_none_does_not_end_the_session(scene, session, pressed):
    scene.mimetic.live.looks.add().name = "smile: big"
    session.thread.keeper = SimpleNamespace(is_ready=True, ask=lambda _: None)
    assert pressed._obey(bpy.context, session, "KEEP") is False
    ((level, line),) = pressed.reports
    assert level == "WARNING" and line.startswith("'smile: big' is not")


def test_one_take_is_told_as_one(session, pressed):
    pressed._end_take(bpy.context, session)
    session.thread.end_take = lambda: (None, None)
    assert pressed._end(bpy.context, session) == {"FINISHED"}
    assert pressed.reports[-1] == ("INFO", "1 take recorded")
