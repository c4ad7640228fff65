# SPDX-License-Identifier: GPL-3.0-or-later
"""Who shows which expressions, and how each is filmed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..motion import HeadMotion, Phase
from ..recipes import Recipe

FPS = 30
REST, SLOT, TAIL = 0.8, 0.7, 0.1  # seconds: at rest, an expression, after the last
NUM_FRAMES = round((REST + 3 * SLOT + TAIL) * FPS)
LEFT_RIGHT = {"units": ("Left", "Right"), "muscles": (".L", ".R")}
SHARED = ("browInnerUp", "jawOpen", "mouthRollUpper", "mouthRollLower", "mouthFunnel")
SHARED += ("mouthShrugLower", "mouthPucker", "cheekPuff", "jaw_open")
# How the head moves, by name; degrees and metres.
HEADS = {
    "frontal": HeadMotion(yaw=3, pitch=1.5, roll=1.5, sideways=0.003, nearer=0.008),
    "moving": HeadMotion(),
    "turning": HeadMotion(yaw=18, pitch=8, roll=6, sideways=0.018, nearer=0.04),
    "swung": HeadMotion(yaw=30, pitch=10, roll=8, sideways=0.018, nearer=0.04),
}
CHOSEN = ("frontal", "moving", "turning")  # every third take each; `swung` has a set of its own
# Parts of an expression: control, amplitude, seconds after it begins.
Part = tuple[str, float, float]
UNITS: dict[str, tuple[Part, ...]] = {
    "brow raise": (("browInnerUp", 0.9, 0), ("browOuterUp", 0.8, 0)),
    "brow lower": (("browDown", 0.95, 0),),
    "lip tighten": (
        ("mouthPress", 0.9, 0),
        ("mouthRollUpper", 0.4, 0.02),
        ("mouthRollLower", 0.4, 0.02),
    ),
    "smile": (("mouthSmile", 0.8, 0), ("cheekSquint", 0.6, 0.1)),
    "frown": (("mouthFrown", 0.85, 0), ("mouthShrugLower", 0.5, 0.05)),
    "surprise": (
        ("browInnerUp", 0.9, 0),
        ("browOuterUp", 0.8, 0),
        ("eyeWide", 0.6, 0),
        ("jawOpen", 0.45, 0.08),
    ),
    "anger": (
        ("browDown", 0.9, 0),
        ("eyeSquint", 0.5, 0.03),
        ("mouthPress", 0.6, 0.07),
        ("noseSneer", 0.3, 0.03),
    ),
    "disgust": (
        ("noseSneer", 0.9, 0),
        ("mouthUpperUp", 0.6, 0.05),
        ("browDown", 0.4, 0),
        ("mouthFrown", 0.3, 0.08),
    ),
    "speech": (
        ("jawOpen", 0.4, 0),
        ("mouthFunnel", 0.6, 0.14),
        ("mouthPucker", 0.5, 0.2),
        ("jawOpen", 0.2, 0.2),
        ("mouthPress", 0.5, 0.34),
    ),
    "cheeks filled": (("cheekPuff", 0.9, 0),),
    "pucker": (("mouthPucker", 0.9, 0),),
    "lips rolled in": (("mouthRollUpper", 0.9, 0), ("mouthRollLower", 0.9, 0)),
}
# The same by muscles, after the action units of `evaluation.anatomy.unit_muscles.EXPRESSIONS`.
MUSCLES: dict[str, tuple[Part, ...]] = {
    "brow raise": (
        ("frontalis_medial", 0.9, 0),
        ("frontalis_middle", 0.8, 0),
        ("frontalis_lateral", 0.7, 0),
    ),
    "brow lower": (
        ("corrugator_supercilii", 0.9, 0),
        ("depressor_supercilii", 0.5, 0),
        ("procerus", 0.5, 0.03),
    ),
    "lip tighten": (("orbicularis_oris", 0.7, 0), ("mentalis", 0.3, 0.05)),
    "smile": (
        ("zygomaticus_major", 0.8, 0),
        ("zygomaticus_minor", 0.2, 0),
        ("orbicularis_oculi_inferior", 0.6, 0.1),
    ),
    "frown": (("depressor_anguli_oris", 0.8, 0), ("mentalis", 0.5, 0.05)),
    "surprise": (
        ("frontalis_medial", 0.9, 0),
        ("frontalis_middle", 0.8, 0),
        ("frontalis_lateral", 0.8, 0),
        ("jaw_open", 0.4, 0.08),
    ),
    "anger": (
        ("corrugator_supercilii", 0.9, 0),
        ("depressor_supercilii", 0.6, 0),
        ("orbicularis_oculi_lateral", 0.4, 0.03),
        ("orbicularis_oris", 0.4, 0.07),
    ),
    "disgust": (
        ("levator_labii_superioris_alaeque_nasi", 0.9, 0),
        ("levator_labii_superioris", 0.5, 0.05),
        ("corrugator_supercilii", 0.4, 0),
        ("depressor_anguli_oris", 0.3, 0.08),
    ),
    "speech": (
        ("jaw_open", 0.35, 0),
        ("depressor_labii_inferioris", 0.4, 0.05),
        ("orbicularis_oris", 0.7, 0.2),
        ("jaw_open", 0.15, 0.22),
    ),
}
CONTROLS = {"units": UNITS, "muscles": MUSCLES}
EXPRESSIONS = tuple(MUSCLES)
LIPS_AND_AIR = tuple(name for name in UNITS if name not in MUSCLES)  # what no muscle does


@dataclass(frozen=True)
class Take:
    """One person before the camera: three expressions after a rest."""

    recipe: Recipe
    expressions: tuple[str, str, str]
    head: str  # how it moves, of HEADS
    camera_error: tuple[float, float]  # of the principal point, in image widths

    def spans(self) -> list[tuple[int, int]]:
        """First and last frame (from 1) of every expression."""
        starts = [round((REST + SLOT * i) * FPS) + 1 for i in range(3)]
        return [(start, start + round(SLOT * FPS) - 1) for start in starts]


def takes(
    first_seed: int,
    count: int,
    prefix: str,
    num_units: int,
    expressions: tuple[str, ...] = EXPRESSIONS,
) -> tuple[Take, ...]:
    """Every expression is shown equally often; the last of the people are moved by muscles."""
    return tuple(
        _take(seed, f"{prefix}-{i:02d}", i, "units" if i < num_units else "muscles", expressions)
        for i, seed in enumerate(range(first_seed, first_seed + count))
    )


def _take(seed: int, name: str, number: int, kind: str, expressions: tuple[str, ...]) -> Take:
    rng = np.random.default_rng([seed, 61])
    apart = len(expressions) // 3
    chosen = tuple(expressions[(number + apart * slot) % len(expressions)] for slot in range(3))
    phases = [
        phase
        for slot, expression in enumerate(chosen)
        for phase in phases_of(kind, expression, REST + SLOT * slot, rng)
    ]
    head = CHOSEN[number // 3 % 3]
    recipe = Recipe(
        name=name,
        kind=kind,
        seed=seed,
        num_frames=NUM_FRAMES,
        phases=tuple(phases),
        head_motion=HEADS[head],
        fps=FPS,
        **any_camera(rng),
    )
    off = rng.uniform(-0.012, 0.012, 2).round(4)
    return Take(recipe, chosen, head, (float(off[0]), float(off[1])))


def any_camera(rng: np.random.Generator) -> dict[str, float]:
    """How a recipe's footage is taken, by its fields."""
    return {
        "focal_ratio": round(float(rng.uniform(1.1, 1.45)), 3),
        "light_swing": round(float(rng.uniform(0.04, 0.2)), 3),
        "noise_sd": round(float(rng.uniform(1.5, 4)), 2),
        "blur_px": round(float(rng.uniform(0.4, 0.7)), 2),
        "crf": int(rng.integers(18, 23)),
    }


