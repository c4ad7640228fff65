# SPDX-License-Identifier: GPL-3.0-or-later
"""Held or right: what is followed must look like this face, whatever the picture shows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture
from mimetic.solve.walk import notes_on_strangers, proved
from mimetic.template.face_template import load_template
from PIL import Image, ImageFilter

from evaluation.runs.abuse import METHODS, as_text, laid_on, total
from evaluation.runs.abuse_score import AbuseTruth, score_abuse, slid
from evaluation.synthetic.abuse import films
from evaluation.synthetic.abuse.recipes import CAP12, SINGLE, AbuseClip
from evaluation.synthetic.footage import encode
from evaluation.synthetic.noise import ValueNoise
from evaluation.synthetic.recipes import TEST

BAR = 96  # pixels, of 320


@pytest.fixture(scope="module")
def clip_frames(rendered_clip):
    return np.stack([image for _, image in Footage(rendered_clip.footage)])


def _captured(frames, path, fit):
    encode(frames, path, TEST)
    return clip_capture.capture(path, fit=fit)


@pytest.fixture(scope="module")
def first_fit(rendered_clip):
    return clip_capture.find_face(rendered_clip.footage, frame=6)


def _degrees_off(performance, rendered_clip):
    """Of the turn since the reference frame."""
    truth = Truth.load(rendered_clip.truth).head_pose[:, :3, :3]
    result = performance.head_pose[:, :3, :3]
    left_over = np.einsum("nij,kj->nik", result, result[5]) @ truth[5] @ truth.transpose(0, 2, 1)
    return np.degrees(np.arccos(np.clip((np.trace(left_over, axis1=1, axis2=2) - 1) / 2, -1, 1)))


def test_a_bar_that_crosses_the_face_leaves_frames_held_or_right(
    rendered_clip, clip_frames, first_fit, tmp_path
):
    frames = clip_frames.copy()
    for i in range(10, 40):
        left = round(-BAR + (i - 10) / 29 * (320 + BAR))
        frames[i, :, max(0, left) : max(0, left + BAR)] = (46, 60, 52)
    result = _captured(frames, tmp_path / "bar.mp4", first_fit)
    followed = result.quality >= HELD_QUALITY
    assert _degrees_off(result, rendered_clip)[followed].max() < 10
    assert not followed.all()
    assert followed[:10].all()
    assert followed[40:].all()


def test_grass_is_not_followed_and_the_face_is_found_again(
    rendered_clip, clip_frames, first_fit, tmp_path
):
    frames = clip_frames.copy()
    x, y = np.meshgrid(np.arange(320 + 40) / 240, np.arange(240) / 240)
    at = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    tufts = ValueNoise(11).octaves(at, (0.12, 0.04, (0.012, 0.05, 1.0))).reshape(x.shape)
    lawn = np.clip(np.array([87, 121, 55]) + 30 * tufts[..., None], 0, 255).astype(np.uint8)
    # The face slides away before the lawn: no cut warns of it.
    for i in range(10, 40):
        away = round(360 * np.sin(np.pi * (i - 9) / 31) ** 0.5)
        frames[i] = lawn[:, i : i + 320]
        if away < 320:
            frames[i, :, away:] = clip_frames[i, :, : 320 - away]
    result = _captured(frames, tmp_path / "lawn.mp4", first_fit)
    assert (result.quality[16:34] < HELD_QUALITY).all()
    assert (result.quality[40:] >= HELD_QUALITY).all()
    assert _degrees_off(result, rendered_clip)[40:].max() < 10


def test_a_dissolve_to_a_face_with_the_same_features_and_other_skin_is_held(
    clip_frames, first_fit, tmp_path
):
    share = np.clip((np.arange(len(clip_frames)) - 12) / 8, 0, 1)
    share[30:] = 0
    x, y = np.meshgrid(np.arange(320) / 240, np.arange(240) / 240)
    at = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    pores = 24 * ValueNoise(5).octaves(at, (0.02, 0.01)).reshape(x.shape)[..., None]
    frames = []
    for frame, part in zip(clip_frames, share, strict=True):
        smooth = np.asarray(Image.fromarray(frame).filter(ImageFilter.GaussianBlur(2)))
        other = smooth + pores
        frames.append(np.clip((1 - part) * frame + part * other, 0, 255).astype(np.uint8))
    result = _captured(np.stack(frames), tmp_path / "dissolve.mp4", first_fit)
    is_followed = result.quality >= HELD_QUALITY
    assert is_followed[:12].all()
    assert not is_followed[20:30].any()
    assert is_followed[30:].all()


@pytest.fixture(scope="module")
def cut_to_another(fetched_clip, tmp_path_factory):
    """11 frames of a man at a webcam, 12 of another man in his place, 8 of the first again: the
    clip, and the first man's fit."""
    for source in (CAP12, SINGLE):
        fetched_clip(source.footage)
    cut = AbuseClip("cut", CAP12, SINGLE)
    result = films.abused_clip(cut, load_template(), lambda _: None)
    parts = [Footage(result.footage).frames(*run) for run in ((40, 50), (51, 62), (101, 108))]
    path = tmp_path_factory.mktemp("cut") / "cut.mp4"
    encode(
        np.stack([image for part in parts for _, image in part]),
        path,
        replace(TEST, fps=CAP12.fps, crf=17),
    )
    return path, clip_capture.find_face(path, frame=4)


