# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters of the sample scenes: their muscles are where their faces are."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.newest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "sample_scenes"))


def points_of(key) -> np.ndarray:
    points = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", points)
    return points.reshape(-1, 3)


def test_the_monkeys_jaw_opens_below_its_mouth():
    from make_characters import CHARACTERS, MONKEY

    monkey = CHARACTERS["suzanne"]()
    keys = monkey.data.shape_keys.key_blocks
    rest = points_of(keys[0])
    middle = (rest.min(axis=0) + rest.max(axis=0)) / 2
    moved = np.linalg.norm(points_of(keys["jaw_open"]) - rest, axis=1)
    mouth = middle[2] + MONKEY["lip_upper_inner"][1]
    assert np.median(rest[moved > 0.6 * moved.max(), 2]) < mouth


def test_the_monkeys_eyes_are_stiff_and_turn_with_the_gaze():
    from make_characters import CHARACTERS

    monkey = CHARACTERS["suzanne"]()
    keys = monkey.data.shape_keys.key_blocks
    rest = points_of(keys[0])
    eye = left_eye(monkey, rest)
    assert len(eye) == 497
    moved = {key.name: (points_of(key) - rest)[eye] for key in keys[1:]}
    assert {name for name, offsets in moved.items() if np.abs(offsets).max() > 1e-6} == {
        f"look_{way}.L" for way in ("up", "down", "in", "out")
    }
    for way in ("up", "out"):
        assert np.abs(moved[f"look_{way}.L"]).max() > 0.003


def left_eye(monkey, rest: np.ndarray) -> np.ndarray:
    """Vertices of the piece of the mesh that has the foremost point on the eye."""
    at = rest.min(axis=0) + np.ptp(rest, axis=0) * [0.63, 0.0, 0.6]
    edges = np.array([edge.vertices for edge in monkey.data.edges])
    is_in = np.zeros(len(rest), bool)
    is_in[np.argmin(np.linalg.norm((rest - at)[:, [0, 2]], axis=1) + 1e-3 * rest[:, 1])] = True
    while True:
        before = is_in.sum()
        is_in[edges[is_in[edges].any(axis=1)]] = True
        if is_in.sum() == before:
            return np.flatnonzero(is_in)


def test_characters_are_measured(extension, monkeypatch, capsys):
    import blender_module
    from measure_characters import measure

    repository = extension("outcome").__name__.split(".")[1]
    monkeypatch.setattr(blender_module, "repository", lambda: repository)
    measure("canonical")
    line = capsys.readouterr().out.splitlines()[-1].split()
    assert line[0] == "canonical"
    assert [float(word) for word in line[1:6]] == [1, 0, 1, 0, 0]  # muscles play themselves
    assert all(float(word) < 0.3 for word in line[6:])  # mm, of the 52 shapes
