# SPDX-License-Identifier: GPL-3.0-or-later
"""What is composed keeps the person's eyes, and turns them where an expression does."""

from dataclasses import replace

import numpy as np
from looking_performance import make_looking
from mimetic.library.composing import Placing, canonical_person, compose
from mimetic.library.expression import Expression
from mimetic.library.preview import expression_picture
from mimetic.muscles.extras import LIP_SHAPES
from mimetic.performance.gaze import gaze_of


def glance():
    rows = np.sin(np.linspace(0, np.pi, 31))[:, None] * np.array([[20.0, 20.0]])
    channels = ["gaze_yaw.L", "gaze_yaw.R"]
    return Expression(
        channels=channels,
        values=rows,
        stds=np.full(rows.shape, 1.0),
        fps=30.0,
    )


def test_a_glance_turns_the_persons_eyes():
    person = make_looking()
    composed = compose([Placing("glance")], lambda _: glance(), person, fps=30)
    np.testing.assert_array_equal(composed.eye_centers, person.eye_centers)
    peak = int(gaze_of(composed)[:, 0].argmax())
    assert gaze_of(composed)[peak, 0] > 10
    ball = composed.eye_of_vertex == 1
    moved = composed.surface(peak)[ball] - composed.neutral_vertices[ball]
    assert np.abs(moved).max() > 0.002


def test_the_picture_of_a_glance_shows_where_it_looks():
    person = canonical_person()
    ahead = replace(glance(), values=0 * glance().values)
    eyes = [expression_picture(one, person)[..., :3].astype(float) for one in (ahead, glance())]
    assert (np.abs(eyes[1] - eyes[0]).max(axis=2) > 60).sum() > 20


def test_our_own_head_has_the_lips_of_a_capture():
    rows = np.sin(np.linspace(0, np.pi, 31))[:, None] * np.full((1, 4), 0.5)
    channels = list(LIP_SHAPES)
    kept = Expression(channels=channels, values=rows, stds=0 * rows, fps=30.0)
    composed = compose([Placing("pout")], lambda _: kept, fps=30)
    assert [note for note in composed.notes if "has no" in note] == []
    closing = composed.articulators.index("oris_close_upper")
    assert composed.articulator_values[:, closing].max() > 0.4
    assert np.abs(composed.surface(15) - composed.neutral_vertices).max() > 0.001


def test_our_own_head_has_eyes_that_turn():
    composed = compose([Placing("glance")], lambda _: glance(), canonical_person(), fps=30)
    assert gaze_of(composed).max() > 10
    assert not [note for note in composed.notes if "gaze" in note]
