# SPDX-License-Identifier: GPL-3.0-or-later
"""People who speak and wink: what they do, and how it is scored."""

import numpy as np
import pytest
from mimetic.template.face_template import load_template

from evaluation.runs.speech import OURS, SpeechScore, as_text, labels_of, lid_figures, lip_figures
from evaluation.synthetic.gaze.recipes import SETS as GAZES
from evaluation.synthetic.motion import control_values
from evaluation.synthetic.speech.recipes import AT_REST, FPS, LIDS, SETS, SHUT


@pytest.fixture(scope="module")
def spoken():
    """The film's truth of two syllables of the canonical head, without a film."""
    template = load_template()
    jaw = template.unit_modes[list(template.unit_names).index("jawOpen")]
    opening = 0.4 * np.sin(np.pi * np.arange(60) / 20).clip(0) ** 2  # of 20 frames, and 20 shut
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1, -1])
    pose[2, 3] = 0.6
    truth = {
        "vertices": (template.vertices + opening[:, None, None] * jaw).astype(np.float32),
        "head_pose": np.tile(pose, (60, 1, 1)),
        "intrinsics": np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]),
    }
    return labels_of("clip", truth, template)


def test_lips_of_a_drawn_head_meet_where_its_jaw_is_shut(spoken):
    assert spoken.touch[[0, 25, 35, 59]].all()
    assert not spoken.touch[[10, 50]].any()
    assert (np.diff(spoken.touch) != 0).sum() == 4


def test_places_like_the_truth_have_no_error_and_meet_when_it_does(spoken):
    figures, met = lip_figures(spoken, OURS, spoken.places)
    assert met == (3, 3, 3) and figures["met"] == figures["told"] == 1
    assert figures["inner lips"] == figures["lids"] == 0
    text = as_text([SpeechScore("clip", "still", OURS, figures, met)])
    assert f"all: {OURS}" in text


def test_lips_that_meet_two_frames_late_are_not_found(spoken):
    late = np.roll(spoken.places, 2, axis=0)
    figures, met = lip_figures(spoken, OURS, late)
    assert met == (3, 2, 0) and figures["told"] < 1  # the last frame's contact is gone


def test_lips_that_never_part_are_one_contact(spoken):
    figures, met = lip_figures(spoken, OURS, np.tile(spoken.places[:1], (60, 1, 1)))
    assert met == (3, 1, 0)
    assert figures["met"] == 0


def test_winks_are_of_one_eye_and_half_a_blink_is_half_of_one():
    shut = np.zeros((40, 2))
    shut[5, 0] = shut[15, 1] = 1
    shut[25] = 1
    shut[35] = 0.5
    spans = np.array([[1, 10], [11, 20], [21, 30], [31, 40]])
    truth = {"lids_shut": shut, "lid_motions": spans}
    assert lid_figures(shut, truth) == {"winks": 1, "other": 0, "blink": 1, "half": 0.5}
    together = np.tile(shut.max(axis=1, keepdims=True), (1, 2))
    assert lid_figures(together, truth)["other"] == 1
    slack = shut * [1, 0.3]
    figures = lid_figures(slack, truth)
    assert figures["winks"] == figures["blink"] == pytest.approx(0.3)


def test_people_never_meet_and_part_their_lips_between_syllables():
    seeds = {name: {clip.recipe.seed for clip in clips} for name, clips in SETS.items()}
    seeds["gaze"] = {clip.recipe.seed for clips in GAZES.values() for clip in clips}
    assert not seeds["held-out"] & (seeds["tuning"] | seeds["gaze"])
    assert not seeds["tuning"] & seeds["gaze"]
    names = load_template().unit_names
    for clip in SETS["held-out"]:
        times = np.arange(clip.recipe.num_frames) / FPS
        values = dict(zip(names, control_values(clip.recipe.phases, names, times).T, strict=True))
        assert values["jawOpen"][times < AT_REST].max() == 0
        parted = (values["jawOpen"] > 0.01).astype(int)
        assert (np.diff(parted) > 0).sum() == len(clip.words) // 2
        assert [name for name, _, _ in clip.lids] == list(LIDS)
        assert 0.9 * SHUT < values["eyeBlinkLeft"].max() <= SHUT
