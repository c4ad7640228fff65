# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of a live session, and what its panels are told, without a window and a face."""

from types import SimpleNamespace

import bpy
import pytest
from test_live import CHANNELS


@pytest.fixture
def keyboard(extension, monkeypatch):
    """Presses keys of a session that is a stand-in; `keyboard.session` has what they command."""
    operators, live, jobs = extension("operators.live"), extension("live"), extension("jobs")

    class Keyboard(jobs.Modal):
        handle, _tick = operators.MIMETIC_OT_live.handle, operators.MIMETIC_OT_live._tick
        _report_lines, _told = (lambda *_: None), 1.0
        session = SimpleNamespace(commands=[], is_recording=False)

        def press(self, key, value="PRESS", is_repeat=False, **held):
            held = dict.fromkeys(("ctrl", "alt", "shift", "oskey"), False) | held
            event = SimpleNamespace(type=key, value=value, is_repeat=is_repeat, **held)
            assert self.modal(bpy.context, event) == {"RUNNING_MODAL"}

    keyboard = Keyboard()
    monkeypatch.setattr(live, "active", keyboard.session)
    monkeypatch.setattr(jobs, "running", jobs.Run("Live"))
    keyboard._run = jobs.running
    return keyboard


def test_a_key_that_is_held_or_has_a_modifier_commands_nothing_more(keyboard):
    for key in ("N", "R", "K"):
        keyboard.press(key)
        for _ in range(3):
            keyboard.press(key, is_repeat=True)
        keyboard.press(key, "RELEASE")
        for modifier in ("ctrl", "alt", "shift", "oskey"):
            keyboard.press(key, **{modifier: True})
    assert keyboard.session.commands == ["NEUTRAL", "RECORD", "KEEP"]


def test_the_clip_editors_panel_follows_the_session(extension, keyboard, monkeypatch):
    redrawn = []
    quiet = dict.fromkeys(("set_stillness", "set_frozen"), lambda _: None)
    thread = SimpleNamespace(**quiet, newest=lambda: None, is_running=True, line="25 a second")
    told = ["live, 25 a second", "live, 25 a second", "live, no face"]
    vars(keyboard.session).update(
        thread=thread, run=keyboard._run, due=None, view=None, line=lambda: told.pop(0)
    )
    monkeypatch.setattr(extension("editors"), "redraw_parts", lambda *areas: redrawn.append(areas))
    context = SimpleNamespace(
        scene=bpy.context.scene, workspace=SimpleNamespace(status_text_set=lambda _: None)
    )
    for num_redrawn in (1, 1, 2):  # once for each new text
        keyboard._told = 0.0
        assert keyboard._tick(context, keyboard.session) == {"RUNNING_MODAL"}
        assert redrawn == [("UI", "CLIP_EDITOR")] * num_redrawn


def test_digits_freeze_channels_and_let_them_go(scene, extension, keyboard):
    operators, live = extension("operators.live"), extension("live")
    settings, session, press = scene.mimetic.live, keyboard.session, keyboard.press
    assert len(operators.DIGITS) == len(CHANNELS)
    press("TWO")
    press("TWO", "RELEASE")
    press("TWO", is_repeat=True)  # a key that is held freezes once
    press("FIVE")
    assert live.frozen(settings) == {"head_rotation", "brows"}
    assert operators._hints(session, settings).endswith("frozen: rotation, brows")
    press("TWO")
    assert settings.channels == CHANNELS - {"BROWS"} and session.commands == []