@pytest.fixture(scope="module")
def dissolve(fetched_clip, tmp_path_factory):
    """70 frames of a man at a webcam that dissolve into another man's and back: the clip, the first
    man's fit, and of each frame the other's share."""
    clips = [fetched_clip(source.footage) for source in (CAP12, SINGLE)]
    own, other = ([image for _, image in Footage(clip).frames(1, 70)] for clip in clips)
    height, width = own[0].shape[:2]
    share = np.clip(np.minimum(np.arange(70) - 16, 60 - np.arange(70)) / 16, 0, 1)  # of the other
    frames = []
    for mine, its, part in zip(own, other, share, strict=True):
        its = np.asarray(Image.fromarray(its).resize((width, height)), dtype=float)
        frames.append(np.round((1 - part) * mine + part * its).astype(np.uint8))
    path = tmp_path_factory.mktemp("dissolve") / "dissolve.mp4"
    encode(np.stack(frames), path, replace(TEST, fps=CAP12.fps, crf=17))
    return path, clip_capture.find_face(path, frame=4), share


@pytest.mark.parametrize("method", METHODS)
def test_a_dissolve_between_scenes_is_held_and_noted(dissolve, method):
    path, fit, share = dissolve
    result = METHODS[method](path, fit)
    is_followed = result.quality >= HELD_QUALITY
    assert is_followed[share == 0].all()
    assert not is_followed[share > 0.2].any()
    notes = [note for note in result.notes if "dissolve from one scene into another" in note]
    assert len(notes) == 2


@pytest.mark.parametrize("method", METHODS)
def test_a_cut_to_another_person_is_held_and_noted(cut_to_another, method):
    result = METHODS[method](*cut_to_another)
    is_followed = result.quality >= HELD_QUALITY
    assert is_followed.tolist() == 11 * [True] + 12 * [False] + 8 * [True]
    (note,) = [note for note in result.notes if "does not look like the fitted one" in note]
    assert note.startswith("frames 12 to ")


def test_notes_name_the_runs_of_frames_that_show_another_face():
    assert notes_on_strangers([]) == []
    first, second = notes_on_strangers([51, 57, 63, 200, 63])
    assert first.startswith("frames 51 to 63 show a face")
    assert second.startswith("frames 200 to 200 show a face")


@dataclass
class _Estimate:
    held: bool
    found_again: bool = False


def test_a_face_that_was_lost_must_be_found_in_three_frames_on_end():
    good, lost = _Estimate(False), _Estimate(True)
    estimates = [good, lost, good, lost, None, good, good, good, good, lost, good]
    result = list(proved(enumerate(estimates, start=1)))
    assert [frame for frame, _ in result] == list(range(1, 12))
    kept = [frame for frame, estimate in result if estimate is good]
    assert kept == [1, 6, 7, 8, 9]
    assert [estimate for _, estimate in result][2] is None


