# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate characters`."""

import numpy as np
import pytest
from mimetic.commands.cli import main
from mimetic.template.face_template import load_template

from evaluation.runs import characters
from evaluation.synthetic.characters import GLTF, RECIPES, Recipe, Style, made, stylised


def test_no_head_of_the_held_out_set_is_tuned_on():
    seeds = {name: {recipe.seed for recipe in recipes} for name, recipes in RECIPES.items()}
    assert not seeds["held-out"] & (seeds["tuning"] | seeds["small"])


def test_landmarks_of_a_made_head_are_its_vertices():
    head = made(Recipe("person", 5, 0.3, 0.0, GLTF, 100.0), load_template())
    for name, place in head.truth.items():
        assert np.abs(head.vertices - place).sum(1).min() < 1e-9, name
    assert head.pupil_distance == pytest.approx(6.3, rel=0.2)


def test_a_style_makes_eyes_larger():
    template = load_template()
    head = stylised(template.vertices, template, Style(eyes=1.5))
    corners = [template.landmark(f"eye_{end}.L") for end in ("inner", "outer")]
    width, usual = (abs(np.diff(places[corners, 0])[0]) for places in (head, template.vertices))
    assert width == pytest.approx(1.5 * usual, rel=0.15)


def test_the_table_says_what_was_not_seen():
    score = characters.CharacterScore("a ball", 300, 2.0)
    assert "a ball" in characters.as_text([score])


def test_the_command_prints_the_small_set(capsys):
    assert main(["evaluate", "characters", "--set", "small"]) == 0
    out = capsys.readouterr().out
    assert "person" in out
    assert "nose_tip" in out
