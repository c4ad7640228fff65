# SPDX-License-Identifier: GPL-3.0-or-later
"""Who says what, where lips meet in it, and which eyes shut when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..expressions.recipes import any_camera
from ..motion import HeadMotion
from ..recipes import Recipe

FPS = 30
AT_REST = 0.6  # seconds, first
NUM_SYLLABLES, BREATH = 8, 0.15  # seconds after them
LID_SLOT, NUM_FRAMES = 0.55, 174  # seconds from one motion of the lids to the next
# The face units in the middle of a vowel
VOWELS: dict[str, dict[str, float]] = {
    "a": {"jawOpen": 0.42, "mouthLowerDown": 0.2},
    "e": {"jawOpen": 0.22, "mouthStretch": 0.45, "mouthUpperUp": 0.15},
    "i": {"jawOpen": 0.12, "mouthSmile": 0.3, "mouthStretch": 0.3},
    "o": {"jawOpen": 0.26, "mouthFunnel": 0.5},
    "u": {"jawOpen": 0.14, "mouthPucker": 0.55},
}
# The face units where lips meet, and how long these last beside the vowels
CONSONANTS: dict[str, dict[str, float]] = {
    "b": {"mouthPress": 0.25},
    "m": {"mouthPress": 0.35, "mouthRollUpper": 0.15, "mouthRollLower": 0.2},
    "p": {"mouthPress": 0.6},
}
PAIRED = ("mouthLowerDown", "mouthStretch", "mouthUpperUp", "mouthSmile", "mouthPress", "eyeBlink")
SHUT = 0.73  # of eyeBlink: the canonical head's lids meet there; beyond, they pass each other
# What the lids do, one after the other: share of the way to shut lids, left and right
LIDS = {"wink left": (1, 0), "wink right": (0, 1), "blink": (1, 1), "half a blink": (0.5, 0.5)}
HEADS = {
    "still": HeadMotion(0.4, 0.3, 0.2, 0.0006, 0.001),
    "moving": HeadMotion(),
    "turning": HeadMotion(yaw=18, pitch=8, roll=6, sideways=0.018, nearer=0.04),
}


@dataclass(frozen=True)
class Pulse:
    """A control that rises and falls as half of a sine squared; seconds."""

    control: str
    amplitude: float
    start: float
    end: float

    def values(self, times: np.ndarray) -> np.ndarray:
        share = np.clip((times - self.start) / (self.end - self.start), 0, 1)
        return self.amplitude * np.sin(np.pi * share) ** 2


@dataclass(frozen=True)
class SpeechClip:
    """One clip. words: a consonant and a vowel a syllable; lids: name, first and last second."""

    recipe: Recipe
    head: str
    words: str
    lids: tuple[tuple[str, float, float], ...]


def speech_clip(seed: int, name: str, head: str, is_large: bool) -> SpeechClip:
    rng = np.random.default_rng([seed, 83])
    phases: list[Pulse] = []
    words, start = "", AT_REST
    for _ in range(NUM_SYLLABLES):
        consonant, vowel = rng.choice(list(CONSONANTS)), rng.choice(list(VOWELS))
        closure, opening = rng.uniform(0.07, 0.12), rng.uniform(0.17, 0.26)
        strength = rng.uniform(0.75, 1.1)
        # Lips begin to press before they are shut, and are still at it when they open
        early = 0.04
        phases += _pulses(CONSONANTS[consonant], 1.0, start - early, start + closure + early)
        phases += _pulses(VOWELS[vowel], strength, start + closure, start + closure + opening)
        words += f"{consonant}{vowel}"
        start += closure + opening
    start += BREATH
    lids = []
    for what, (left, right) in LIDS.items():
        long = rng.uniform(0.25, 0.4)
        for side, share in (("Left", left), ("Right", right)):
            if share:
                phases.append(Pulse(f"eyeBlink{side}", SHUT * share, start, start + long))
        lids.append((what, float(start), float(start + long)))
        start += LID_SLOT
    size = {"image_size": (480, 360), "face_width_px": 180.0} if is_large else {}
    recipe = Recipe(
        name=name,
        kind="units",
        seed=seed,
        num_frames=NUM_FRAMES,
        phases=tuple(phases),
        head_motion=HEADS[head],
        fps=FPS,
        **size,
        **any_camera(rng),
    )
    return SpeechClip(recipe, head, words, tuple(lids))


def _pulses(shape: dict[str, float], strength: float, start: float, end: float) -> list[Pulse]:
    return [
        Pulse(f"{control}{side}", strength * amplitude, start, end)
        for control, amplitude in shape.items()
        for side in (("Left", "Right") if control in PAIRED else ("",))
    ]


def _clips(first_seed: int, count: int, prefix: str) -> tuple[SpeechClip, ...]:
    return tuple(
        speech_clip(first_seed + i, f"{prefix}-{i:02d}", list(HEADS)[i % 3], i % 2 == 1)
        for i in range(count)
    )


# People of no other set: gaze has those from 880 and 900 on
SETS = {
    "held-out": _clips(920, 6, "speech"),
    "tuning": _clips(940, 6, "speech-tuning"),
    "small": _clips(940, 1, "speech-tuning"),
}