def phases_of(kind: str, expression: str, start: float, rng: np.random.Generator) -> list[Phase]:
    """An expression as this person shows it: its strength, its speed, stronger on one side."""
    strength, skew = rng.uniform(0.8, 1.05), rng.uniform(0.85, 1.0)
    begin = start + rng.uniform(0, 0.05)
    timing = {"rise": rng.uniform(0.2, 0.28), "hold": 0.1, "release": 0.05, "relaxation": 0.08}
    if expression == "speech":
        timing = {"rise": 0.12, "hold": 0.05, "release": 0.04, "relaxation": 0.06}
    weaker = rng.integers(2)
    phases = []
    for control, amplitude, after in CONTROLS[kind][expression]:
        sides = ("",) if control in SHARED else LEFT_RIGHT[kind]
        for side, suffix in enumerate(sides):
            share = skew if len(sides) == 2 and side == weaker else 1.0
            full = min(1.0, amplitude * strength * share)
            phases.append(Phase(f"{control}{suffix}", full, begin + after, **timing))
    return phases


def swung(chosen: tuple[Take, ...], prefix: str) -> tuple[Take, ...]:
    """Those whose head turns, with all the same but a head that turns further."""
    turning = [take for take in chosen if take.head == "turning"]
    return tuple(
        replace(
            take,
            head="swung",
            recipe=replace(take.recipe, name=f"{prefix}-{i}", head_motion=HEADS["swung"]),
        )
        for i, take in enumerate(turning)
    )


def some_of(chosen: tuple[Take, ...], number: int | None) -> tuple[Take, ...]:
    """`number` of the takes, evenly, so that every kind of them is among few already."""
    if number is None or number >= len(chosen):
        return chosen
    at = np.linspace(0, len(chosen) - 1, max(1, number)).round().astype(int)
    return tuple(chosen[i] for i in at)


# People of no other set: stills and portraits have those between 200 and 399 and from 500 on.
FULL = takes(400, 30, "full", num_units=20)
SETS = {
    "full": FULL,
    "full-swung": swung(FULL, "full-swung"),
    "full-tuning": takes(61, 9, "full-tuning", num_units=6),
    "consistency-tuning": takes(430, 18, "consistency-tuning", num_units=18),
    "lips-and-air": takes(480, 9, "lips-and-air", 9, LIPS_AND_AIR),
    "lips-and-air-tuning": takes(470, 9, "lips-and-air-tuning", 9, LIPS_AND_AIR),
}
