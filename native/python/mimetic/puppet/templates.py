# SPDX-License-Identifier: GPL-3.0-or-later
"""A taught set: how a person's face looks, what its muscles do then; a file to keep and share."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.puppet.parts import KINDS, channels_of
from mimetic.shared.array_document import ArrayDocument
from mimetic.shared.array_file import check_names, is_bounded, open_arrays
from mimetic.shared.array_writer import write_arrays

SCHEMA = 1
LEAST_SIDE, MOST_SIDE = 8, 512  # pixels of a template
LARGEST_VALUE = 1e3
DTYPES = {"f": np.float64, "i": np.int64, "B": np.uint8}
# key: (kind of number, shape); T templates, L looks, C channels, K examples, B pixels of all
# templates, H x W pixels of the view
REQUIRED: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "pixel": ("f", (1,)),
    "sides": ("f", (4,)),
    "looks": ("U", ("L",)),
    "look_frames": ("i", ("L",)),
    "look_values": ("f", ("L", "C")),
    "neutral": ("i", (1,)),
    "channels": ("U", ("C",)),
    "channel_groups": ("i", ("C",)),
    "limits": ("f", (2, "C")),
    "template_parts": ("U", ("T",)),
    "template_looks": ("i", ("T",)),
    "template_boxes": ("i", ("T", 4)),
    "template_pixels": ("B", ("B",)),
    "example_scores": ("f", ("K", "T")),
    "example_values": ("f", ("K", "C")),
}
OPTIONAL: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "footage": ("U", (2,)),
    "example_frames": ("i", ("K",)),
    "example_pictures": ("B", ("K", "H", "W")),
    "example_looks": ("i", ("K",)),
}
DOCUMENT = ArrayDocument(
    what="taught set",
    schema=SCHEMA,
    required=REQUIRED,
    optional=OPTIONAL,
    accepted={"f": "fiu", "i": "iu", "U": "U", "B": "u"},
    dtypes=DTYPES,
    largest={"L": 100, "C": 1000, "T": 300, "K": 1000, "B": 20_000_000, "H": 1000, "W": 1000},
    advice="teach again",
)


@dataclass
class TaughtSet:
    """T templates of L looks, K examples of their scores, and C muscles and articulators.

    Pictures are of a face as from straight in front, one pixel `pixel` metres wide.
    """

    pixel: float
    sides: NDArray[np.float64]  # left, right, bottom, top of the view, metres in the head frame
    looks: list[str]  # L
    look_frames: NDArray[np.int64]  # L, of the footage; 0: not of a solved frame
    look_values: NDArray[np.float64]  # L x C
    neutral: int  # index of the look at rest
    channels: list[str]  # C, muscles, then articulators
    channel_groups: NDArray[np.int64]  # C, 1 to 7 of muscles, 0 of articulators
    limits: NDArray[np.float64]  # 2 x C, least and greatest values
    template_parts: list[str]  # T, of parts.KINDS
    template_looks: NDArray[np.int64]  # T, index of the look
    template_boxes: NDArray[np.int64]  # T x 4, x, y, width, height in the view, pixels
    template_pixels: NDArray[np.uint8]  # of all templates, one after the other
    example_scores: NDArray[np.float64]  # K x T, -1 to 1
    example_values: NDArray[np.float64]  # K x C
    footage: list[str] | None = None  # file name, fingerprint
    example_frames: NDArray[np.int64] | None = None  # K, of the footage; 0: not of a solved frame
    # With both, single looks can be taught again
    example_pictures: NDArray[np.uint8] | None = None  # K x H x W, the view
    example_looks: NDArray[np.int64] | None = None  # K, index of the look it was taken for, or -1

    def __post_init__(self) -> None:
        self.pixel = float(np.asarray(self.pixel, dtype=np.float64).reshape(-1)[0])
        self.neutral = int(np.asarray(self.neutral).reshape(-1)[0])
        for key, (kind, _) in (REQUIRED | OPTIONAL).items():
            value = getattr(self, key)
            if value is None or key in ("pixel", "neutral"):
                continue
            if kind == "U":
                setattr(self, key, [str(name) for name in np.atleast_1d(value)])
            else:
                setattr(self, key, np.ascontiguousarray(value, dtype=DTYPES[kind]))
        self.check()

    @property
    def muscles(self) -> list[str]:
        return [c for c, g in zip(self.channels, self.channel_groups, strict=True) if g > 0]

    @property
    def articulators(self) -> list[str]:
        return [c for c, g in zip(self.channels, self.channel_groups, strict=True) if g == 0]

    @property
    def pictures(self) -> list[NDArray[np.uint8]]:
        """Of each template, height x width."""
        ends = np.cumsum(self.template_boxes[:, 2] * self.template_boxes[:, 3])
        parts = np.split(self.template_pixels, ends[:-1])
        return [
            np.ascontiguousarray(pixels.reshape(box[3], box[2]))
            for pixels, box in zip(parts, self.template_boxes, strict=True)
        ]

    def of_part(self, part: str) -> list[int]:
        """Indices of a part's templates."""
        return [i for i, name in enumerate(self.template_parts) if name == part]

    def channels_of(self, part: str) -> list[int]:
        """Indices of the channels that a part moves."""
        groups = self.channel_groups[self.channel_groups > 0].tolist()
        return channels_of(part, self.muscles, groups, self.articulators)

    def check(self) -> None:
        """Raises InvalidInput: which key, what is wrong."""
        lengths = DOCUMENT.check_shapes(self)
        if min(lengths[key] for key in "LCTK") < 1:
            raise InvalidInput("taught set has no looks, channels, templates or examples")
        check_names("taught set looks", self.looks)
        check_names("taught set channels", self.channels)
        for key in ("sides", "look_values", "limits", "example_scores", "example_values"):
            value = getattr(self, key)
            if not is_bounded(value) or np.abs(value).max() > LARGEST_VALUE:
                raise InvalidInput(f"taught set {key} is not finite, or too large")
        if not 2e-4 <= self.pixel <= 0.01:
            raise InvalidInput("taught set pixel must be .0002 to .01 metres")
        if self.channel_groups.min() < 0 or self.channel_groups.max() > 7:
            raise InvalidInput("taught set channel_groups must be 0 to 7")
        is_muscle = self.channel_groups > 0
        if (is_muscle[1:] & ~is_muscle[:-1]).any():
            raise InvalidInput("taught set channels must have muscles first, then articulators")
        if (self.limits[0] > self.limits[1]).any():
            raise InvalidInput("taught set limits must have the least values first")
        self._check_templates(lengths["L"])
        if self.example_pictures is not None:
            width, height = self.view_size
            if self.example_pictures.shape[1:] != (height, width):
                raise InvalidInput(f"taught set example_pictures are not {width} x {height} pixels")
        looks = self.example_looks
        if looks is not None and (looks.min() < -1 or looks.max() >= lengths["L"]):
            raise InvalidInput("taught set example_looks name looks that are not there")

    def _check_templates(self, num_looks: int) -> None:
        if not 0 <= self.neutral < num_looks:
            raise InvalidInput("taught set neutral names a look that is not there")
        if self.template_looks.min() < 0 or self.template_looks.max() >= num_looks:
            raise InvalidInput("taught set template_looks name looks that are not there")
        if unknown := sorted(set(self.template_parts) - set(KINDS)):
            raise InvalidInput(
                f"taught set has templates of {unknown[0]!r}; there are {', '.join(KINDS)}"
            )
        width, height = self.view_size
        x, y, w, h = self.template_boxes.T
        sides = self.template_boxes[:, 2:]
        if sides.min() < LEAST_SIDE or sides.max() > MOST_SIDE:
            raise InvalidInput(
                f"taught set templates must have {LEAST_SIDE} to {MOST_SIDE} pixels a side"
            )
        if x.min() < 0 or y.min() < 0 or (x + w).max() > width or (y + h).max() > height:
            raise InvalidInput("taught set template_boxes leave the view")
        if (w * h).sum() != len(self.template_pixels):
            raise InvalidInput("taught set template_pixels are not as many as the boxes say")

    @property
    def view_size(self) -> tuple[int, int]:
        """Width and height of the view, pixels."""
        left, right, bottom, top = self.sides
        if not (0.02 <= right - left <= 0.6 and 0.02 <= top - bottom <= 0.6):
            raise InvalidInput(
                "taught set sides must be left, right, bottom, top of a face, metres"
            )
        return round((right - left) / self.pixel), round((top - bottom) / self.pixel)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file, whole or not at all; raises OSError."""
        self.check()
        write_arrays(path, DOCUMENT.arrays_of(self))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> TaughtSet:
        """Reads and checks a file; raises UnreadableMedia or InvalidInput."""
        with open_arrays(path, "a taught set (of `mimetic puppet teach`)") as archive:
            return cls(**DOCUMENT.read(archive))
