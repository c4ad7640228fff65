# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame at rest is found within its clip, by what a part of the face does most of the time."""

from types import SimpleNamespace

import numpy as np
import pytest
from clips import ffmpeg
from mimetic import InvalidInput
from mimetic._core import (
    chances_of_rest,
    costs_of_rest,
    from_rotation_vectors,
    num_alike,
    shared_expression,
    usual_expression,
)
from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import NoFace
from mimetic.media.footage import Footage
from mimetic.score.truth import Truth
from mimetic.solve import find_face as choosing
from mimetic.solve.clip_capture import rest_in
from mimetic.solve.judged_frames import judged_frames
from sample_fit import make_fit

from evaluation.runs.rest import RestScore, as_json, as_text, figures

NEUTRAL = np.array([-0.35, -0.36, 1.2, 1.22, 0.28, 0.78])


def test_parts_that_move_at_different_times_are_usual_only_at_rest():
    rng = np.random.default_rng(2)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[2:6, :2] -= 0.08  # brows up
    clip[8:12, 2:4] -= 0.06  # a smile lifts the corners of the mouth
    clip[8:12, 5] += 0.1
    usual = usual_expression(clip, np.ones(16))
    at_rest = np.r_[0:2, 6:8, 12:16]
    assert usual[at_rest].min() > 0.3
    assert np.delete(usual, at_rest).max() < 0.1


def test_a_smile_that_lasts_most_of_the_clip_is_not_its_rest():
    rng = np.random.default_rng(3)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[5:, 4] -= 0.07  # teeth show between the lips
    clip[5:, 2:4] -= 0.1
    scores = np.where(np.arange(16) < 5, 0.7, 0.007)
    chances = scores * usual_expression(clip, scores)
    assert chances[:5].min() > 0.2
    assert chances[5:].max() < 0.01


OPEN = np.zeros((24, 2))  # lids
NO_LIDS = np.zeros((0, 2))


def test_what_relaxes_below_a_supposed_rest_is_the_rest():
    rng = np.random.default_rng(6)
    values = rng.normal(0, 0.01, (24, 8))  # seen from a smile that is held for half of the clip
    values[:7, :3] -= 0.4
    values[7:12, :3] -= np.linspace(0.35, 0.05, 5)[:, None]
    values[20:, 4] += np.linspace(0.3, 0.9, 4)
    costs = costs_of_rest(values, OPEN, np.ones(24), np.ones(24), NO_LIDS)
    assert np.argmin(costs) < 7 and costs[7:].min() > costs[:7].max()
    blurred = np.r_[np.full(4, 0.2), np.ones(20)]
    assert 4 <= np.argmin(costs_of_rest(values, OPEN, np.ones(24), blurred, NO_LIDS)) < 7
    shut_eyes = np.r_[np.ones(4), np.full(20, 1e-3)]
    assert np.argmin(costs_of_rest(values, OPEN, shut_eyes, np.ones(24), NO_LIDS)) < 4
    with pytest.raises(InvalidInput):
        costs_of_rest(values, OPEN, np.ones(23), np.ones(24), NO_LIDS)


def test_a_frame_in_mid_expression_gives_way_to_one_at_rest(rendered_clip):
    moved = Truth.load(rendered_clip.truth).unit_values.max(axis=1)
    footage = Footage(rendered_clip.footage)
    supposed = 1 + int(np.argmax(moved))
    assert moved[supposed - 1] > 0.5
    frames = set(range(1, footage.num_frames + 1, 2)) | {supposed}
    judged = judged_frames(footage, frames, lambda *_: None, None)
    fit = fitting.find_face(footage.read(supposed), supposed)
    relaxed, _ = choosing._relaxed(footage, fit, [], judged, fitting.find_face, lambda *_: True)
    assert moved[relaxed.frame - 1] < 0.1 and relaxed.rest.why == "relaxed"


def test_what_is_usual_can_be_told_of_a_frame_that_is_known_to_show_rest():
    rng = np.random.default_rng(5)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[4:, 2:4] -= 0.1  # a smile that lasts most of the clip
    clip[4:, 5] += 0.1
    assert usual_expression(clip, np.ones(16))[:4].max() < 0.1
    told = usual_expression(clip, np.ones(16), 2)
    assert told[:4].min() > 0.5 and told[4:].max() < 0.1
    assert num_alike(clip, 2) == 4 and num_alike(clip, 9) == 12
    clip[2, :2] = np.nan
    assert num_alike(clip, 2) == 4
    with pytest.raises(InvalidInput):
        num_alike(clip, 16)


