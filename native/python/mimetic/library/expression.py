# SPDX-License-Identifier: GPL-3.0-or-later
"""The document of one kept expression: a still, or a motion with its phases."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.media.timing import check_rate
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.extras import extra_limits
from mimetic.muscles.sides import EYE_TURNS, mirrored_name, mirrored_sign
from mimetic.shared.array_document import ArrayDocument
from mimetic.shared.array_file import check_names, is_bounded, open_arrays
from mimetic.shared.array_writer import write_arrays
from mimetic.shared.shown_text import shown

SCHEMA = 1
LARGEST = {"N": 20_000, "C": 1000, "E": 1000}
# key: (kind of number, shape), as in `performance.document`
REQUIRED: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "channels": ("U", ("C",)),
    "values": ("f", ("N", "C")),
    "stds": ("f", ("N", "C")),
    "fps": ("f", (1,)),
}
OPTIONAL: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "event_names": ("U", ("E",)),
    "events": ("f", ("E", 4)),
    "source": ("U", (2,)),
}
DTYPES = {"f": np.float64}
DOCUMENT = ArrayDocument(
    what="kept expression",
    schema=SCHEMA,
    required=REQUIRED,
    optional=OPTIONAL,
    accepted={"f": "fiu", "U": "U"},
    dtypes=DTYPES,
    largest=LARGEST,
    advice="keep the expression again",
)
LARGEST_VALUE = 180.0  # degrees of a gaze; activations end at 1
UNKNOWN = (-90.0, 90.0)  # range of what is in no table: degrees of a gaze


@dataclass
class Expression:
    """N rows, evenly spaced in time, of C muscles and articulators; a still has one row."""

    channels: list[str]  # C, names of muscles and articulators
    values: NDArray[np.float64]  # N x C, 0 is rest
    stds: NDArray[np.float64]  # N x C
    fps: float
    event_names: list[str] | None = None  # E, groups
    events: NDArray[np.float64] | None = None  # E x 4: onset, apex, release in rows; amplitude
    source: list[str] | None = None  # file name of the footage, and which frames

    def __post_init__(self) -> None:
        self.channels = [str(name) for name in np.atleast_1d(self.channels)]
        self.values = np.ascontiguousarray(self.values, dtype=np.float64)
        self.stds = np.ascontiguousarray(self.stds, dtype=np.float64)
        self.fps = float(np.asarray(self.fps, dtype=np.float64).reshape(1)[0])
        if self.event_names is not None:
            self.event_names = [str(name) for name in np.atleast_1d(self.event_names)]
        if self.source is not None:
            self.source = [shown(text) for text in self.source]
        self.check()

    @property
    def is_still(self) -> bool:
        return len(self.values) == 1

    @property
    def seconds(self) -> float:
        """From the first row to the last; 0 of a still."""
        return (len(self.values) - 1) / self.fps

    @property
    def onset_seconds(self) -> float:
        """When its first group begins to move, from its first row."""
        if self.events is None or not len(self.events):
            return 0.0
        return float(np.clip(self.events[:, 0].min() / self.fps, 0, self.seconds))

    @property
    def peak(self) -> int:
        """The row in which the channels that are `telling` are farthest from rest."""
        return int((self.values[:, self.telling] ** 2).sum(axis=1).argmax())

    @property
    def telling(self) -> NDArray[np.bool_]:
        """C: channels that say how strong it is: muscles and lips; jaw and lids if there are none,
        the gaze, whose degrees are no share of anything, if there is nothing else."""
        is_bone = np.array([name in ARTICULATORS for name in self.channels])
        is_gaze = np.array([name.startswith(EYE_TURNS) for name in self.channels])
        kinds = (~is_bone & ~is_gaze, is_bone, is_gaze)
        return next(kind for kind in kinds if kind.any())

    def still(self) -> Expression:
        """Its peak alone."""
        row = slice(self.peak, self.peak + 1)
        source = self.source
        return Expression(self.channels, self.values[row], self.stds[row], self.fps, source=source)

    def mirrored(self) -> Expression:
        """What the left side does on the right one, and the other way round."""
        channels = [mirrored_name(name) for name in self.channels]
        signs = np.array([mirrored_sign(name) for name in self.channels])
        return Expression(
            *(channels, self.values * signs, self.stds, self.fps),
            *(self.event_names, self.events, self.source),
        )

    def check(self) -> None:
        """Raises InvalidInput: which key, what is wrong."""
        lengths = DOCUMENT.check_shapes(self)
        if lengths["N"] < 1 or lengths["C"] < 1:
            raise InvalidInput("kept expression has no rows or no channels")
        check_names("kept expression channels", self.channels)
        check_rate("kept expression fps", self.fps)
        if (self.events is None) != (self.event_names is None):
            raise InvalidInput("kept expression needs both events and event_names, or neither")
        for key in ("values", "stds", "events"):
            value = getattr(self, key)
            if value is not None and not is_bounded(value):
                raise InvalidInput(f"kept expression {key} is not finite, or too large")
        if np.abs(self.values).max() > LARGEST_VALUE or self.stds.min() < 0:
            raise InvalidInput(
                f"kept expression values must lie within {LARGEST_VALUE:g}, stds from 0 on"
            )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file, whole or not at all; raises OSError."""
        self.check()
        write_arrays(path, DOCUMENT.arrays_of(self))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Expression:
        """Reads and checks a file; raises UnreadableMedia or InvalidInput."""
        with open_arrays(path, "a kept expression (of `mimetic library`)") as archive:
            return cls(**DOCUMENT.read(archive))


def mirrored_values(values: Mapping[str, float]) -> dict[str, float]:
    """Values by muscle or articulator, with the sides changed."""
    return {mirrored_name(name): mirrored_sign(name) * value for name, value in values.items()}


def limits_of(names: list[str], muscles: list[str]) -> NDArray[np.float64]:
    """Least and greatest values, 2 x len(names), of muscles and articulators."""
    known = dict.fromkeys(muscles, (0.0, 1.0)) | ARTICULATORS | extra_limits()
    return np.array([known.get(name, UNKNOWN) for name in names]).T


def columns_in(expression: Expression, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Values and s.d. (N x len(names) each) of muscles and articulators, 0 where it has none."""
    values, stds = (np.zeros((len(expression.values), len(names))) for _ in range(2))
    for column, name in enumerate(expression.channels):
        if name in names:
            values[:, names.index(name)] = expression.values[:, column]
            stds[:, names.index(name)] = expression.stds[:, column]
    return values, stds
