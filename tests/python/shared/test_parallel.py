# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of work at the same time: their results, their order, and what ends them."""

import threading

import pytest
from mimetic.shared.parallel import THREADS, both, in_turn


def test_two_works_meet_while_both_run():
    meeting = threading.Barrier(2, timeout=20)
    assert both(lambda: (meeting.wait(), "a")[1], lambda: (meeting.wait(), "b")[1]) == ("a", "b")


@pytest.mark.parametrize("failing", [0, 1])
def test_what_one_of_two_raises_comes_after_the_other_has_ended(failing):
    ended = []

    def work(number):
        if number == failing:
            raise OSError(28, "full")
        ended.append(number)

    with pytest.raises(OSError, match="full"):
        both(lambda: work(0), lambda: work(1))
    assert ended == [1 - failing]


def test_results_come_in_the_items_order():
    second_is_done = threading.Event()

    def slow_first(item):
        if item == 0:
            assert second_is_done.wait(20)
        second_is_done.set()
        return 10 * item

    assert list(in_turn(slow_first, range(5))) == [(i, 10 * i) for i in range(5)]


def test_no_more_items_are_held_than_there_are_threads():
    held = most = 0

    def items():
        nonlocal held, most
        for i in range(20):
            held += 1
            most = max(most, held)
            yield i

    for _ in in_turn(lambda item: item, items()):
        held -= 1
    assert most <= THREADS


def test_an_item_that_fails_ends_the_rest():
    begun = []

    def work(item):
        begun.append(item)
        if item == 2:
            raise ValueError("no face")

    with pytest.raises(ValueError, match="no face"):
        list(in_turn(work, range(100)))
    assert len(begun) < 6


def test_a_single_thread_is_kept_to(monkeypatch):
    monkeypatch.setenv("OPENCV_FOR_THREADS_NUM", "1")
    here = threading.get_ident()
    assert both(threading.get_ident, threading.get_ident) == (here, here)
    assert {ident for _, ident in in_turn(lambda _: threading.get_ident(), range(3))} == {here}
