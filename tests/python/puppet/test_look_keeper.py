# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks kept one by one while a rendered clip stands in for a camera."""

import pytest
from clips import make_clip
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_thread import LiveThread
from mimetic.puppet.look_keeper import LookKeeper
from mimetic.puppet.pictures import Picture
from mimetic.puppet.taught_look import Look
from mimetic.puppet.usual_looks import ASKED_FOR, USUAL_LOOKS
from mimetic.score.truth import Truth

FPS, SETTLED = 25, 110  # pictures until the person's head is known
ORDER = [*range(50), *range(48, 0, -1)]


def even(frame):
    return (frame - 1) / FPS


class Sitting:
    def __init__(self, footage, keeper):
        self.images = [image.copy() for _, image in Footage(footage).frames()]
        self.live, self.keeper, self.lines = LiveFilter(0.0, in_background=False), keeper, []
        self.number = 0
        keeper.begin(self.live, self.lines.append)

    def show(self, num_pictures, is_seen=True):
        for _ in range(num_pictures):
            image, time = self.images[ORDER[self.number % len(ORDER)]], self.number / FPS
            state = self.live.advance(image, time)
            self.keeper.see(Picture(image, time, 0.0), state if is_seen else None, even)
            self.number += 1


@pytest.fixture(scope="module")
def widest(rendered_clip):
    """The frame in which the mouth is widest open, from 0."""
    truth = Truth.load(rendered_clip.truth)
    return int(truth.unit_values[:, truth.units.index("jawOpen")].argmax())


def test_looks_are_kept_in_any_order_and_anew(rendered_clip, widest):
    keeper = LookKeeper()
    sitting = Sitting(rendered_clip.footage, keeper)
    sitting.show(3)
    keeper.ask(Look("too soon", 0))
    sitting.show(SETTLED - 3)
    assert keeper.kept == [] and "not known yet" in sitting.lines[-1]
    with pytest.raises(InvalidInput, match="no look was kept"):
        keeper.taught()
    # Of the next round: frames of the clip that is played, from 1
    start = len(ORDER) * (1 + SETTLED // len(ORDER))
    keeper.ask(Look("open", 1 + start + widest))
    keeper.ask(Look("neutral", 1 + start + len(ORDER)))
    keeper.ask(Look("past", 5))
    sitting.show(start + len(ORDER) + 20 - sitting.number)
    assert keeper.kept == ["open", "neutral"] and keeper.keeping == ""
    assert any("past: frame 5 is past" in line for line in sitting.lines)
    taught = keeper.taught()
    jaw = taught.look_values[:, taught.channels.index("jaw_open")]
    assert taught.looks == ["open", "neutral"] and taught.neutral == 1
    assert jaw[1] < 0.1 and jaw[0] > jaw[1] + 0.15
    keeper.ask(Look("open", 0, values={"jaw_open": 0.9}))
    sitting.show(20)
    again = keeper.taught()
    assert again.looks == ["open", "neutral"]
    assert again.look_values[0, again.channels.index("jaw_open")] == 0.9
    assert (again.example_looks >= 0).all()  # others would contradict it


def test_a_set_needs_the_face_at_rest(rendered_clip):
    keeper = LookKeeper()
    sitting = Sitting(rendered_clip.footage, keeper)
    sitting.show(SETTLED)
    keeper.ask(Look("one", 0))
    keeper.ask(Look("two", 0))
    sitting.show(1)
    assert keeper.keeping == "one"
    sitting.show(30)
    assert keeper.kept == ["one", "two"]
    with pytest.raises(InvalidInput, match="neutral, the face at rest, was not kept"):
        keeper.taught()


def test_a_look_is_waited_for_while_the_face_is_not_seen(rendered_clip):
    keeper = LookKeeper()
    sitting = Sitting(rendered_clip.footage, keeper)
    sitting.show(SETTLED)
    keeper.ask(Look("neutral", 0))
    sitting.show(FPS, is_seen=False)
    assert keeper.keeping == "neutral"
    sitting.show(4)
    assert keeper.kept == ["neutral"]
    keeper.ask(Look("hidden", 0))
    sitting.show(2 * FPS + 2, is_seen=False)
    assert keeper.keeping == "" and keeper.kept == ["neutral"]
    assert "not seen well" in sitting.lines[-1]
    keeper.ask(Look("last", 0))
    sitting.show(5)
    assert keeper.keeping == "last"
    keeper.end()  # with half of its pictures
    assert keeper.kept == ["neutral", "last"] and keeper.keeping == ""
    keeper.ask(Look("waiting", 0))
    keeper.end()
    assert sitting.lines[-1] == "waiting: the session ended before it was kept"


def test_a_frame_is_waited_for_until_the_clip_shows_it():
    lines, keeper = [], LookKeeper()
    keeper.begin(LiveFilter(in_background=False), lines.append)
    keeper.ask(Look("late", 3))
    keeper.see(Picture(None, 1.0, 0.0), None, lambda frame: 3.0 * frame)
    assert lines == []
    keeper.see(Picture(None, 9.0, 0.0), None, lambda frame: 3.0 * frame)
    assert len(lines) == 1 and "not known yet" in lines[0]


def test_a_look_beyond_the_clips_end_is_told(tmp_path):
    source = ClipSource(make_clip(tmp_path / "no_face.mp4", size="320x240"), is_paced=False)
    keeper = LookKeeper()
    keeper.ask(Look("wink", 99))
    thread = LiveThread(source, 0.5, is_blocking=True, keeper=keeper)
    thread.start()
    assert thread.error is None
    assert thread.told[-1] == "wink: the session ended before frame 99 was kept"


def test_a_set_of_a_clip_is_not_taught_again_by_a_camera():
    from sample_taught import make_taught

    with pytest.raises(InvalidInput, match="taught from a clip"):
        LookKeeper(make_taught()).begin(LiveFilter(in_background=False), print)


def test_usual_looks_begin_at_rest_and_are_those_that_are_asked_for():
    assert next(iter(USUAL_LOOKS)) == "neutral" == ASKED_FOR[0]
    assert set(ASKED_FOR) <= set(USUAL_LOOKS)
