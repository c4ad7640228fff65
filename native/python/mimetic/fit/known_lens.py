# SPDX-License-Identifier: GPL-3.0-or-later
"""The lens that footage was filmed with, where a person knows it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.performance.document import Performance
from mimetic.shared.pinhole import FULL_FRAME_MM

DEFAULT_FOCAL = 1.2  # picture widths: a webcam's 45 degrees, where nobody knows it
# The same of a face that fills its picture: from a webcam it would be 15 cm away, so that the lens
# was longer, or the picture is a part of one. At 1.2 no head fits to 12 of 15 such pictures.
FILLING_FOCAL = 3.0
FILLING = 0.8  # of the picture's width, a face's box from which on it may fill it
LEAST_FOCAL, MOST_FOCAL = 0.2, 60.0  # picture widths: 136 degrees to 1
SAME = 1e-3  # of focal lengths: one that was rounded


@dataclass(frozen=True)
class KnownLens:
    """Focal length and width of the sensor, of the picture as it is shown upright."""

    focal_mm: float
    sensor_mm: float = FULL_FRAME_MM

    def __post_init__(self) -> None:
        for name, value in (("focal length", self.focal_mm), ("sensor", self.sensor_mm)):
            if not 0 < value < float("inf"):
                raise InvalidInput(f"{name} {value:g} mm: it must be above 0")
        if not LEAST_FOCAL <= self.widths <= MOST_FOCAL:
            least, most = (limit * self.sensor_mm for limit in (LEAST_FOCAL, MOST_FOCAL))
            raise InvalidInput(
                f"focal length {self.focal_mm:g} mm: on a sensor {self.sensor_mm:g} mm wide it "
                f"must be {least:.3g} to {most:.4g}"
            )

    @property
    def widths(self) -> float:
        """The focal length in widths of the picture."""
        return self.focal_mm / self.sensor_mm


def is_fitted_with(lens: KnownLens | None, pictures: FaceFit | Performance) -> bool:
    """Whether a fit or a performance has this lens, or that of none that is known."""
    focal = float(pictures.intrinsics[0, 0]) / int(pictures.image_size[0])
    possible = (lens.widths,) if lens else (DEFAULT_FOCAL, FILLING_FOCAL)
    return any(abs(focal / widths - 1) < SAME for widths in possible)


def camera_with(lens: KnownLens | None, size: tuple[int, int]) -> _core.Camera:
    """The camera of pictures (width, height) with square pixels, its axis through their middle."""
    return _camera(lens.widths if lens else DEFAULT_FOCAL, size)


def cameras_to_try(
    lens: KnownLens | None, size: tuple[int, int], faces: Iterable[_core.FaceFeatures]
) -> list[_core.Camera]:
    """Cameras as `camera_with` has them for fitting a head to one of some faces, likely ones first.

    Another one is worth a try where the lens is not known and a face fills its picture.
    """
    widest = max((face.box[2] for face in faces), default=0.0)
    further = [FILLING_FOCAL] if lens is None and widest >= FILLING * size[0] else []
    return [camera_with(lens, size), *(_camera(widths, size) for widths in further)]


def _camera(widths: float, size: tuple[int, int]) -> _core.Camera:
    width, height = size
    focal = width * widths
    return _core.Camera(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)
