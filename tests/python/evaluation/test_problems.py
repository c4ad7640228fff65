# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong in footage: what is put before drawn faces, and how they are filmed badly."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.template.face_template import load_template

from evaluation.runs.problems import PROBLEMS
from evaluation.runs.worn import glasses, hair
from evaluation.synthetic.motion import HeadMotion

FPS = 30.0


@pytest.fixture
def truth():
    """Ten frames of a drawn person before a wide camera, at rest for the first half second."""
    poses = HeadMotion(yaw=20).poses(np.arange(40) / FPS, 0.6, seed=3)
    return SimpleNamespace(
        head_pose=poses[:: len(poses) // 10],
        intrinsics=np.array([[250.0, 0, 159.5], [0, 250.0, 119.5], [0, 0, 1]]),
        neutral_vertices=np.asarray(load_template().vertices),
        tracks=np.full((10, 4, 2), 160.0),
        fps=FPS,
    )


@pytest.mark.parametrize("worn", [glasses, hair])
def test_what_is_worn_covers_part_of_the_face_and_moves_with_it(truth, worn):
    frames = np.full((len(truth.head_pose), 240, 320, 3), 200, np.uint8)
    spoilt = worn(frames, truth, np.random.default_rng(5))
    assert (frames == 200).all()
    covered = (spoilt != frames).any(3)
    assert (covered.mean((1, 2)) > 0.003).all() and (covered.mean((1, 2)) < 0.2).all()
    assert (covered[0] != covered[-1]).any()
    rows, columns = np.nonzero(covered[0])
    assert abs(columns.mean() - 160) < 40 and rows.max() < 200


def test_every_way_of_filming_gives_footage_of_the_same_length(truth):
    rng = np.random.default_rng(0)
    frames = rng.integers(0, 255, (10, 240, 320, 3), dtype=np.uint8)
    for name, problem in PROBLEMS.items():
        spoilt = problem.spoil(frames, truth, np.random.default_rng(5))
        assert spoilt.dtype == np.uint8 and len(spoilt) == 10, name
        assert spoilt.shape[1:3] == ((60, 80) if name == "small" else (240, 320)), name
