# SPDX-License-Identifier: GPL-3.0-or-later
"""The captured face as lines for an editor, against the surface that the overlay video draws."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic.library.composing import canonical_person
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.report.face_lines import PerformanceLines, quality_strip
from mimetic.report.overlay import FaceDrawing
from mimetic.solve.correcting import with_turn, with_value
from mimetic.template.face_template import load_template
from sample_performance import make_performance


@pytest.fixture(scope="module")
def person() -> Performance:
    """The canonical head, smiling with the mouth open, looking up."""
    rest = canonical_person()
    activations, values = rest.activations.copy(), rest.articulator_values.copy()
    activations[0, rest.muscles.index("zygomaticus_major.L")] = 0.7
    values[0, rest.articulators.index("jaw_open")] = 0.5
    values[0, rest.articulators.index("gaze_pitch.L")] = 8
    return replace(rest, activations=activations, articulator_values=values)


def turned(performance: Performance, degrees: float) -> Performance:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    pose = performance.head_pose.copy()
    pose[:, :3, :3] = pose[:, :3, :3] @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return replace(performance, head_pose=pose)


def test_landmarks_lie_where_the_overlay_video_has_them(person):
    drawing = FaceDrawing(person)
    control = np.ascontiguousarray(person.surface_in_camera(0)[drawing.vertices])
    points = drawing.mesh.positions(control)[: len(control)]
    pixels = points @ person.intrinsics.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    lines = PerformanceLines(person)
    marks = lines.draw(0).marks * person.image_size - 0.5  # from edges to centres of pixels
    vertices = [load_template().landmark(name) for name in lines.landmarks]
    expected = pixels[vertices]
    expected[:, 1] = person.image_size[1] - 1 - expected[:, 1]  # up
    np.testing.assert_allclose(marks, expected, atol=0.05)


def test_what_is_turned_away_or_covered_is_not_drawn(person):
    front, aside = PerformanceLines(person), PerformanceLines(turned(person, 60))
    names = front.landmarks
    seen = dict(zip(names, front.draw(0).marks_shown, strict=True))
    beside = dict(zip(names, aside.draw(0).marks_shown, strict=True))
    assert seen["eye_outer.L"] and seen["eye_outer.R"] and seen["nose_tip"]
    assert beside["eye_inner.L"] != beside["eye_inner.R"]
    assert len(aside.draw(0).features) < 0.8 * len(front.draw(0).features)
    assert len(front.draw(0).rings) > 20
    assert ((front.draw(0).mesh > 0) & (front.draw(0).mesh < 1)).all()


def test_a_face_behind_the_camera_is_not_drawn(person):
    pose = person.head_pose.copy()
    pose[:, 2, 3] *= -1
    drawn = PerformanceLines(replace(person, head_pose=pose)).draw(0)
    assert len(drawn.mesh) == len(drawn.features) == 0 and not any(drawn.marks_shown)


def test_a_mesh_of_another_make_has_its_surface_alone():
    lines = PerformanceLines(make_performance(3))
    drawn = lines.draw(1)
    assert len(drawn.mesh) > 0 and len(drawn.features) == 0 and lines.landmarks == []


def test_the_strip_has_a_box_a_frame_in_the_colour_of_its_quality():
    captured = make_performance(3)
    captured = replace(
        captured, frame=np.array([2, 3, 7]), quality=np.array([0.5 * HELD_QUALITY, 0.6, 1.0])
    )
    points, colours = quality_strip(captured.frame, captured.quality, 10.0, 4.0, 20.0, 6.0)
    boxes = points.reshape(3, 6, 2)
    np.testing.assert_allclose(boxes.min(axis=1), [[14, 20], [18, 20], [34, 20]])
    np.testing.assert_allclose(boxes.max(axis=1), [[18, 26], [22, 26], [38, 26]])
    red, green = colours.reshape(3, 6, 4)[:, 0, 0], colours.reshape(3, 6, 4)[:, 0, 1]
    assert red[0] > 0.8 and green[0] == 0 and red[2] == 0 and green[2] > 0.7


def test_a_correction_is_drawn_as_it_states_the_face(person):
    lines = PerformanceLines(person)
    captured = lines.draw(0)
    lid = with_value((), 1, "lid_upper.L", 1.0, 0, 8)[0]
    stated = lines.draw(0, lid)
    moved = np.abs(stated.marks - captured.marks).max(axis=1) * person.image_size[1]
    names = [name for name, by in zip(lines.landmarks, moved, strict=True) if by > 0.5]
    assert names and all(name.endswith(".L") for name in names), names
    pose = with_turn((), person, 1, (0, 0, 0), (0.02, 0, 0), 8)[0]
    beside = lines.draw(0, pose).marks - captured.marks
    assert (beside[:, 0] > 0.01).all() and np.abs(beside[:, 1]).max() < 1e-5
    gaze = with_value((), 1, "gaze_yaw.L", 25.0, 0, 8)[0]
    assert not np.array_equal(lines.draw(0, gaze).rings, captured.rings)
    np.testing.assert_array_equal(lines.draw(0, gaze).mesh, captured.mesh)
    np.testing.assert_array_equal(lines.draw(0).features, captured.features)
