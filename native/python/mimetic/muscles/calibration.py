# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person's skin and muscles were found to be like, beside the assumed ones.

Factors about 1 on the attachment of the skin to the bone by region, and on the strengths of the
muscles. `mimetic.solve.calibrate` finds them; they are kept in the face fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.media.timing import LAST_FRAME
from mimetic.shared.documents import named, numbers
from mimetic.shared.note_beginnings import CALIBRATED
from mimetic.skin.mesh import SkinMesh, multiply

# Estimated as one, by regions of the template: footage hardly separates more.
REGIONS = {
    "forehead": ("forehead", "brow"),
    "eyes": ("eyelid", "temple"),
    "cheeks": ("cheek", "zygomatic"),
    "nose": ("nasal_bridge", "nose"),
    "lips": ("upper_lip", "lower_lip"),
    "chin": ("chin", "jaw_line"),
}
LEAST, MOST = 0.05, 20.0  # of any factor
FURTHEST = 10.0  # times, of an extent
FARTHEST = 15.0  # mm, of an insertion
MOST_MUSCLES = 1000
KEYS = ("stiffness", "strength", "insertion", "frames", "extent")


@dataclass
class Calibration:
    """stiffness: region of REGIONS -> factor on its attachment; strength: muscle -> factor on its
    displacement at activation 1; insertion: muscle -> how far it is attached from where the table
    has it, (away from the midline, up), millimetres on the template. What is not named stays at 1
    and in place. frames: of the footage, on which it rests. extent: muscle -> times that
    displacement by which this person's full contraction goes, of those that a clip showed to go
    beyond it; `mimetic.solve.full_range` finds it."""

    stiffness: dict[str, float] = field(default_factory=dict)
    strength: dict[str, float] = field(default_factory=dict)
    insertion: dict[str, tuple[float, float]] = field(default_factory=dict)
    frames: list[int] = field(default_factory=list)
    extent: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.stiffness = _factors("stiffness", self.stiffness, len(REGIONS))
        if unknown_regions := sorted(self.stiffness.keys() - REGIONS.keys()):
            raise InvalidInput(
                f"calibration's stiffness names {', '.join(unknown_regions)}; the regions are "
                f"{', '.join(REGIONS)}: calibrate again"
            )
        self.strength = _factors("strength", self.strength, MOST_MUSCLES)
        self.insertion = _shifts(self.insertion)
        self.extent = _factors("extent", self.extent, MOST_MUSCLES, 1.0, FURTHEST)
        if not isinstance(self.frames, list) or not all(_is_frame(frame) for frame in self.frames):
            raise InvalidInput("face fit's calibration: frames must be whole numbers from 1")

    def stiffness_factors(self, mesh: SkinMesh) -> NDArray[np.float64]:
        """N: times the attachment at every refined vertex; regions blend as the surface does."""
        return _core.stiffness_factors(region_weights(mesh), self.region_factors())

    def region_factors(self) -> list[float]:
        """One for each of REGIONS."""
        return [self.stiffness.get(name, 1.0) for name in REGIONS]

    def strength_factors(self, names: tuple[str, ...]) -> NDArray[np.float64]:
        """One for each of the muscles; raises InvalidInput for a muscle that they are not."""
        self._check_muscles(names)
        return np.array([self.strength.get(name, 1.0) for name in names])

    def extent_factors(self, names: tuple[str, ...]) -> NDArray[np.float64]:
        """One for each of the muscles; raises InvalidInput as above."""
        self._check_muscles(names)
        return np.array([self.extent.get(name, 1.0) for name in names])

    def insertion_shifts(self, names: tuple[str, ...]) -> NDArray[np.float64]:
        """One row of two for each of the muscles, millimetres; raises InvalidInput as above."""
        self._check_muscles(names)
        return np.array([self.insertion.get(name, (0.0, 0.0)) for name in names])

    def _check_muscles(self, names: tuple[str, ...]) -> None:
        named_ones = self.strength.keys() | self.insertion.keys() | self.extent.keys()
        if unknown_names := sorted(named_ones - set(names)):
            raise InvalidInput(
                f"the face fit's calibration names muscles that there are not: "
                f"{', '.join(unknown_names[:5])}: calibrate again"
            )

    def notes(self) -> list[str]:
        """For people, of a performance: none, or a line that names all factors, and one of the
        extents."""
        notes = [f"{CALIBRATED}: {self.described()}"] if self.frames else []
        if self.extent:
            further = ", ".join(f"{name} {factor:.2f}" for name, factor in self.extent.items())
            notes.append(f"at full contraction this person goes further than is assumed: {further}")
        return notes

    def described(self) -> str:
        """One line for people."""
        parts = [f"{name} {factor:.2f}" for name, factor in self.stiffness.items()]
        text = f"attachment of the skin {', '.join(parts)}" if parts else "attachment as assumed"
        if self.strength:
            stronger = [f"{name} {factor:.2f}" for name, factor in self.strength.items()]
            text += f"; strength {', '.join(stronger)}"
        if self.insertion:
            far = max(float(np.hypot(*shift)) for shift in self.insertion.values())
            text += f"; {len(self.insertion)} insertions moved, by {far:.1f} mm at most"
        return text

    def as_json(self) -> dict:
        return {key: getattr(self, key) for key in KEYS}

    @classmethod
    def from_json(cls, document: object) -> Calibration:
        """Raises InvalidInput naming what is wrong."""
        if not isinstance(document, dict):
            raise InvalidInput("face fit's calibration must be an object")
        if unknown_keys := sorted(document.keys() - set(KEYS)):
            raise InvalidInput(
                f"face fit's calibration has unknown keys: {', '.join(unknown_keys)}"
            )
        return cls(**document)


def region_weights(mesh: SkinMesh) -> NDArray[np.float64]:
    """N x R: how far each refined vertex belongs to each of REGIONS, 0 to 1."""
    inside = [
        np.any([mesh.in_region(name) for name in names], axis=0) for names in REGIONS.values()
    ]
    weights = multiply(mesh.stencils, np.stack(inside, axis=1).astype(np.float64))
    return np.clip(weights, 0, 1)


def _is_frame(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= LAST_FRAME


def _factors(
    key: str, factors: object, most: int, least: float = LEAST, largest: float = MOST
) -> dict[str, float]:
    if not isinstance(factors, Mapping) or len(factors) > most:
        raise InvalidInput(f"calibration's {key} must be an object of at most {most} factors")
    checked_factors = {}
    for name, value in named(key, dict(factors)):
        checked_factors[name] = float(numbers(f"{key} {name}", value, ()))
        if not least <= checked_factors[name] <= largest:
            raise InvalidInput(
                f"calibration's {key} {name} is {checked_factors[name]:g}, not {least:g} to "
                f"{largest:g}"
            )
    return checked_factors


def _shifts(shifts: object) -> dict[str, tuple[float, float]]:
    if not isinstance(shifts, Mapping) or len(shifts) > MOST_MUSCLES:
        raise InvalidInput(f"calibration's insertion must be an object of at most {MOST_MUSCLES}")
    checked_shifts = {}
    for name, value in named("insertion", dict(shifts)):
        x, y = numbers(f"insertion {name}", value, (2,))
        if np.hypot(x, y) > FARTHEST:
            raise InvalidInput(
                f"calibration's insertion {name} is moved by {np.hypot(x, y):.3g} mm, "
                f"at most {FARTHEST:g} are allowed"
            )
        checked_shifts[name] = (float(x), float(y))
    return checked_shifts