def test_a_face_that_was_found_in_the_frame_of_its_loss_must_be_found_in_three_frames_on_end():
    good, lost, again = _Estimate(False), _Estimate(True), _Estimate(False, found_again=True)
    estimates = [good, again, lost, again, good, good, good, again, good]
    result = list(proved(enumerate(estimates, start=1)))
    assert [frame for frame, _ in result] == list(range(1, 10))
    assert [frame for frame, estimate in result if estimate and not estimate.held] == [
        1,
        4,
        5,
        6,
        7,
    ]


def _truth(count=12, later=False):
    pose = np.tile(np.diag((1.0, -1.0, -1.0, 1.0)), (count, 1, 1))
    pose[:, :3, 3] = 0, 0, 0.7
    clean = np.ones(count, bool)
    clean[4:8] = False
    gone = np.zeros(count, bool)
    gone[5:7] = True
    return AbuseTruth(pose, clean, gone, np.zeros((count, 2)), 10.0, later)


INTRINSICS = np.array([[480.0, 0, 200], [0, 480, 150], [0, 0, 1]])


def test_frames_without_the_face_and_far_poses_are_wrong_unless_held():
    truth = _truth()
    quality = np.ones(12)
    figures = score_abuse(truth, truth.head_pose, quality, INTRINSICS)
    assert figures == {"touched": 4, "wrong": 2, "worst": 0, "lost": 0, "back": 0}
    turned = truth.head_pose.copy()
    turned[7, :3, :3] = [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
    quality[5:7] = 0
    figures = score_abuse(truth, turned, quality, INTRINSICS)
    assert figures["wrong"] == 1
    assert figures["worst"] == pytest.approx(90)
    quality[7] = 0
    assert score_abuse(truth, turned, quality, INTRINSICS)["wrong"] == 0


@pytest.mark.parametrize(("later", "held"), [(False, slice(8, 11)), (True, slice(1, 4))])
def test_the_way_back_is_counted_from_the_first_clean_frame_in_the_order_of_following(later, held):
    truth = _truth(later=later)
    quality = np.ones(12)
    quality[4:8] = 0
    quality[held] = 0
    figures = score_abuse(truth, truth.head_pose, quality, INTRINSICS)
    assert figures["back"] == pytest.approx(0.3)
    assert figures["lost"] == 0
    quality[0 if not later else 11] = 0
    assert score_abuse(truth, truth.head_pose, quality, INTRINSICS)["lost"] == 1


def test_a_picture_that_slides_turns_the_head_about_the_camera():
    truth = _truth(1)
    (moved,) = slid(truth.head_pose, np.array([[96.0, 0.0]]), INTRINSICS)
    (start,) = slid(truth.head_pose, np.zeros((1, 2)), INTRINSICS)
    assert np.array_equal(start, truth.head_pose[0])
    pixel = INTRINSICS @ moved[:3, 3]
    before = INTRINSICS @ start[:3, 3]
    assert pixel[:2] / pixel[2] - before[:2] / before[2] == pytest.approx([96, 0], abs=1e-9)
    assert np.linalg.norm(moved[:3, 3]) == pytest.approx(0.7)


def test_a_drawn_heads_truth_is_its_motion_since_the_frame_of_the_fit(first_fit, rendered_clip):
    truth = Truth.load(rendered_clip.truth).head_pose
    poses = laid_on(truth, first_fit)
    np.testing.assert_allclose(poses[5], first_fit.head_pose, atol=1e-12)
    shown = replace(first_fit, head_pose=truth[5])
    np.testing.assert_allclose(laid_on(truth, shown), truth, atol=1e-9)


def test_tables_add_frames_and_keep_the_worst():
    rows = [
        {"touched": 4, "wrong": 0, "worst": 3.0, "lost": 0, "back": 0.1},
        {"touched": 5, "wrong": 2, "worst": float("nan"), "lost": 1, "back": 0.4},
    ]
    assert total(rows) == {"touched": 9, "wrong": 2, "lost": 1, "worst": 3.0, "back": 0.4}
    assert as_text([]) == ""
