# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves from frame to frame tells which of them is at rest."""

import numpy as np
from fetched_footage import fetched_frames
from mimetic import _core
from mimetic.fit.fitting import find_face
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import factored_skin
from mimetic.solve.rest_motion import moved_from
from mimetic.template.face_template import load_template

# Of franck.mp4, a blink marked by hand (evaluation/real/franck.blinks.csv)
FIRST, CLOSED, LAST = 158, 166, 176


def test_a_frame_with_shut_lids_is_not_at_rest_however_well_it_looks(tmp_path):
    footage = Footage(fetched_frames("franck.mp4", FIRST, LAST, tmp_path))
    closed = CLOSED - FIRST + 1
    frames = {1, 2, 3, closed, *range(footage.num_frames - 3, footage.num_frames + 1)}
    fit = find_face(footage.read(1), 1)
    template = load_template()
    skin = factored_skin(fit.neutral_vertices(template), template)
    followed = dict(moved_from(footage, fit, frames, skin))
    assert set(followed) == frames
    values, lids = (
        np.array([getattr(m, n) for m in followed.values()]) for n in ("values", "lids")
    )
    alike = np.ones(len(frames))
    costs = _core.costs_of_rest(values, lids, alike, alike, np.zeros((0, 2)))
    costs = dict(zip(followed, costs, strict=True))
    others = [cost for frame, cost in costs.items() if frame != closed]
    assert costs[closed] > max(others) + 1
