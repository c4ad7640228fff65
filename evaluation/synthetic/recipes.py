# SPDX-License-Identifier: GPL-3.0-or-later
"""The clips: who, which expressions, how filmed. Tuning people and held-out people never meet."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from .motion import HeadMotion, Phase


@dataclass(frozen=True)
class Recipe:
    """One clip. `kind` is what moves the face: `units`, other people's `muscles`, or `still`."""

    name: str
    kind: str
    seed: int
    num_frames: int
    phases: tuple[Phase, ...] = ()
    head_motion: HeadMotion = field(default_factory=HeadMotion)
    image_size: tuple[int, int] = (320, 240)
    fps: int = 30
    face_width_px: float = 115.0
    focal_ratio: float = 1.25  # focal length over image width
    light_swing: float = 0.12  # relative change of the key light
    noise_sd: float = 2.5  # grey levels
    blur_px: float = 0.5
    crf: int = 20  # H.264 constant rate factor


def _both(control: str, *args: float, skew: float = 1.0, **kwargs: float) -> tuple[Phase, ...]:
    """The same phase on both sides, the right one scaled by `skew`: no face is symmetric."""
    amplitude, *rest = args
    left = Phase(f"{control}Left", amplitude, *rest, **kwargs)
    return left, Phase(f"{control}Right", skew * amplitude, *rest, **kwargs)


def _pair(control: str, *args: float, skew: float = 1.0, **kwargs: float) -> tuple[Phase, ...]:
    amplitude, *rest = args
    left = Phase(f"{control}.L", amplitude, *rest, **kwargs)
    return left, Phase(f"{control}.R", skew * amplitude, *rest, **kwargs)


def _surprise(start: float) -> tuple[Phase, ...]:
    return (
        Phase("browInnerUp", 0.9, start),
        *_both("browOuterUp", 0.8, start, skew=0.9),
        Phase("jawOpen", 0.45, start + 0.1),
        *_both("eyeWide", 0.6, start),
    )


def _smile(start: float) -> tuple[Phase, ...]:
    return (
        *_both("mouthSmile", 0.75, start, skew=0.9),
        *_both("cheekSquint", 0.6, start + 0.1),
    )


def _anger(start: float) -> tuple[Phase, ...]:
    return (
        *_both("browDown", 0.9, start, skew=0.95),
        *_both("mouthFrown", 0.7, start),
        Phase("mouthShrugLower", 0.6, start),
    )


def _blink(start: float) -> tuple[Phase, ...]:
    return _both("eyeBlink", 0.95, start, rise=0.1, hold=0.03, release=0.05, relaxation=0.06)


MUSCLE_PHASES = (
    *_pair("frontalis_medial", 0.7, 0.3),
    *_pair("frontalis_middle", 0.6, 0.3, skew=0.85),
    *_pair("frontalis_lateral", 0.5, 0.3),
    *_pair("zygomaticus_major", 0.7, 1.2, skew=0.9),
    *_pair("zygomaticus_minor", 0.3, 1.2),
    *_pair("orbicularis_oculi_inferior", 0.5, 1.3),
    *_pair("corrugator_supercilii", 0.6, 2.2),
    *_pair("depressor_anguli_oris", 0.5, 2.2, skew=0.9),
    Phase("jaw_open", 0.35, 2.9, rise=0.25, hold=0.15),
)


def _after(seconds: float, phases: tuple[Phase, ...]) -> tuple[Phase, ...]:
    """The same phases, after a rest: an actor is asked to begin with a neutral face."""
    return tuple(replace(phase, start=phase.start + seconds) for phase in phases)


REST = 0.7
STILL_HEAD = HeadMotion(yaw=0.4, pitch=0.3, roll=0.2, sideways=0.0006, nearer=0.001)

TEST = Recipe(
    name="test",
    kind="units",
    seed=1,
    num_frames=50,
    phases=(
        Phase("browInnerUp", 0.9, 0.6, rise=0.2, hold=0.15),
        *_both("browOuterUp", 0.8, 0.6, rise=0.2, hold=0.15),
        Phase("jawOpen", 0.45, 1.0, rise=0.25, hold=0.2),
    ),
    head_motion=HeadMotion(yaw=5, pitch=2, roll=2, sideways=0.004, nearer=0.01),
)
DEMO = Recipe(
    name="demo",
    kind="units",
    seed=2,
    num_frames=150,
    phases=(*_surprise(0.5), *_blink(1.7), *_smile(2.1), Phase("jawOpen", 0.6, 3.4), *_blink(4.4)),
    head_motion=HeadMotion(yaw=14, pitch=5, roll=4, sideways=0.012, nearer=0.03),
    image_size=(400, 300),
    face_width_px=130.0,
)
TUNING = (
    Recipe(
        "tuning-units",
        "units",
        10,
        130,
        _after(REST, (*_surprise(0.3), *_blink(1.35), *_smile(1.6), *_anger(2.6))),
    ),
    Recipe("tuning-muscles", "muscles", 11, 130, _after(REST, MUSCLE_PHASES)),
    Recipe("tuning-still", "still", 12, 45, head_motion=STILL_HEAD),
)
HELD_OUT = (
    Recipe(
        "held-out-units",
        "units",
        100,
        130,
        _after(REST, (*_smile(0.3), *_blink(1.35), *_anger(1.6), *_surprise(2.6))),
    ),
    Recipe("held-out-muscles", "muscles", 101, 130, _after(REST, MUSCLE_PHASES)),
    Recipe("held-out-still", "still", 102, 45, head_motion=STILL_HEAD),
)
SETS = {"held-out": HELD_OUT, "tuning": TUNING, "small": (TEST, DEMO)}
ALL = {recipe.name: recipe for recipes in SETS.values() for recipe in recipes}
