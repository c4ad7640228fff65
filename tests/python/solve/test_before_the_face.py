# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand or a caption before a mouth: what it hides is not measured, and the user is told."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.fit.still_cover import StillCover
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture, covered
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.template.face_template import load_template

from evaluation.runs.covered import hand
from evaluation.synthetic.footage import encode
from evaluation.synthetic.recipes import TEST


@pytest.fixture(scope="module")
def hidden(rendered_clip, tmp_path_factory):
    """A capture of a drawn clip with a hand in the middle third, its fit, and frames it is in."""
    frames = np.stack([image for _, image in Footage(rendered_clip.footage)])
    painted = hand(frames, Truth.load(rendered_clip.truth))
    changed = np.abs(painted.astype(int) - frames).max(-1) > 8
    path = tmp_path_factory.mktemp("hand") / "clip.mp4"
    encode(painted, path, TEST)
    summary = CaptureSummary()
    performance = clip_capture.capture(path, summary=summary)
    share = changed.mean((1, 2))
    is_there = share > 0.8 * share.max()
    return SimpleNamespace(performance=performance, fit=summary.fit, is_there=is_there)


def test_no_frame_with_the_hand_serves_the_fit(hidden):
    frames = [view.frame for view in hidden.fit.views]
    assert not hidden.is_there[np.array(frames) - 1].any()


def test_the_bars_of_what_is_hidden_are_wider_and_the_head_is_followed(hidden):
    performance = hidden.performance
    assert (performance.quality >= HELD_QUALITY).all()
    names, std = list(performance.muscles), performance.activations_std
    there, bare = hidden.is_there, ~hidden.is_there
    bare[np.flatnonzero(there)[0] - 8 : np.flatnonzero(there)[-1] + 9] = False

    def widening(name):
        column = std[:, names.index(name)]
        return np.median(column[there]) / np.median(column[bare])

    assert widening("zygomaticus_major.L") > 1.3
    assert widening("depressor_labii_inferioris.R") > 1.3
    assert widening("frontalis_medial.L") < 1.1


def test_the_user_is_told_of_the_frames(hidden):
    (note,) = [text for text in hidden.performance.notes if "before the face in frames" in text]
    first, last = (1 + np.flatnonzero(hidden.is_there)[end] for end in (0, -1))
    told = note.split("frames ")[1].split(":")[0].split(" to ")
    assert abs(int(told[0]) - first) <= 5 and abs(int(told[-1]) - last) <= 5


class Seen:
    """A network that is sure of something before the face, or sees nothing."""

    def __init__(self, is_sure):
        self.is_sure = lambda: is_sure

    def see(self, image, square):
        return self


def watch(monkeypatch, is_sure=False):
    monkeypatch.setattr(covered, "occlusion_network", lambda: Seen(is_sure))
    monkeypatch.setattr(covered, "notes_on_glasses", lambda *_: [])
    monkeypatch.setattr(covered._core, "occlusion_square", lambda *_: None)
    fit = SimpleNamespace(frame=7, camera=None, head_pose=np.eye(4), still_cover=StillCover())
    return covered.CoverWatch(np.zeros((4, 4, 3), np.uint8), fit, None)


def test_spans_are_joined_and_only_the_first_are_named(monkeypatch):
    cover = watch(monkeypatch)
    for frame in [3, 4, 8, 20, 40, 60, 80, 100, 101]:
        cover.add(frame, SimpleNamespace(covered=0.2))
    cover.add(50, SimpleNamespace(covered=0.01))
    (note,) = cover.notes(range(1, 200))
    assert "in frames 3 to 8, 20, 40, 60, 2 further spans: what it hides" in note
    (note,) = cover.notes(range(90, 200))
    assert "in frames 100 to 101: what it hides" in note
    assert cover.notes(range(30)) and not cover.notes(range(45, 55))


def test_what_is_before_the_face_at_rest_is_told(monkeypatch):
    assert watch(monkeypatch).notes([7]) == []
    (note,) = watch(monkeypatch, is_sure=True).notes([7])
    assert note.startswith("something is before the face in frame 7, from which it is followed")


def with_caption(frames):
    """Two lines of white blocks, as of letters, that stand still over nose and cheeks."""
    painted = frames.copy()
    height, width = frames.shape[1:3]
    for row in (0.66, 0.73):
        top = round(row * height)
        for left in range(round(0.36 * width), round(0.62 * width), 9):
            painted[:, top : top + 9, left : left + 6] = 0
            painted[:, top + 1 : top + 8, left + 1 : left + 5] = 250
    return painted


def test_a_caption_that_stands_still_is_found_and_told(rendered_clip, tmp_path):
    frames = np.stack(
        [
            np.roll(
                image, [round(6 * np.cos(0.13 * frame)), round(9 * np.sin(0.1 * frame))], (0, 1)
            )
            for frame, image in Footage(rendered_clip.footage)
        ]
    )
    painted = with_caption(frames)
    path = tmp_path / "clip.mp4"
    encode(painted, path, TEST)
    fit = clip_capture.find_face(path)
    is_found = fit.still_cover.in_core()
    y, x = np.nonzero((painted[0] != frames[0]).any(axis=-1))
    pixels = np.column_stack([x, y]).astype(float)
    assert is_found.at(pixels).mean() > 0.6
    assert not is_found.at(pixels - (0, 0.2 * frames.shape[1])).any()
    reference = np.ascontiguousarray(painted[fit.frame - 1])
    notes = covered.CoverWatch(reference, fit, load_template()).notes([fit.frame])
    assert any(note.startswith("something stands still in the picture") for note in notes)
