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
        end_take=lambda: (take, None),
        stop=lambda: None,
        error=None,
        told=[],
    )
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
