# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of documents read from files, checked. Files are not trusted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.shared.array_file import is_bounded

ROUNDING = 1e-5  # of a rotation in a file


def numbers(name: str, value: object, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Finite numbers of a shape; raises InvalidInput naming the field."""
    try:
        array = np.array(value)  # of a type of its own: as floats, texts of digits would do
    except (TypeError, ValueError):
        raise InvalidInput(f"face fit's {name} must be numbers of shape {shape}") from None
    if array.shape != shape or array.dtype.kind not in "iuf" or not is_bounded(array):
        raise InvalidInput(f"face fit's {name} must be finite numbers of shape {shape}")
    return array.astype(np.float64)


def named(field_name: str, value: object) -> Iterable[tuple[str, object]]:
    """Items of an object; raises InvalidInput naming the field."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InvalidInput(f"face fit's {field_name} must map names to numbers")
    return value.items()


def checked_pose(value: object) -> NDArray[np.float64]:
    """A rigid transform that puts the head before the camera; raises InvalidInput."""
    pose = numbers("head_pose", value, (4, 4))
    turn = np.eye(4)
    turn[:3, :3] = pose[:3, :3]
    if not _core.are_rigid(turn[None], ROUNDING)[0]:
        raise InvalidInput("face fit's head_pose must hold a rotation (orthonormal, determinant 1)")
    if pose[3].tolist() != [0, 0, 0, 1] or pose[2, 3] <= 0:
        raise InvalidInput(
            "face fit's head_pose must end in the row 0 0 0 1 and lie before the camera (z > 0)"
        )
    return pose


def checked_places(what: str, places: object) -> dict[str, tuple[float, float]]:
    """Pixels by name; raises InvalidInput naming the place."""
    return {
        name: tuple(numbers(f"{what} {name}", place, (2,)).tolist())
        for name, place in named(f"{what}s", places)
    }
