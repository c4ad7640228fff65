# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture that a fit rests on: what was measured in it, what was pinned, the head's pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.media.timing import LAST_FRAME
from mimetic.shared.documents import checked_places, checked_pose, named, numbers

PIN_SIGMA = 0.1  # pixels: what a hand places is held
MOST_POINTS = 1000  # of a curve
KEYS = ("frame", "head_pose", "pins", "box", "likelihood", "features", "curves", "motion")


@dataclass
class FittedView:
    """A frame with its measured features; the first view of a fit is its reference."""

    frame: int  # number in the footage, first = 1
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head, metres; camera x right, y down
    measured: _core.FaceFeatures
    pins: dict[str, tuple[float, float]] = field(default_factory=dict)  # landmark: pixels
    # K x 4 since the reference: vertex, pixels right, down, standard deviation
    motion: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 4)))

    def __post_init__(self) -> None:
        self.frame = checked_frame(self.frame)
        self.head_pose = checked_pose(self.head_pose)
        self.pins = checked_places("pin", self.pins)
        self.motion = numbers("motion", self.motion, (len(self.motion), 4))

    def observed(self, shift: Mapping[str, tuple[float, float]] | None = None) -> _core.FaceView:
        """What the solver takes.

        shift: pixels by which a landmark will lie beside the place that the solver gives it
        """
        pins = []
        for name, place in self.pins.items():
            right, down = (shift or {}).get(name, (0.0, 0.0))
            pins.append(_core.Feature(name, (place[0] - right, place[1] - down), PIN_SIGMA))
        return _core.FaceView(self.measured, pins, np.ascontiguousarray(self.motion))

    def as_json(self) -> dict:
        """Pixels to a ten thousandth."""
        return {
            "frame": self.frame,
            "head_pose": self.head_pose.tolist(),
            "pins": {name: list(place) for name, place in self.pins.items()},
            "box": np.round(self.measured.box, 4).tolist(),
            "likelihood": self.measured.likelihood,
            "features": {
                f.name: np.round([*f.position, f.sigma_px, f.likelihood], 4).tolist()
                for f in self.measured.features
            },
            "curves": {
                c.name: np.round(np.column_stack([c.points, c.normals, c.sigma_px]), 4).tolist()
                for c in self.measured.curves
            },
            "motion": np.round(self.motion, 4).tolist(),
        }

    @classmethod
    def from_json(cls, document: object) -> FittedView:
        """Raises InvalidInput naming the field."""
        if not isinstance(document, dict) or sorted(document) != sorted(KEYS):
            raise InvalidInput(f"face fit's views must be objects with {', '.join(KEYS)}")
        features = [
            _core.Feature(name, row[:2], max(row[2], 1e-3), row[3])
            for name, row in (
                (name, numbers(f"feature {name}", row, (4,)))
                for name, row in named("features", document["features"])
            )
        ]
        curves = [
            _core.FeatureCurve(name, rows[:, :2], rows[:, 2:4], np.maximum(rows[:, 4], 1e-3))
            for name, rows in (
                (name, numbers(f"curve {name}", rows, (_count(f"curve {name}", rows), 5)))
                for name, rows in named("curves", document["curves"])
            )
        ]
        face_features = _core.FaceFeatures(
            features,
            curves,
            numbers("box", document["box"], (4,)),
            float(numbers("likelihood", document["likelihood"], ())),
        )
        motion = document["motion"]
        motion = numbers("motion", motion, (_count("motion", motion), 4)) if motion else []
        motion = np.array(motion).reshape(-1, 4)
        return cls(
            document["frame"], document["head_pose"], face_features, document["pins"], motion
        )


def checked_frame(value: object) -> int:
    """The number of a frame; raises InvalidInput."""
    # numpy's whole numbers too, as a performance's frames are
    number = int(value) if isinstance(value, Integral) and not isinstance(value, bool) else 0
    if not 1 <= number <= LAST_FRAME:
        raise InvalidInput(f"face fit's frame is {value!r}; it is a number from 1 to {LAST_FRAME}")
    return number


def _count(name: str, rows: object) -> int:
    if not isinstance(rows, list) or len(rows) > MOST_POINTS:
        raise InvalidInput(f"face fit's {name} must have at most {MOST_POINTS} points")
    return len(rows)
