# SPDX-License-Identifier: GPL-3.0-or-later
"""How far long work is, by what its stages cost: for an estimate of the time left.

Costs are in frames of the same footage that the face is followed through: rough, from clips of
400 x 300 and 640 x 360, but neither the machine nor the number of frames changes them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Progress = Callable[[float, str], bool]  # fraction, what is done -> go on?

JUDGED = 2.0  # a face found in a frame, and how much it is at rest
FITTED = 8.0  # a head fitted to a frame
ATTACHED = 40.0  # muscles attached to a head
MOST_FOLLOWED = 30  # frames, for a head's relief; with more of them, every second, third ...
# Frames judged in search of the face at rest, those of them fitted, and how many of these it is
# followed from through all of them
NUM_CANDIDATES, NUM_TRIED, NUM_VIEWS = 24, 5, 2
FOUND = NUM_CANDIDATES * (JUDGED + NUM_VIEWS) + (NUM_TRIED + 1) * FITTED + ATTACHED
SEARCHED = FOUND + MOST_FOLLOWED


@dataclass(frozen=True)
class Costs:
    """What a command does to a clip of N frames: `once` + N `each` to follow, and so on."""

    followed_once: float
    followed_each: float
    drawn_each: float
    written: float


def frame_text(frame: int, first: int, last: int) -> str:
    """Which of footage's frames work is at: first and last are those that it goes through."""
    return f"frame {frame} of {last}" if first == 1 else f"frame {frame} of {first} to {last}"


def check_goes_on(progress: Progress | None, fraction: float, text: str) -> None:
    """Reports progress of work that is of no use in part; raises KeyboardInterrupt when stopped."""
    if progress is not None and not progress(fraction, text):
        raise KeyboardInterrupt


def stages(progress: Progress | None, *costs: float) -> list[Progress]:
    """A progress for each stage of some work: takes its fraction, reports that of the whole.

    progress: of the whole; None shows nothing and never stops. costs: of the stages, in turn. What
    a stage that was left out would have cost is shared by those that follow: had the whole jumped
    over it, the time left would be told too short.
    """
    reached = [0.0]  # of the whole, as told last

    def stage(cost: float, later: float) -> Progress:
        begun: list[float] = []

        def tell(fraction: float, text: str) -> bool:
            if not begun:
                begun.append(reached[0])
            span = (1 - begun[0]) * cost / ((cost + later) or 1.0)
            reached[0] = begun[0] + span * min(max(fraction, 0.0), 1.0)
            return progress is None or progress(reached[0], text)

        return tell

    return [stage(cost, sum(costs[i + 1 :])) for i, cost in enumerate(costs)]
