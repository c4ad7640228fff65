# SPDX-License-Identifier: GPL-3.0-or-later
"""The filter on a rendered clip: first face, own head, loss, neutral."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.fit.fitting import find_face
from mimetic.fit.known_lens import KnownLens
from mimetic.media.footage import Footage
from mimetic.muscles.calibration import Calibration
from mimetic.puppet import live_filter
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_heads import STRANGER, lens_of_fit
from mimetic.template.face_template import load_template


@pytest.fixture(scope="module")
def images(rendered_clip):
    return [np.ascontiguousarray(image) for _, image in Footage(rendered_clip.footage).frames()]


def test_the_first_picture_gives_a_state_and_no_face_none(images):
    live = LiveFilter(in_background=False)
    assert live.advance(np.zeros_like(images[0]), 0.0) is None
    state = live.advance(images[0], 0.04)
    assert state.quality > 0.5 and not state.is_held
    assert state.values.shape == (len(live.names),) == state.std.shape
    assert not live.face.is_own


def test_the_persons_own_head_takes_over(images):
    live = LiveFilter(in_background=False)
    # A slow stream: two of its pictures are five seconds
    states = [live.advance(image, 0.45 * n) for n, image in enumerate(images[:16])]
    assert live.face.is_own
    assert min(state.quality for state in states) > 0.4


def test_a_head_that_may_be_replaced_is_never_settled_for_who_asks_meanwhile(images, monkeypatch):
    """The search's thread lets others run: a look kept then would be of a stranger's head."""
    live, seen = LiveFilter(in_background=False), []
    search = live_filter.PersonSearch

    class Watched(search):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            seen.append(live.is_settled)

        def stop(self):
            seen.append(live.is_settled)
            super().stop()

    monkeypatch.setattr(live_filter, "PersonSearch", Watched)
    for n, image in enumerate(images[:16]):
        live.advance(image, 0.45 * n)
    assert seen == [False, False] and live.is_settled


def test_a_known_lens_is_that_of_both_heads(images):
    live = LiveFilter(in_background=False, lens=KnownLens(50.0, 24.0))
    heads = []
    for n, image in enumerate(images[:16]):
        live.advance(image, 0.45 * n)
        heads += [live.face] if not heads or live.face is not heads[-1] else []
    assert [head.is_own for head in heads] == [False, True]
    width = images[0].shape[1]
    assert [head.camera.fx / width for head in heads] == pytest.approx([50 / 24, 50 / 24])


@pytest.fixture(scope="module")
def person(images):
    """The fit of an earlier capture, by another lens, which found out how far a muscle goes."""
    fit = find_face(images[0], camera=None)
    return replace(fit, calibration=Calibration(extent={"frontalis_medial.L": 1.5}))


def test_a_known_head_is_there_from_the_first_picture_on(images, person):
    live = LiveFilter(in_background=False, person=person)
    states = [live.advance(image, 0.45 * n) for n, image in enumerate(images[20:41])]
    assert live.face.is_own and live.is_settled and not live.remarks
    template = load_template()
    neutral = live.face.fit.neutral_vertices(template)
    np.testing.assert_array_equal(neutral, person.neutral_vertices(template))
    extent = dict(zip(live.face.anatomy.muscle_names, live.face.anatomy.extent, strict=True))
    assert extent["frontalis_medial.L"] == 1.5 and extent["frontalis_medial.R"] == 1
    assert min(state.quality for state in states) > 0.4
    first = LiveFilter(in_background=False, person=person)
    first.advance(images[20], 0.0)
    assert first.face.is_own and first.face.fit.identity == person.identity


def test_a_known_head_is_moved_by_set_neutral_and_not_replaced(images, person):
    live = LiveFilter(in_background=False, person=person)
    live.advance(images[0], 0.0)
    before = live.face
    live.set_neutral()
    live.advance(images[1], 0.1)
    assert live.face is not before and live.face.anatomy is before.anatomy


def test_another_face_is_followed_as_a_strangers(images, person):
    other = {name: value + 1.5 for name, value in person.identity.items()}
    live = LiveFilter(in_background=False, person=replace(person, identity=other))
    states = [live.advance(image, 0.45 * n) for n, image in enumerate(images[:21])]
    assert live.remarks == [STRANGER] and live.face.fit.identity != other
    assert min(state.quality for state in states) > 0.4 and live.face.is_own


def test_a_fits_lens_holds_for_other_sizes_of_the_picture(person):
    lens = lens_of_fit(person)
    focal, width = person.intrinsics[0, 0], person.image_size[0]
    assert lens.focal_mm / lens.sensor_mm == pytest.approx(focal / width)


def test_the_same_in_the_background(images):
    live = LiveFilter(in_background=True)
    import time

    for n, image in enumerate(images * 20):
        live.advance(image, 0.5 * n)
        if live.face.is_own:
            break
        time.sleep(0.1)
    live.stop()
    assert live.face.is_own


def test_a_face_that_goes_away_is_held_and_found_again(images):
    live = LiveFilter(in_background=False)
    for n in range(5):
        live.advance(images[n], n / 25)
    away = np.full_like(images[0], 90)
    assert all(live.advance(away, (5 + n) / 25).is_held for n in range(6))
    assert not live.advance(images[5], 11 / 25).is_held


def test_another_view_is_begun_anew(images):
    live = LiveFilter(stillness=1, in_background=False)
    live.advance(images[0], 0.0)
    live.start_over()
    small = np.ascontiguousarray(images[0][:200, 20:300])
    state = live.advance(small, 0.1)
    assert state.quality > 0.5
    anew = LiveFilter(stillness=1, in_background=False).advance(small, 0.0)
    np.testing.assert_allclose(state.head_pose, anew.head_pose, atol=1e-9)
    np.testing.assert_allclose(state.values, anew.values, atol=1e-9)


def test_neutral_is_what_the_face_does_now(images):
    live = LiveFilter(stillness=0, in_background=False)
    live.advance(images[0], 0.0)
    before = [live.advance(image, 0.04 * (n + 1)) for n, image in enumerate(images[1:26])][-1]
    live.set_neutral()
    live.advance(images[25], 1.2)
    after = live.advance(images[25], 1.24)
    assert np.abs(before.values[:36]).sum() > 0.3  # the brows are up there
    assert np.abs(after.values[:36]).sum() < 0.3 * np.abs(before.values[:36]).sum()


def test_stillness_is_a_share():
    with pytest.raises(InvalidInput, match="stillness"):
        LiveFilter(stillness=2)


def test_a_state_is_small_enough_for_hours_of_them(images):
    import gc
    import sys

    live = LiveFilter(in_background=False)
    state = live.advance(images[0], 0.0)
    arrays = [value for value in vars(state).values() if isinstance(value, np.ndarray)]
    assert all(array.base is None for array in arrays)  # nor do they hold anything larger
    assert sum(array.nbytes for array in arrays) < 2000
    others = [v for v in vars(state).values() if not isinstance(v, np.ndarray)]
    assert all(sys.getsizeof(value) < 100 and not gc.is_tracked(value) for value in others)
