"""The gaze of rendered people: what they do, and how it is scored."""

import numpy as np
import pytest
from looking_performance import make_looking
from mimetic import InvalidInput
from mimetic.template.face_template import load_template
from sample_performance import make_performance

from evaluation.runs.gaze import OURS, as_text, score_capture
from evaluation.synthetic.gaze.films import _moved
from evaluation.synthetic.gaze.recipes import AT_REST, FIXATION, SETS


def truth_of(performance, off=(0.0, 0.0)):
    """What a film's truth has, had it been drawn off by degrees of yaw and pitch."""
    from mimetic.performance.gaze import gaze_of, iris_circles

    irises, corners = [], []
    for i, pose in enumerate(performance.head_pose):
        seen = iris_circles(performance, i)[:, 0] @ pose[:3, :3].T + pose[:3, 3]
        irises.append(performance.project(seen))
        ends = performance.eye_centers @ pose[:3, :3].T + pose[:3, 3]
        corners.append(np.stack([performance.project(ends)] * 2, axis=1))
    return {
        "gaze": gaze_of(performance) + np.array([*off, *off]),
        "iris_pixels": np.stack(irises),
        "corner_pixels": np.stack(corners),
    }


def looking():
    performance = make_looking()
    performance.articulator_values_std = np.full_like(performance.articulator_values, 2.0)
    return performance


def test_a_capture_like_the_truth_has_no_error():
    score = score_capture("clip", "eyes", looking(), truth_of(looking()))
    assert score.figures["gaze"] == pytest.approx(0, abs=1e-6)
    assert score.figures["iris"] == pytest.approx(0, abs=1e-6)
    assert score.figures["inside"] == 1


def test_an_error_of_some_degrees_is_told_and_so_is_what_a_known_bias_leaves():
    score = score_capture("clip", "eyes", looking(), truth_of(looking(), (0.0, 4.0)))
    assert score.figures["gaze"] == pytest.approx(4, abs=0.01)
    assert score.figures["known"] == pytest.approx(0, abs=1e-6)
    assert score.figures["inside"] == 0.5  # yaw alone: the bars are 3.3 degrees wide
    assert f"eyes: {OURS}" in as_text([score])


def test_a_performance_without_gaze_is_refused():
    with pytest.raises(InvalidInput, match="no gaze"):
        score_capture("clip", "eyes", make_performance(), truth_of(looking()))


def test_people_look_ahead_first_then_about_and_never_meet():
    seeds = {name: {clip.recipe.seed for clip in clips} for name, clips in SETS.items()}
    assert not seeds["held-out"] & seeds["tuning"]
    clip = SETS["held-out"][0]
    angles = clip.angles()
    assert np.ptp(angles[:AT_REST], axis=0).max() == 0
    assert np.ptp(angles[AT_REST : AT_REST + FIXATION], axis=0).max() == 0
    assert np.ptp(angles[:, 0]) > 25
    np.testing.assert_allclose(angles[:, 2] - angles[:, 0], 2)  # vergence


def test_drawn_lids_go_along_and_other_skin_does_not_move():
    template = load_template()
    moved = _moved(template.vertices, template, np.array([[0.0, -20, 0, -20]]))[0]
    shift = np.linalg.norm(moved - template.vertices, axis=1)
    assert shift[template.landmark("lid_upper.L")] > 0.002
    assert shift[template.landmark("mouth_corner.L")] < 1e-9
    assert shift[template.part_vertices("eye.R")].max() > 0.004
