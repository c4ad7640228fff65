# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters of the sample scenes: their muscles are where their faces are."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.oldest_and_newest

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
