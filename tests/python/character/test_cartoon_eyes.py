# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes several times as large as a person's, on a head that is wide enough for them."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.character.foreign_head import attach_foreign
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.template.face_template import load_template

ORBIT = 0.017  # m about the eyeball's middle that is enlarged as it is
DEEPER = 0.009  # m that a ball of twice the size lies deeper, so that a quarter of the rest bulges


def with_eyes(times: float, width: float) -> np.ndarray:
    """The template `width` times as wide, with eyes `times` as large; the skin about them is drawn
    together outside, and stays in the middle of the face."""
    template = load_template()
    vertices = np.asarray(template.vertices)
    wide = vertices * (width, 1, 1)
    moved = wide.copy()
    for side, sign in (("L", 1), ("R", -1)):
        middle = vertices[template.part_vertices(f"eye.{side}")].mean(axis=0)
        offsets = vertices - middle
        reach = np.linalg.norm(offsets, axis=1)
        last = 1.5 * times * ORBIT
        slope = (last - times * ORBIT) / (last - ORBIT)
        outside = np.where(reach < last, times * ORBIT + (reach - ORBIT) * slope, reach)
        new_reach = np.where(reach < ORBIT, times * reach, outside)
        share = (new_reach / np.maximum(reach, 1e-9) - 1) / (times - 1)
        share *= np.clip((sign * vertices[:, 0] + 0.004) / 0.02, 0, 1)
        centre = middle * (width, 1, 1) - (0, 0, DEEPER * (times - 1))
        moved += share[:, None] * (centre + times * offsets - wide)
    return moved


def attached(vertices):
    template = load_template()
    marks = {name: int(template.landmark(name)) for name in REQUIRED}
    return attach_foreign(vertices, np.asarray(template.faces), marks, template)


@pytest.mark.parametrize(("times", "width"), [(3.0, 1.45), (4.0, 2.0)])
def test_lids_of_large_eyes_close_outside_of_them(times, width):
    template, vertices = load_template(), with_eyes(times, width)
    head = attached(vertices)
    assert head.notes == ()
    for centre, side in zip(head.eye_centers, "LR", strict=True):
        middle = vertices[template.part_vertices(f"eye.{side}")].mean(axis=0)
        assert np.linalg.norm(centre - middle) < 1e-3
    units = head.make_units()
    assert max(units.gaps_mm.values()) < 0.3
    assert max(units.depths_mm.values()) < 0.1
    blink = units.modes[units.names.index("eyeBlinkLeft")]
    assert np.linalg.norm(blink, axis=1).max() > 0.01 * times / 2  # the whole way


def test_eyes_that_overlap_are_refused_by_their_corners():
    with pytest.raises(InvalidInput, match=r"eye_inner\.L and eye_inner\.R .* overlap"):
        attached(with_eyes(4.0, 1.0))