def test_features_not_found_do_not_count():
    clip = np.tile(NEUTRAL, (6, 1))
    clip[2, :2] = np.nan
    np.testing.assert_allclose(usual_expression(clip, np.ones(6)), 1)
    clip[:, 0] = np.nan
    np.testing.assert_allclose(usual_expression(clip, np.ones(6)), 1)


def test_ten_frames_at_rest_begin_a_clip_and_are_found(rendered_clip, tmp_path):
    truth = Truth.load(rendered_clip.truth).unit_values.max(axis=1)[np.r_[8:18, 23:49]]
    assert truth[:10].max() == 0 and truth[10:].min() > 0.19
    path = tmp_path / "short.mp4"
    chosen = "select=between(n\\,8\\,17)+between(n\\,23\\,48),setpts=N/30/TB"
    ffmpeg("-i", rendered_clip.footage, "-vf", chosen, "-crf", "20", path)
    footage = Footage(path)
    assert footage.num_frames == len(truth)
    assert rest_in(footage, (1, len(truth))).fit.frame <= 10


def test_rest_is_what_a_face_comes_back_to():
    rng = np.random.default_rng(4)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[4:] += rng.uniform(0.03, 0.25, (12, 6))  # at rest in a quarter of the frames alone
    shared = shared_expression(clip, np.ones(16))
    assert shared[:4].min() > 0.7
    assert shared[4:].max() < 0.5
    clip[4:] = np.nan
    assert np.isfinite(shared_expression(clip, np.ones(16))).all()


def test_blocks_of_an_encoder_are_noise_and_no_reason_to_leave_a_frame_out():
    clip = np.tile(NEUTRAL, (12, 1))
    details = np.r_[np.full(4, 0.7), np.ones(8)]
    chances = chances_of_rest(np.full(12, 0.8), details, clip)
    assert chances[:4].max() < 0.6 * chances[4:].min()  # where all are at rest, the clear ones
    scores = np.r_[np.full(4, 0.8), np.full(8, 0.1)]
    clip[4:, 2:4] -= np.linspace(0.05, 0.1, 8)[:, None]
    chances = chances_of_rest(scores, details, clip)
    assert chances[:4].min() > 3 * chances[4:].max()
    assert np.argmax(chances_of_rest(scores, np.zeros(12), clip)) < 4  # nothing shows detail


def test_the_table_counts_clips_that_are_taken_at_rest():
    scores = [
        RestScore("begins at rest", "a", 3, 0.0, 0.25),
        RestScore("begins at rest", "b", 20, 0.4, 0.25),
        RestScore("ends at rest", "c", 0, 1.0, 0.35),
    ]
    rows = figures(scores)
    assert rows["begins at rest"]["at_rest"] == 0.5 and rows["ends at rest"]["at_rest"] == 0
    assert rows["all"]["clips"] == 3 and rows["all"]["worst"] == 1
    assert "b: frame 20, 0.40" in as_text(scores) and '"chance"' in as_json(scores)


def test_the_reference_frame_of_the_rendered_clip_is_at_rest(rendered_clip, rest_fit):
    truth = Truth.load(rendered_clip.truth)
    assert truth.unit_values[rest_fit.frame - 1].max() < 0.15


def fit_of(frame: int, turn: float, error: float) -> FaceFit:
    pose = np.eye(4)
    pose[:3, :3] = from_rotation_vectors(np.radians([[0.0, turn, 0.0]]))[0] @ np.diag([1, -1, -1])
    pose[2, 3] = 0.6
    return make_fit(frame=frame, head_pose=pose, error=error, views=[])


@pytest.mark.parametrize(
    ("heads", "chosen"),
    [
        ({5: (4.0, 0.04), 7: (-2.0, 0.04)}, 7),  # the least turned, to whichever side
        ({5: (4.0, 0.04), 7: (2.0, 0.08)}, 5),  # but not one that fits worse
        ({5: (14.0, 0.04)}, 2),  # nor one that is turned much, too
        ({}, 2),
    ],
)
def test_a_head_turned_far_gives_way_to_a_frontal_one(monkeypatch, heads, chosen):
    def find(image, frame, **_):
        if frame not in heads:
            raise NoFace("nothing there")
        return fit_of(frame, *heads[frame])

    monkeypatch.setattr(fitting, "find_face", find)
    footage = SimpleNamespace(read=lambda frame: None)
    turned = fit_of(2, 24.0, 0.05)
    frames = list(range(1, 9))
    arguments = footage, turned, frames, None, None
    assert choosing._more_frontal(*arguments, lambda *_: True).frame == chosen
    with pytest.raises(NoFace, match="stopped"):
        choosing._more_frontal(*arguments, lambda *_: False)
