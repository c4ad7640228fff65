# SPDX-License-Identifier: GPL-3.0-or-later
"""Coefficients in files of fits mean the same head for as long as there are such files."""

import numpy as np
from mimetic.fit.face_shape import face_shape
from mimetic.fit.mode_signs import signs
from mimetic.fit.residual_shape import residual_modes
from mimetic.template.face_template import load_template

# Of modes as files of schema 2 to 4 were written with them; bit i: mode i moves the left half of
# the face to the right, down or backwards where it moves it most
RESIDUAL = 0x69679416E3894E3F9663522C4C9754B92C9D3A70F
COMPONENTS = 0x84EE824806CE83C4D2FE360F


def where_modes_move_most(modes: np.ndarray) -> int:
    template = load_template()
    left = np.flatnonzero(template.vertices[: template.num_skin_vertices, 0] > 1e-6)
    flat = modes[:, left].reshape(len(modes), -1)
    largest = np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, None], axis=1)[:, 0]
    return sum(1 << i for i, value in enumerate(largest) if value < 0)


def test_modes_are_the_way_round_that_files_have_them():
    template = load_template()
    assert where_modes_move_most(residual_modes(template)) == RESIDUAL
    assert where_modes_move_most(face_shape(template).components) == COMPONENTS


def test_bits_reverse_modes_from_the_first():
    assert signs(0b101, 4).tolist() == [-1, 1, -1, 1]
