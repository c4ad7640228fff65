# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.muscles import anatomy
from mimetic.muscles.extras import attach_extras
from mimetic.template.face_template import load_template

from evaluation.anatomy.anatomy_sheet import sheet_tiles
from evaluation.anatomy.folds import Folds
from evaluation.anatomy.unit_muscles import EXPRESSIONS

SHARPEST = 105.0  # degrees between neighbouring triangles; 63 at rest, at the lids' edge
SHARPENED = 45.0  # degrees more than at rest
BONES_AND_LIDS = 65.0  # lid skin rolls in at the corner of the eye, lips part with the jaw


@pytest.fixture(scope="module")
def skin():
    template = load_template()
    return anatomy.attach_skin(template.vertices, template)


@pytest.fixture(scope="module")
def folds(skin):
    return Folds(skin.mesh)


@pytest.fixture(scope="module")
def modes(skin):
    return anatomy.modes_of(skin)


@pytest.fixture(scope="module")
def tiles(skin, modes):
    return sheet_tiles(modes, attach_extras(skin))


def test_a_triangle_turned_over_is_seen(skin, folds):
    mesh = skin.mesh
    assert folds.angles().max() < 70
    vertex = mesh.landmark("glabella")
    push = np.zeros_like(mesh.neutral)
    push[vertex, 1] = 0.03  # past its neighbours
    assert folds.angles(push).max() > 150


def test_no_muscle_alone_folds_the_skin(folds, modes):
    rest = folds.angles()
    for name, mode in zip(modes.muscle_names, modes.muscle_modes, strict=True):
        moved = folds.angles(mode)
        assert moved.max() < SHARPEST, name
        assert (moved - rest).max() < SHARPENED, name


def test_no_pair_and_no_expression_folds_the_skin(folds, tiles):
    rest = folds.angles()
    assert len(tiles) > 40
    assert all(f"{title} 100%" in tiles for title in EXPRESSIONS)
    for title, tile in tiles.items():
        moved = folds.angles(tile.displacement)
        of_bone = title.startswith(("jaw", "lid"))
        assert moved.max() < SHARPEST, title
        assert (moved - rest).max() < (BONES_AND_LIDS if of_bone else SHARPENED), title
