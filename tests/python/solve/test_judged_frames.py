# SPDX-License-Identifier: GPL-3.0-or-later
"""Which frames count as a clip's rest is looked for: those of the face that was named, bare."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic import _core
from mimetic.fit.fitting import NoFace, judge_frame
from mimetic.media.footage import Footage
from mimetic.solve import find_face as find_face_module
from mimetic.solve import judged_frames as module
from mimetic.solve.clip_capture import find_face
from mimetic.solve.judged_frames import judged_frames, widths_away

FRAMES = {1, 8, 15}


@pytest.fixture(scope="module")
def footage(rendered_clip):
    return Footage(rendered_clip.footage)


@pytest.fixture(scope="module")
def box(footage):
    return judge_frame(footage.read(1)).features.box


def face_at(x, width=40.0):
    """A face whose middle is at (x, 100)."""
    box = np.array([x - width / 2, 100 - width / 2, width, width])
    return _core.FaceFeatures([], [], box, 1.0)


def persons(places, near=None, asked=None):
    """Which frames stay; places: by frame the middles of faces, first of the one that is judged."""
    judgements = {
        frame: SimpleNamespace(features=face_at(*faces[0]), faces=[face_at(*f) for f in faces])
        for frame, faces in places.items()
    }
    return set(module._of_one_person(judgements, near, asked))


def test_a_place_is_so_many_widths_away_from_a_face():
    assert widths_away(face_at(50), (50, 100)) == 0
    assert widths_away(face_at(50, 20), (50, 150)) == 2.5


def test_one_person_alone_may_be_anywhere():
    assert persons({1: [(50,)], 5: [(300,)], 9: [(60,)]}) == {1, 5, 9}


def test_where_the_largest_of_two_is_not_found_the_other_does_not_stand_for_it():
    two = [(200, 50), (90, 40)]
    assert persons({1: two, 5: [(90, 40)], 9: [(230, 49), (95, 40)]}) == {1, 9}
    # one who walks through the picture stays the same
    walk = {1: two, 2: [(260, 50)], 3: [(340, 50), (90, 40)], 4: [(420, 50)], 5: [(90, 40)]}
    assert persons(walk) == {1, 2, 3, 4}


def test_the_face_at_a_place_is_followed_from_the_frame_in_which_it_is_there():
    walk = {1: [(50,)], 2: [(120,)], 3: [(190,)], 4: [(400,)], 5: [(250,)]}
    assert persons(walk, near=(190, 110)) == {1, 2, 3, 5}
    assert persons(walk, near=(600, 100)) == set()
    assert persons(walk, near=(600, 100), asked=4) == {4}
    assert persons({}, near=(1, 1)) == set()


def test_another_persons_face_is_not_taken_for_the_one_that_was_named(footage, box, monkeypatch):
    """Of two people one is hardly ever found: the other one's rest must not stand for hers."""
    for one in (find_face_module, module):
        monkeypatch.setattr(one, "NEAR_ENOUGH", 0.5)  # the face fills the picture
    x, y = box[:2] + box[2:] / 2
    place = (x - 0.6 * box[2], y)
    with pytest.raises(NoFace, match=rf"no frontal face found in .* near \({place[0]:.0f}, "):
        find_face(footage.path, frames=(1, 15), near=place)
    with pytest.raises(NoFace, match=r"found near .* in frame 8, which is to show rest"):
        find_face(footage.path, frame=8, frames=(1, 15), near=place)


def test_a_frame_that_is_asked_for_counts_whatever_is_before_it(footage, monkeypatch):
    hidden = {8: 0.4}
    shares = np.array([hidden.get(frame, 0.0) for frame in sorted(FRAMES)])

    class Core:
        def __getattr__(self, name):
            return getattr(_core, name)

        def passing_shares(self, covers):
            return shares[: len(covers)]

    monkeypatch.setattr(module, "_core", Core())
    found = judged_frames(footage, FRAMES, lambda *_: True, None)
    assert found.clear.keys() == {1, 15} and found.covered == {8}
    asked = judged_frames(footage, FRAMES, lambda *_: True, None, 8)
    assert asked.clear.keys() == FRAMES and not asked.covered
