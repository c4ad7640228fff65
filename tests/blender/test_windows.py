# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs where Blender has several windows; tests/window closes real ones."""

from types import SimpleNamespace

import bpy
import pytest
from last_result import result
from test_operators import end_of, pressed  # noqa: F401 # a fixture

CLOSED = 1  # the stand-in's window
ESC = SimpleNamespace(type="ESC", value="PRESS")


def window_at(pointer: int):
    screen = SimpleNamespace(is_temporary=False)
    return SimpleNamespace(as_pointer=lambda: pointer, screen=screen)


@pytest.fixture
def closing(extension, pressed, monkeypatch):  # noqa: F811
    """Closes the window in which jobs were begun, as Blender does: it ends their operators. What
    is left for later is in `closing.due`."""
    _, context, _ = pressed
    carrying, due = extension("carrying"), []
    windows = [window_at(2)]
    manager = SimpleNamespace(windows=windows)
    stand_in = SimpleNamespace(context=SimpleNamespace(window_manager=manager))
    monkeypatch.setattr(carrying, "bpy", stand_in)
    timers = SimpleNamespace(register=lambda function, **_: due.append(function))
    monkeypatch.setattr(
        extension("jobs"),
        "bpy",
        SimpleNamespace(
            app=SimpleNamespace(timers=timers), context=bpy.context, data=bpy.data, ops=bpy.ops
        ),
    )

    def close(*operators) -> None:
        for operator in operators:
            operator.properties = SimpleNamespace(bl_rna=SimpleNamespace(properties=()))
            operator.cancel(context)

    return SimpleNamespace(close=close, due=due, windows=windows)


def begin_anew(extension, monkeypatch, context) -> list:
    """Has jobs go on in a stand-in for the other window; the operators that did."""
    carrying, begun = extension("carrying"), []

    def begin(carried) -> bool:
        carrying.handed = carried
        operator = carried.kind()
        assert operator.poll(context)
        begun.append(operator)
        return operator.invoke(context, None) == {"RUNNING_MODAL"}

    monkeypatch.setattr(carrying, "begin", begin)
    return begun


def test_a_job_goes_on_when_its_window_is_closed(
    extension,
    pressed,  # noqa: F811
    closing,
    monkeypatch,
):
    jobs, (press, context, kind) = extension("jobs"), pressed
    first, second = press("first"), press("second")
    assert first.invoke(context, None) == second.invoke(context, None) == {"RUNNING_MODAL"}
    run, later = jobs.running, jobs.waiting[0]
    first.noted = "by read"
    closing.close(first, second)
    assert not run.stop.is_set() and not later.stop.is_set()
    assert jobs.running is run and jobs.waiting == [later]
    begun = begin_anew(extension, monkeypatch, context)
    for go_on in closing.due:
        go_on()
    assert [operator.clip for operator in begun] == ["first", "second"]
    assert begun[0].noted == "by read" and extension("carrying").handed is None
    assert jobs.running is run and jobs.waiting == [later]
    for gate in kind.gates.values():
        gate.set()
    for operator in begun:
        assert end_of(operator, context) == {"FINISHED"}
    assert kind.written == ["first", "second"] and jobs.running is None


def test_a_job_that_cannot_go_on_makes_way(extension, pressed, closing, monkeypatch):  # noqa: F811
    jobs, (press, context, kind) = extension("jobs"), pressed
    first, second = press("first"), press("second")
    assert first.invoke(context, None) == second.invoke(context, None) == {"RUNNING_MODAL"}
    run, later = jobs.running, jobs.waiting[0]
    closing.close(first)
    monkeypatch.setattr(extension("carrying"), "begin", lambda _: False)
    kind.gates["first"].set()
    closing.due[0]()
    assert run.stop.is_set() and jobs.running is later
    kind.gates["second"].set()
    assert end_of(second, context) == {"FINISHED"}
    closing.due[0]()  # it was ended meanwhile: nothing is begun
    assert jobs.running is None


def test_a_file_that_is_loaded_ends_the_job(extension, pressed, closing):  # noqa: F811
    jobs, (press, context, kind) = extension("jobs"), pressed
    job = press("clip")
    assert job.invoke(context, None) == {"RUNNING_MODAL"}
    run = jobs.running
    closing.windows.append(window_at(CLOSED))
    kind.gates["clip"].set()
    closing.close(job)
    assert run.stop.is_set() and jobs.running is None and closing.due == []


def test_what_was_given_is_given_again(extension, scene):
    carrying = extension("carrying")
    manager = bpy.context.window_manager
    given = manager.operator_properties_last("mimetic.find_face")
    given.frame, given.near, given.use_shown_frame = 7, (12.5, 3.0), True
    operator = SimpleNamespace(properties=given, noted=[1])
    for known in ("frame", "near", "use_shown_frame", "lens"):
        setattr(operator, known, getattr(given, known))
    carried = carrying.carried(operator, "clip.mp4")
    assert carried.properties == {"frame": 7, "near": (12.5, 3.0), "use_shown_frame": True}
    assert carried.state["noted"] == [1] and carried.subject == "clip.mp4"
    assert carrying._named("MIMETIC_OT_find_face").idname() == "MIMETIC_OT_find_face"
    assert carrying._named("mimetic.find_face").idname() == "MIMETIC_OT_find_face"


@pytest.mark.parametrize(
    ("was_playing", "is_temporary", "is_stopped"),
    [(False, False, True), (True, False, False), (False, True, False)],
)
def test_esc_in_another_window_stops_the_job(
    extension, monkeypatch, was_playing, is_temporary, is_stopped
):
    jobs, kind = extension("jobs"), extension("operators.stop").MIMETIC_OT_stop
    assert not bpy.ops.mimetic.stop.poll()  # Esc goes on to others
    run = jobs.Run("Capture")
    monkeypatch.setattr(jobs, "running", run)
    monkeypatch.setattr(extension("playback"), "was_on", was_playing)
    assert bpy.ops.mimetic.stop.poll()
    window = SimpleNamespace(screen=SimpleNamespace(is_temporary=is_temporary))
    context = SimpleNamespace(window=window, window_manager=bpy.context.window_manager)
    operator = SimpleNamespace(bl_idname=kind.bl_idname)
    answer = kind.invoke(operator, context, ESC)
    assert answer == ({"FINISHED"} if is_stopped else {"PASS_THROUGH"})
    assert run.stop.is_set() == is_stopped
    if is_stopped:
        assert result()["operator"] == "mimetic.stop"


def test_esc_that_ends_the_playback_leaves_the_job(extension, pressed, monkeypatch):  # noqa: F811
    """Blender passes such a key on to the window's keymap, when nothing plays any more."""
    jobs, (press, context, kind) = extension("jobs"), pressed
    job, stop = press("clip"), extension("operators.stop").MIMETIC_OT_stop
    assert job.invoke(context, None) == {"RUNNING_MODAL"}
    run, playing = jobs.running, [True]
    monkeypatch.setattr(extension("playback"), "is_on", lambda: bool(playing))
    assert job.modal(context, ESC) == {"PASS_THROUGH"}
    playing.clear()
    window = SimpleNamespace(screen=SimpleNamespace(is_temporary=False))
    there = SimpleNamespace(window=window, window_manager=bpy.context.window_manager)
    operator = SimpleNamespace(bl_idname=stop.bl_idname)
    assert stop.invoke(operator, there, ESC) == {"PASS_THROUGH"}
    assert not run.stop.is_set()
    assert job.modal(context, ESC) == {"RUNNING_MODAL"} and run.stop.is_set()
    kind.gates["clip"].set()
    end_of(job, context)
