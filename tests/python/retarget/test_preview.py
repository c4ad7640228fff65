# SPDX-License-Identifier: GPL-3.0-or-later
"""What a table of controls makes of a performance at one frame: what a bake of it would show."""

import dataclasses

import numpy as np
import pytest
from acting import make_acting
from mimetic.retarget.controls import ControlRow
from mimetic.retarget.playing import ControlPreview, play
from surfaces import make_surface

RISE = np.linspace(0, 1, 6)
FRAMES = np.arange(10.0, 22.0, 2.0)


@pytest.fixture(scope="module")
def acting():
    return make_acting({"jaw_open": RISE, "frontalis_medial.L": RISE})


@pytest.fixture(scope="module")
def preview(acting):
    return ControlPreview(acting, make_surface(), FRAMES)


def rows(**changed) -> list[ControlRow]:
    plain = [ControlRow(name) for name in make_surface().control_names]
    return [changed.get(row.control, row) for row in plain]


@pytest.mark.parametrize(
    "table",
    [
        {},
        {"jawOpen": ControlRow("jawOpen", gain=0.5, offset=0.1, highest=0.4, curve=2.0)},
        {"jawOpen": ControlRow("jawOpen", is_on=False)},
    ],
)
def test_it_shows_what_a_bake_keys(acting, preview, table):
    baked = play(acting, make_surface(), rows(**table))
    for number, frame in enumerate(FRAMES):
        shown = preview.values(frame, rows(**table))
        assert shown.keys() == set(baked.names)
        expected = dict(zip(baked.names, baked.values[number], strict=True))
        assert shown == pytest.approx(expected, abs=1e-12)


def test_what_a_gain_brings_within_the_range_is_not_cut_before(acting):
    """By its name a key goes beyond its end: cut before it is halved, it would stop half-way."""
    surface = make_surface(has_muscles=False)
    table = [ControlRow(name, gain=0.5, highest=0.3) for name in surface.control_names]
    surface = dataclasses.replace(surface, control_range=0.3 * np.asarray(surface.control_range))
    baked = play(acting, surface, table)
    shown = ControlPreview(acting, surface, FRAMES).values(FRAMES[-1], table)
    assert shown["jawOpen"] > 0.2
    assert shown == pytest.approx(dict(zip(baked.names, baked.values[-1], strict=True)), abs=1e-12)


def test_between_keys_it_lies_on_their_line_and_beyond_them_it_stays(preview):
    ends = [preview.values(frame, rows())["jawOpen"] for frame in (14.0, 16.0)]
    assert preview.values(15.0, rows())["jawOpen"] == pytest.approx(np.mean(ends))
    assert preview.values(1.0, rows()) == preview.values(10.0, rows())
    assert preview.values(99.0, rows()) == preview.values(20.0, rows())


def test_a_table_with_nothing_on_moves_nothing(preview):
    off = [ControlRow(name, is_on=False) for name in make_surface().control_names]
    assert preview.values(20.0, off) == {}
