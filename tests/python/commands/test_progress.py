# SPDX-License-Identifier: GPL-3.0-or-later
"""The time left that is told while a clip is captured, by a clock that the work itself turns."""

import re
from types import SimpleNamespace

import pytest
from mimetic import _core
from mimetic.commands import cli, console
from mimetic.fit import fitting
from mimetic.shared import progress
from mimetic.solve import clip_capture, find_face, relief_sightings

FRAMES = 20
# Seconds, as on two laptop cores
COSTS = {"judge": 0.06, "fit": 0.25, "attach": 0.65, "follow": 0.03, "draw": 0.015}


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass with the work, whatever the machine is doing."""
    time = [0.0]

    def takes(seconds, owner, name):
        work = getattr(owner, name)

        def timed(*given, **named):
            result = work(*given, **named)
            time[0] += seconds
            return result

        monkeypatch.setattr(owner, name, timed)

    takes(COSTS["judge"], fitting, "judge_frame")
    takes(COSTS["fit"], fitting, "find_face")
    takes(COSTS["attach"], find_face, "factored_skin")
    takes(COSTS["attach"], relief_sightings, "factored_skin")
    takes(2 * COSTS["attach"], clip_capture, "refined_skin")  # with detail
    sighting = SimpleNamespace(of=_core.Sighting.of)
    core = SimpleNamespace(**{**vars(_core), "Sighting": sighting})
    monkeypatch.setattr(relief_sightings, "_core", core)
    takes(COSTS["follow"], sighting, "of")
    takes(COSTS["follow"], clip_capture.ClipCapture, "advance")
    from mimetic.commands import capture
    from mimetic.report.overlay import FaceDrawing

    takes(COSTS["draw"], FaceDrawing, "paint")
    takes(0.8, capture, "write_report")
    monkeypatch.setattr(console, "monotonic", lambda: time[0])
    monkeypatch.setattr(console, "PLAIN_EVERY", 0.0)
    return time


def test_the_time_left_is_honest_from_the_search_on(rendered_clip, tmp_path, clock, capsys):
    message = []

    class Watched(console.Console):
        def show(self, fraction, text):
            super().show(fraction, text)
            message.append((clock[0], fraction, capsys.readouterr().err))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mimetic.commands.on_clip.Console", Watched)
        command = ["capture", rendered_clip.footage, "--frames", f"1:{FRAMES}", "--out", tmp_path]
        assert cli.main([str(word) for word in command]) == 0
    fractions = [fraction for _, fraction, _ in message]
    assert fractions == sorted(fractions) and fractions[-1] == 1
    whole = clock[0]
    lines = [(now, re.search(r", (\d+):(\d+) left", text)) for now, _, text in message]
    estimates = [(now, 60 * int(m[1]) + int(m[2])) for now, m in lines if m]
    assert len(estimates) > FRAMES
    for now, left in estimates:
        if now > 0.1 * whole:
            assert left < 2.2 * (whole - now) + 2
            assert left > (whole - now) / 2.2 - 2


def test_stages_tell_the_whole_by_their_costs():
    message = []
    first, free, last = progress.stages(lambda *given: message.append(given) or True, 30, 0, 10)
    for stage, fraction in ((first, 0), (first, 0.5), (first, 3), (free, 0.5), (last, 0.5)):
        assert stage(fraction, "at work")
    assert message == [(part, "at work") for part in (0, 0.375, 0.75, 0.75, 0.875)]
    (only,) = progress.stages(None, 0)
    assert only(1, "nobody listens")
    (stopped,) = progress.stages(lambda *_: False, 1)
    assert not stopped(0, "")


def test_what_a_stage_left_out_would_have_cost_is_shared_by_the_rest():
    told = []
    first, _, third, last = progress.stages(lambda part, _: told.append(part) or True, 2, 4, 3, 1)
    for stage in (first, third, last):
        stage(1, "at work")
    assert told == pytest.approx([0.2, 0.8, 1])
