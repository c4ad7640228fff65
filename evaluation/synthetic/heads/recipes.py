# SPDX-License-Identifier: GPL-3.0-or-later
"""What is rendered (films) and how each film is shown (clips). Tuning and held-out share nothing:
neither people nor their paint, neither real motion nor sweeps."""

from __future__ import annotations

from dataclasses import dataclass

from ..motion import Phase
from ..recipes import Recipe, _blink, _smile, _surprise
from .courses import RealCourse, Sweeps

FPS = 30
FACE_WIDTH = 95.0  # pixels


@dataclass(frozen=True)
class HeadClip:
    """One way to show a film. `kind` is what the evaluation groups clips by."""

    name: str
    kind: str
    film: Recipe
    step: int = 1  # every step-th frame alone
    crf: int = 20  # H.264 constant rate factor
    hand: bool = False  # a hand passes before the face
    num_frames: int | None = None  # played to and fro until there are as many
    noise_sd: float = 2.5  # grey levels


def _film(name: str, seed: int, num_frames: int, course, phases=(), **changes) -> Recipe:
    return Recipe(
        name=f"head-{name}",
        kind="units" if phases else "still",
        seed=seed,
        num_frames=num_frames,
        phases=tuple(phases),
        head_motion=course,
        face_width_px=FACE_WIDTH,
        fps=FPS,
        **changes,
    )


def _swept(name: str, seed: int, *swings: tuple[str, float, float]) -> Recipe:
    course = Sweeps(swings)
    return _film(name, seed, round(course.seconds * FPS), course)


WORDS = (
    *_smile(0.4),
    Phase("jawOpen", 0.7, 1.1, rise=0.2, hold=0.3),
    *_surprise(1.5),
    *_blink(2.3),
)
SMALL = (HeadClip("small", "sweep", _swept("small", 701, ("yaw", 20.0, 0.8))),)


def _tuning() -> tuple[HeadClip, ...]:
    real = _film("tuning-real", 60, 120, RealCourse("franck.csv"))
    swept = _swept("tuning-sweeps", 61, ("roll", -40, 1.4), ("yaw", -60, 3.2), ("pitch", -35, 1.6))
    mimed = _film("tuning-mimed", 62, 75, RealCourse("franck.csv", 1.5), WORDS[::-1])
    still = _film("tuning-still", 62, 1, Sweeps(()))
    return (
        HeadClip("tuning-real", "real", real),
        HeadClip("tuning-real-third", "third", real, step=3),
        HeadClip("tuning-hand", "hand", real, hand=True),
        HeadClip("tuning-sweeps", "sweep", swept),
        HeadClip("tuning-sweeps-third", "third", swept, step=3),
        HeadClip("tuning-mimed", "expressions", mimed),
        HeadClip("tuning-still", "still", still, num_frames=60),
    )


def _held_out() -> tuple[HeadClip, ...]:
    real = _film("real", 110, 300, RealCourse("cap12.csv"))
    swept = _swept("sweeps", 111, ("yaw", 60, 3.2), ("pitch", 40, 2.0), ("roll", 45, 2.0))
    fast = _swept("fast", 111, ("yaw", 35, 0.7), ("pitch", 20, 0.6), ("yaw", -35, 0.7))
    light = _film("light", 110, 45, RealCourse("cap12.csv", 2.0), light_swing=0.85)
    mimed = _film("mimed", 112, 80, RealCourse("cap12.csv", 1.5), WORDS)
    still = _film("still", 112, 1, Sweeps(()))
    return (
        HeadClip("real", "real", real),
        HeadClip("real-second", "second", real, step=2),
        HeadClip("real-third", "third", real, step=3),
        HeadClip("real-long", "long", real, num_frames=1000),
        HeadClip("compressed", "compression", real, crf=36),
        HeadClip("hand", "hand", real, hand=True),
        HeadClip("sweeps", "sweep", swept),
        HeadClip("sweeps-second", "second", swept, step=2),
        HeadClip("sweeps-third", "third", swept, step=3),
        HeadClip("fast", "speed", fast),
        HeadClip("light", "light", light),
        HeadClip("mimed", "expressions", mimed),
        HeadClip("still", "still", still, num_frames=60),
    )


SETS = {"held-out": _held_out(), "tuning": _tuning(), "small": SMALL}
