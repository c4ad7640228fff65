# SPDX-License-Identifier: GPL-3.0-or-later
import threading
from types import SimpleNamespace

import numpy as np
from mimetic.puppet.live_session import LiveSession
from mimetic.puppet.pictures import NewestPicture, Picture


def picture(number, is_new_view=False):
    return Picture(np.full((2, 2, 3), number, np.uint8), float(number), float(number), is_new_view)


def test_who_is_late_gets_the_newest_and_no_queue():
    pictures = NewestPicture()
    for number in range(5):
        pictures.put(picture(number))
    assert pictures.take(0).time == 4 and pictures.take(0) is None
    assert pictures.num_put == 5 and pictures.num_skipped == 4


def test_a_new_view_is_not_lost_with_the_picture_that_said_so():
    pictures = NewestPicture()
    pictures.put(picture(0, is_new_view=True))
    pictures.put(picture(1))
    assert pictures.take(0).is_new_view


def test_waiting_skips_none():
    pictures = NewestPicture()

    def feed():
        for number in range(50):
            pictures.put(picture(number), waits=True)

    thread = threading.Thread(target=feed, daemon=True)
    thread.start()
    times = [pictures.take(5).time for _ in range(49)]
    pictures.close()
    thread.join(5)
    assert times == list(range(49)) and pictures.num_skipped == 0


def test_the_last_picture_is_worked_on_though_it_came_as_a_wait_ended():
    class LateAndClosed(NewestPicture):
        waits = 0

        def take(self, timeout):
            self.waits += 1
            if self.waits > 1:
                return super().take(timeout)
            self.put(picture(7))
            self.close()
            return None  # as if the wait had ended just before

    times = []
    source = SimpleNamespace(feed=lambda _pictures, events: events.wait(5))
    live = SimpleNamespace(
        advance=lambda _image, time: times.append(time), stop=lambda: None, remarks=[]
    )
    session = LiveSession(source, live, lambda _picture, _state: True, print)
    session._pictures = LateAndClosed()
    session.run()
    assert times == [7.0]
