# SPDX-License-Identifier: GPL-3.0-or-later
"""Views in which the head is turned otherwise are chosen, and tell a bent head from a long face."""

import numpy as np
import pytest
from drawn_face import draw
from mimetic import _core
from mimetic.fit.fitting import FaceFit, find_face, join_views, judge_frame, refit
from mimetic.fit.views import MOST_VIEWS, Candidate, choose_views
from mimetic.template.face_template import load_template
from test_fit import CAMERA, angle_deg, pose


def features_with_nose_at(x, y):
    places = {"pupil.L": (30, 0), "pupil.R": (-30, 0), "ala.L": (60 * x + 9, 60 * y)}
    places["ala.R"] = (60 * x - 9, 60 * y)
    named = [_core.Feature(n, np.array(p, float)) for n, p in places.items()]
    return _core.FaceFeatures(named, [], np.zeros(4), 1.0)


def test_views_are_turned_otherwise_and_at_rest():
    noses = [(0, 0.7), (0.005, 0.7), (0.3, 0.7), (-0.2, 0.7), (0, 0.9), (0.25, 0.5)]
    usual = [1, 1, 1, 1, 1, 0.1]
    candidates = [
        Candidate(i + 1, features_with_nose_at(*nose), share)
        for i, (nose, share) in enumerate(zip(noses, usual, strict=True))
    ]
    chosen = [view.frame for view in choose_views(candidates[0], candidates)]
    assert sorted(chosen) == [3, 4, 5]
    many = [Candidate(i + 1, features_with_nose_at(0.1 * i, 0.7), 1.0) for i in range(20)]
    assert len(choose_views(many[0], many)) == MOST_VIEWS
    assert choose_views(candidates[0], candidates[:2]) == []


@pytest.fixture(scope="module")
def joined():
    """A head bent by 9 degrees, alone and with frames in which it is turned aside."""
    template = load_template()
    poses = [pose(0, 9, 0), pose(9, 9, 0), pose(-9, 9, 0)]
    images = [draw(template, template.vertices, one, CAMERA) for one in poses]
    alone = find_face(images[0], 1, template=template, camera=CAMERA)
    others = [(k, judge_frame(images[k - 1]).features, images[k - 1]) for k in (2, 3)]
    return poses, alone, join_views(alone, images[0], others, template=template)


def test_turning_tells_how_far_the_head_is_bent(joined):
    poses, alone, together = joined
    assert [view.frame for view in together.views] == [1, 2, 3]
    assert all(len(view.motion) > 20 for view in together.views[1:])
    error = angle_deg(together.head_pose, poses[0])
    assert error < max(4.0, angle_deg(alone.head_pose, poses[0]))
    turn = angle_deg(together.views[1].head_pose, together.views[2].head_pose)
    assert abs(turn - 18) < 4


def test_views_outlive_the_file_and_any_may_be_pinned(tmp_path, joined):
    together = joined[2]
    together.save(tmp_path / "fit.json")
    again = FaceFit.load(tmp_path / "fit.json")
    assert [len(v.motion) for v in again.views] == [len(v.motion) for v in together.views]
    pinned = refit(again, {"chin": (240.0, 300.0)}, 3)
    assert pinned.pins == {3: {"chin": (240.0, 300.0)}}
