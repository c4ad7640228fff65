# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the window's time a job's news takes."""

import os
import sys

import pytest

TICK = 0.02
SECONDS = 60.0


@pytest.fixture
def shown(extension):
    """Times at which a job with news at every event shows them, in a window that then needs some
    drawings of so many seconds, and others at every event."""

    def shown(*drawings: float, others: float = 0.0) -> list[float]:
        now, times, left = 0.0, [], []
        pace = extension("pace").Pace(TICK, lambda: now)
        while now < SECONDS:
            if pace.is_due():
                times.append(now)
                pace.has_shown()
                left = list(drawings)
            now += max(TICK, left.pop(0) if left else others)
        return times

    return shown


def test_a_window_that_is_drawn_in_time_shows_all(shown):
    assert len(shown(0.5 * TICK)) == pytest.approx(SECONDS / TICK, abs=2)


@pytest.mark.parametrize("drawings", ((0.05,), (0.15,), (0.4,), (0.1, *[0.04] * 8)))
def test_drawing_takes_a_quarter_of_a_slow_windows_time(shown, drawings):
    times = shown(*drawings)
    assert len(times) * sum(drawings) / SECONDS == pytest.approx(0.25, abs=0.03)


def test_news_come_however_slow_the_window_is(shown):
    assert len(shown(1.0)) == pytest.approx(SECONDS / 2, rel=0.1)


def test_what_others_have_drawn_counts(shown):
    alone, beside = shown(0.1), shown(0.1, others=0.05)
    assert len(beside) < len(alone) / 3
    assert len(beside) == pytest.approx(SECONDS / 2, rel=0.1)


def test_whoever_works_in_a_slow_window_goes_first(extension):
    now = 0.0
    pace = extension("pace").Pace(TICK, lambda: now)

    def num_shown(seconds: float, drawing: float, is_used: bool) -> int:
        nonlocal now
        end, shown = now + seconds, 0
        while now < end:
            if is_used:
                pace.has_input()
            if pace.is_due():
                pace.has_shown()
                shown += 1
            now += max(drawing, TICK)
        return shown

    assert num_shown(10, 0.01, is_used=True) > 400  # a quick one shows it all
    assert num_shown(10, 0.05, is_used=True) <= 1
    assert num_shown(10, 0.05, is_used=False) >= 4


@pytest.mark.skipif(sys.platform != "linux", reason="threads have no nice value of their own")
def test_a_job_lets_the_window_go_first(extension):
    def own() -> int:
        return os.getpriority(os.PRIO_PROCESS, 0)  # of the thread that asks

    before = own()
    job_run = extension("job_run")
    run = job_run.Run("Capture")
    run.start(lambda _inputs, _progress: own(), None)
    run.thread.join()
    assert run.is_done() and run.error is None
    assert run.result == min(before + job_run.GIVES_WAY, 19)
    assert own() == before
