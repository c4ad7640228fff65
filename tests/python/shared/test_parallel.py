# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of work at the same time: their results, their order, and what ends them."""

import gc
import threading
from contextlib import contextmanager

import pytest
from mimetic.shared.parallel import THREADS, both, in_turn, side_by_side


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


def test_two_go_on_at_the_same_time_and_come_in_turn():
    meeting = threading.Barrier(2, timeout=20)

    def items(letter, count):
        for i in range(count):
            if i < 2:
                meeting.wait()
            yield f"{letter}{i}"

    both_ways = side_by_side([items("a", 2), items("b", 4)])
    assert list(both_ways) == ["a0", "b0", "a1", "b1", "b2", "b3"]
    assert list(side_by_side([])) == []


def test_of_two_side_by_side_one_that_fails_ends_both():
    ended = []

    def items(is_sound):
        try:
            yield 1
            if not is_sound:
                raise ValueError("no face")
            yield 2
            yield 3
        finally:
            ended.append(is_sound)

    with pytest.raises(ValueError, match="no face"):
        list(side_by_side([items(True), items(False)]))
    assert sorted(ended) == [False, True]


def test_an_item_that_fails_ends_the_rest():
    begun = []

    def work(item):
        begun.append(item)
        if item == 2:
            raise ValueError("no face")

    with pytest.raises(ValueError, match="no face"):
        list(in_turn(work, range(100)))
    assert len(begun) < 6


@contextmanager
def _open_until_closed(open_now):
    open_now.append("film")
    try:
        yield range(100)
    finally:
        open_now.clear()


def _frames(open_now):
    with _open_until_closed(open_now) as frames:
        yield from frames


def _fail(item):
    raise ValueError("no face")


@pytest.mark.parametrize(
    "work",
    [
        lambda films: [*in_turn(_fail, films)],
        lambda films: both(lambda: next(films), lambda: _fail(0)),
        lambda films: both(lambda: [*in_turn(_fail, films)], lambda: 0),
    ],
)
def test_what_an_error_came_from_is_let_go_with_it(work):
    """Else a film goes on being decoded until Python ends, which it then cannot."""
    open_now: list[str] = []
    gc.disable()
    try:
        with pytest.raises(ValueError, match="no face"):
            work(_frames(open_now))
        assert not open_now
    finally:
        gc.enable()


def test_a_single_thread_is_kept_to(monkeypatch):
    monkeypatch.setenv("OPENCV_FOR_THREADS_NUM", "1")
    here = threading.get_ident()
    assert both(threading.get_ident, threading.get_ident) == (here, here)
    assert {ident for _, ident in in_turn(lambda _: threading.get_ident(), range(3))} == {here}
    alone = [(threading.get_ident() for _ in range(count)) for count in (2, 3)]
    assert list(side_by_side(alone)) == 5 * [here]
