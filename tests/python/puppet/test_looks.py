# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks as they are named, and how well they are told apart."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.library.expression import Expression
from mimetic.puppet.separability import advice, separability
from mimetic.puppet.set_making import Channels, templates_of
from mimetic.puppet.taught_look import Look, parse_look, parse_shown_look, parse_state
from sample_taught import make_taught


def test_a_look_is_named_by_its_frame_and_parts():
    assert parse_look("smile=120") == Look("smile", 120)
    assert parse_look("wink=7:eye.L,brows") == Look("wink", 7, ("eye.L", "brow.L", "brow.R"))
    for text, message in (("smile", "NAME=FRAME"), ("a=1:nose", "'nose'"), ("=4", "NAME=FRAME")):
        with pytest.raises(InvalidInput, match=message):
            parse_look(text)


def test_a_look_that_is_shown_has_no_frame():
    assert parse_shown_look("eyes closed:eyes") == Look("eyes closed", 0, ("eye.L", "eye.R"))
    for text in ("smile=120", "", " ", "a:nose"):
        with pytest.raises(InvalidInput):
            parse_shown_look(text)


def test_a_state_is_sliders_a_kept_expression_or_a_solved_frame(performance, tmp_path):
    name = performance.muscles[0]
    channels = {*performance.muscles, *performance.articulators}
    assert parse_state(f"smile={name}:.8,jaw_open:.2", channels) == (
        "smile",
        {name: 0.8, "jaw_open": 0.2},
    )
    path = tmp_path / "wide.expression.npz"
    values = np.array([[0.0, 0.1], [0.6, 0.2]])
    Expression([name, "elsewhere"], values, np.full((2, 2), 0.05), 25.0).save(path)
    assert parse_state(f"wide={path}", channels) == ("wide", {name: 0.6})
    solved = tmp_path / "solved.npz"
    performance.save(solved)
    look, values = parse_state(f"wide={solved}:{performance.frame[7]}", channels)
    assert look == "wide" and values.keys() == channels
    assert values[name] == performance.activations[7, 0]
    with pytest.raises(InvalidInput, match="frame 999 is not in the performance"):
        parse_state(f"wide={solved}:999", channels)
    for text, message in (
        ("x=nothing:1", "nothing"),
        ("x=jaw_open:a", "not a number"),
        ("x", "NAME="),
    ):
        with pytest.raises(InvalidInput, match=message):
            parse_state(text, channels)


def test_looks_that_score_alike_are_named_and_others_are_not():
    taught = make_taught()
    pairs = separability(taught)
    assert len(pairs) == 3 + 3 + 1 and advice(pairs) == []
    assert min(pair.d_prime for pair in pairs) > 4
    scores = taught.example_scores.copy()
    mouth = taught.of_part("mouth")
    scores[:, mouth[2]] = scores[:, mouth[1]]  # surprise's mouth scores as smile's
    alike = separability(make_taught(example_scores=scores))
    assert (alike[0].part, alike[0].first, alike[0].second) == ("mouth", "smile", "surprise")
    assert advice(alike)[0].startswith("smile and surprise are hard to tell apart by the mouth")


def test_the_whole_face_of_a_look_like_another_is_kept_and_no_part_of_it():
    muscles = ["puller.L", "raiser.L", "raiser.R", "squeezer.L", "squeezer.R"]
    channels = Channels(muscles, [1, 5, 5, 7, 7], ["jaw_open"])
    rest, smile, alike, lifted = np.zeros((4, 6))
    smile[0], alike[0], lifted[:2] = 0.8, 0.75, (0.75, 0.9)
    looks = [Look("neutral", 1), Look("smile", 20), Look("alike", 21), Look("lifted", 30)]
    templates = templates_of(looks, [rest, smile, alike, lifted], channels)
    kept = [[part for i, part in templates if i == look] for look in range(len(looks))]
    assert kept[1:] == [["face", "mouth"], ["face"], ["face", "brow.L"]]
    own = [*looks[:2], Look("alike", 21, ("mouth",))]
    templates = templates_of(own, [rest, smile, alike], channels)
    assert [part for i, part in templates if i == 2] == ["mouth"]


def test_a_look_without_a_template_is_told_apart_from_none():
    """As in sets of earlier versions, of which other looks are taught again."""
    taught = make_taught()
    kept = taught.template_looks != 2
    ends = np.cumsum(taught.template_boxes[:, 2] * taught.template_boxes[:, 3])
    pixels = np.split(taught.template_pixels, ends[:-1])
    old = make_taught(
        template_parts=[part for part, k in zip(taught.template_parts, kept, strict=True) if k],
        template_looks=taught.template_looks[kept],
        template_boxes=taught.template_boxes[kept],
        template_pixels=np.concatenate([part for part, k in zip(pixels, kept, strict=True) if k]),
        example_scores=taught.example_scores[:, kept],
    )
    (line,) = advice(separability(old))
    assert line.startswith("neutral and surprise are hard to tell apart by the face (d' 0.0)")
