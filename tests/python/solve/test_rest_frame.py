# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame taken as rest: a person may name it, and is told which it is and why."""

from types import SimpleNamespace

import numpy as np
import pytest
from clips import make_clip
from mimetic import InvalidInput
from mimetic.commands.cli import main
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import NoFace, judge_frame
from mimetic.fit.rest_choice import RestChoice
from mimetic.fit.still_cover import StillCover
from mimetic.media.footage import Footage
from mimetic.shared.progress import NUM_CANDIDATES
from mimetic.solve import find_face as find_face_module
from mimetic.solve.clip_capture import find_face
from mimetic.solve.find_face import find_rest
from mimetic.solve.judged_frames import JudgedFrames
from mimetic.solve.rest_motion import Moved

FRAME = 3  # at rest


@pytest.fixture(scope="module")
def asked(fit_of_frame_3):
    assert fit_of_frame_3.frame == FRAME
    return fit_of_frame_3


@pytest.fixture(scope="module")
def chosen(rest_fit):
    return rest_fit


def test_a_frame_that_is_asked_for_is_joined_by_others_as_a_chosen_one(asked, chosen):
    assert asked.frame == asked.views[0].frame == FRAME
    assert len(chosen.views) > 1 and len(asked.views) > 1
    assert bool(asked.relief) == bool(chosen.relief)


def test_the_fit_says_which_frame_was_taken_and_why(asked, chosen, tmp_path):
    assert chosen.rest.why == "relaxed" and asked.rest.why == "asked for"
    for fit in (chosen, asked):
        assert 1 < fit.rest.alike <= fit.rest.seen <= NUM_CANDIDATES + 1
    chosen.save(tmp_path / "fit.json")
    again = FaceFit.load(tmp_path / "fit.json")
    assert again.rest == chosen.rest
    assert again.rest_text().startswith(
        f"Frame {chosen.frame} is taken as rest: the face is relaxed there and returns to it"
    )


def test_a_rest_that_does_not_come_back_is_not_said_to():
    lone, shared = (RestChoice("relaxed", 24, alike).text(7) for alike in (1, 2))
    assert "returns" not in lone and "24 in all" in lone and "name another frame" in lone
    assert "returns to it; 2 of the 24 frames" in shared


def test_rest_is_not_judged_from_a_single_frame_alone(rendered_clip, monkeypatch):
    """A frame that is far from rest in its own view must give way to one that is not."""
    seen_from = []

    def costs(reference, _footage, judged, _skin, _progress):
        seen_from.append(reference.frame)
        if len(seen_from) == 1:
            return {f: 5.0 if f == reference.frame else 4.0 for f in judged.clear}
        return {f: 0.0 if f == reference.frame else 1.0 for f in judged.clear}

    monkeypatch.setattr(find_face_module, "_costs_seen_from", costs)
    rest = find_rest(Footage(rendered_clip.footage), {1, 5, 12, 20, 26, 30}, lambda *_: True)
    assert len(set(seen_from)) == 2
    assert rest.fit.frame == seen_from[1]


def test_eyes_beside_a_hand_tell_that_other_frames_look_down(rendered_clip, monkeypatch):
    footage = Footage(rendered_clip.footage)
    one = judge_frame(footage.read(1))
    lids = {frame: 0.0 for frame in range(1, 8)} | dict.fromkeys(range(8, 15), -0.9)

    def moved(_footage, _fit, frames, _skin):
        for frame in sorted(frames):
            yield frame, Moved(np.zeros(3), np.full(2, lids[frame]))

    monkeypatch.setattr(find_face_module, "moved_from", moved)
    clear = dict.fromkeys(range(1, 9), one)
    alone, beside = (
        find_face_module._costs_seen_from(
            SimpleNamespace(frame=1),
            footage,
            JudgedFrames(clear, hands, StillCover()),
            None,
            lambda *_: True,
        )
        for hands in (set(), set(range(9, 15)))
    )
    assert set(alone) == set(beside) == set(clear)
    assert alone[8] == pytest.approx(alone[1])
    assert beside[8] < beside[1] - 2


@pytest.mark.parametrize("frame", [0, 9999])
def test_a_frame_outside_of_the_clip_is_refused(rendered_clip, frame):
    with pytest.raises(InvalidInput, match=rf"frame {frame} is to show .* has frames 1 to"):
        find_face(rendered_clip.footage, frame)


def test_a_frame_without_a_face_is_refused(tmp_path):
    with pytest.raises(NoFace, match="no frontal face in frame 2"):
        find_face(make_clip(tmp_path / "bars.mp4", size="320x240"), 2)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["capture", "--rest", "9999"], "frame 9999 is to show the face at rest"),
        (["fit", "--rest", "0"], "frame 0 is to show the face at rest"),
        (["capture", "--rest", "2", "--fit", "fit.json"], "--rest are of a face to find"),
    ],
)
def test_commands_refuse_a_wrong_rest(rendered_clip, tmp_path, capsys, words, text):
    command, *options = words
    out = tmp_path / "out"
    assert main([command, str(rendered_clip.footage), "--out", str(out), *options]) == 2
    assert text in capsys.readouterr().err
    assert not out.exists()


def test_fit_says_which_frame_it_took(rendered_clip, tmp_path, capsys):
    words = ["fit", str(rendered_clip.footage), "--rest", str(FRAME), "--out", str(tmp_path)]
    assert main(words) == 0
    fit = FaceFit.load(tmp_path / "fit.json")
    assert fit.frame == FRAME
    assert fit.rest_text() in capsys.readouterr().out.splitlines()
