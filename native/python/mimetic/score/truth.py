# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth file: what a clip really shows. docs/truth-file.md describes it for others."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.clip_keys import check_clip
from mimetic.shared.array_document import ArrayDocument
from mimetic.shared.array_file import check_names, check_shape, is_bounded, open_arrays
from mimetic.shared.array_writer import write_arrays

SCHEMA = 1
LARGEST = {"N": 1_000_000, "K": 100_000, "M": 1000, "A": 1000, "U": 1000, "V": 2_000_000}
LARGEST["E"] = 10_000
# key: (kind of number, shape); equal letters are equal lengths
REQUIRED: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "frame": ("i", ("N",)),
    "fps": ("f", (1,)),
    "image_size": ("i", (2,)),
    "intrinsics": ("f", (3, 3)),
    "head_pose": ("f", ("N", 4, 4)),
    "points": ("f", ("N", "K", 3)),
    "tracks": ("f", ("N", "K", 2)),
    "visible": ("b", ("N", "K")),
}
OPTIONAL: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "neutral_points": ("f", ("K", 3)),
    "points_face": ("i", ("K", 3)),
    "points_bary": ("f", ("K", 3)),
    "neutral_vertices": ("f", ("V", 3)),
    "muscles": ("U", ("M",)),
    "groups": ("i", ("M",)),
    "activations": ("f", ("N", "M")),
    "articulators": ("U", ("A",)),
    "articulator_values": ("f", ("N", "A")),
    "units": ("U", ("U",)),
    "unit_values": ("f", ("N", "U")),
    "expressions": ("U", ("E",)),
    "expression_frames": ("i", ("E", 2)),
}
KEYS = REQUIRED | OPTIONAL
ACCEPTED = {"f": "fiu", "i": "iu", "b": "b", "U": "U"}
DTYPES = {"f": np.float64, "i": np.int64, "b": np.bool_}
DOCUMENT = ArrayDocument(
    what="truth",
    schema=SCHEMA,
    required=REQUIRED,
    optional=OPTIONAL,
    accepted=ACCEPTED,
    dtypes=DTYPES,
    largest=LARGEST,
    advice="docs/truth-file.md says what it holds",
)
NAMED = {"muscles": "activations", "articulators": "articulator_values", "units": "unit_values"}
NAMED["expressions"] = "expression_frames"


@dataclass
class Truth:
    """N frames, K points of the surface. Metres and pixels, frames as in a `Performance`."""

    frame: NDArray[np.int64]  # N, numbers in the footage, first = 1
    fps: float
    image_size: NDArray[np.int64]  # width, height
    intrinsics: NDArray[np.float64]  # 3 x 3
    head_pose: NDArray[np.float64]  # N x 4 x 4, camera from head
    points: NDArray[np.float64]  # N x K x 3, head frame
    tracks: NDArray[np.float64]  # N x K x 2, pixels
    visible: NDArray[np.bool_]  # N x K
    neutral_points: NDArray[np.float64] | None = None  # K x 3
    points_face: NDArray[np.int64] | None = None  # K x 3, vertices of each point's triangle
    points_bary: NDArray[np.float64] | None = None  # K x 3
    neutral_vertices: NDArray[np.float64] | None = None  # V x 3
    muscles: list[str] | None = None  # M
    groups: NDArray[np.int64] | None = None  # M, 1 to 7
    activations: NDArray[np.float64] | None = None  # N x M
    articulators: list[str] | None = None  # A
    articulator_values: NDArray[np.float64] | None = None  # N x A
    units: list[str] | None = None  # U
    unit_values: NDArray[np.float64] | None = None  # N x U
    expressions: list[str] | None = None  # E, what is shown from when to when
    expression_frames: NDArray[np.int64] | None = None  # E x 2, first and last frame of each

    def __post_init__(self) -> None:
        for key, (kind, _) in KEYS.items():
            value = getattr(self, key)
            if value is None:
                continue
            if kind == "U":
                setattr(self, key, [str(name) for name in np.atleast_1d(value)])
            elif key == "fps":
                self.fps = float(np.asarray(value, np.float64).reshape(-1)[0])
            else:
                setattr(self, key, np.ascontiguousarray(value, DTYPES[kind]))
        self.check()

    def check(self) -> None:
        """Raises InvalidInput: which key, what is wrong."""
        lengths: dict[str, int] = {}
        for key, (kind, shape) in KEYS.items():
            value = getattr(self, key)
            if value is None:
                continue
            actual = (1,) if key == "fps" else np.shape(value)
            check_shape(f"truth {key}", actual, shape, lengths, LARGEST)
            if kind == "f" and not is_bounded(np.asarray(value)):
                raise InvalidInput(f"truth {key} is not finite, or too large")
            if kind == "U" and key != "expressions":
                check_names(f"truth {key}", value)
        if lengths["N"] < 2 or lengths["K"] < 1:
            raise InvalidInput("truth needs two frames and one point at least")
        check_clip("truth", self.frame, self.fps, self.image_size, self.intrinsics)
        for names, values in NAMED.items():
            if (getattr(self, names) is None) != (getattr(self, values) is None):
                raise InvalidInput(f"truth needs both or none of {names} and {values}")
        is_bad = ~_core.are_rigid(self.head_pose, 1e-4) | (self.head_pose[:, 2, 3] <= 0)
        if is_bad.any():
            raise InvalidInput(
                f"truth head_pose of frame {self.frame[is_bad.argmax()]} is not a rigid motion "
                "of a head before the camera"
            )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file whole or not at all."""
        path = Path(path)
        arrays = {"schema": np.array([SCHEMA])}
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                text = KEYS[field.name][0] == "U"
                arrays[field.name] = np.array(value, np.str_) if text else np.atleast_1d(value)
        write_arrays(path, arrays)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Truth:
        """Reads and checks a truth file; raises UnreadableMedia or InvalidInput."""
        with open_arrays(path, "a truth file (docs/truth-file.md)") as archive:
            return cls(**DOCUMENT.read(archive))
