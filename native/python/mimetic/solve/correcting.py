# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing a list of corrections, as a person does with a mouse and sliders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.corrections import (
    LIP_GAP,
    Corrections,
    FrameCorrection,
    Pinned,
    PinnedPose,
    SkinPin,
    as_document,
    corrections_in,
    from_texts,
    limits_of,
    texts_of,
    usual_std,
)
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, has_gaze, seen_articulators
from mimetic.performance.pinned_places import PinnedPlaces, place_under
from mimetic.performance.places import RefinedSurface
from mimetic.performance.projection import rescaled
from mimetic.shared.picture import picture_coordinates
from mimetic.solve.refining import refined, within
from mimetic.template.face_template import load_template

__all__ = [
    "PinBoard",
    "as_document",
    "at_frame",
    "corrections_in",
    "is_refined_by",
    "refined",
    "value_at",
    "value_names",
    "with_entry",
    "with_turn",
    "with_value",
    "without_frame",
]

SAME_PLACE = 8.0  # pixels of the footage's file within which a click means the pin that is there


def at_frame(corrections: Corrections, frame: int) -> FrameCorrection | None:
    return next((entry for entry in corrections if entry.frame == frame), None)


def with_entry(corrections: Corrections, entry: FrameCorrection) -> Corrections:
    """The list with a frame's entry in place of the one it had; without it if it says nothing."""
    others = [other for other in corrections if other.frame != entry.frame]
    if entry.pins or entry.values or entry.pose is not None or entry.lip_gap is not None:
        others.append(entry)
    return tuple(sorted(others, key=lambda other: other.frame))


def without_frame(corrections: Corrections, frame: int) -> Corrections:
    """Raises InvalidInput where nothing is corrected there."""
    if at_frame(corrections, frame) is None:
        raise InvalidInput(f"nothing is corrected in frame {frame}")
    return tuple(entry for entry in corrections if entry.frame != frame)


def is_refined_by(performance: Performance, corrections: Corrections) -> bool:
    """Whether a performance honours what was corrected in its frames, and nothing else."""
    honoured = from_texts(performance.corrections or [])
    return texts_of(honoured) == texts_of(within(corrections, performance))


def value_names(performance: Performance) -> list[str]:
    """What may be given a value: articulators, gaze, the lips' gap, muscles."""
    articulators = [name for name in performance.articulators if name not in GAZE]
    gaze = GAZE if has_gaze(performance) else ()
    return [*articulators, *gaze, LIP_GAP, *performance.muscles]


def with_value(
    corrections: Corrections, frame: int, name: str, value: float, std: float, reach: float
) -> Corrections:
    """A value, by its name in `value_names`, in a frame; a std of 0 stands for the usual one.

    Raises InvalidInput for a value that cannot be.
    """
    low, high = limits_of(name)
    if not low <= value <= high:
        raise InvalidInput(f"{name} cannot be {value:g}: it is from {low:g} to {high:g}")
    pinned = Pinned(value, std or usual_std(name))
    entry = at_frame(corrections, frame) or FrameCorrection(frame)
    if name == LIP_GAP:
        return with_entry(corrections, replace(entry, reach=reach, lip_gap=pinned))
    values = entry.values | {name: pinned}
    return with_entry(corrections, replace(entry, reach=reach, values=values))


def value_at(performance: Performance, frame: int, name: str) -> float:
    """What the performance has of a value that a correction may state; 0 of the lips' gap."""
    i = performance.index_of(frame)
    if name in performance.muscles:
        return float(performance.activations[i, performance.muscles.index(name)])
    if name not in performance.articulators:
        return 0.0
    seen = seen_articulators(performance, slice(i, i + 1))[0]
    return float(seen[performance.articulators.index(name)])


def with_turn(
    corrections: Corrections,
    performance: Performance,
    frame: int,
    degrees: ArrayLike,
    metres: ArrayLike,
    reach: float,
) -> Corrections:
    """The captured pose turned about the camera's axes (3) and moved along them (3)."""
    pose = performance.head_pose[performance.index_of(frame)].copy()
    turn = _core.from_rotation_vectors(np.radians(np.asarray(degrees, dtype=np.float64))[None])[0]
    pose[:3, :3] = turn @ pose[:3, :3]
    pose[:3, 3] += np.asarray(metres, dtype=np.float64)
    if pose[2, 3] <= 0:
        raise InvalidInput(f"frame {frame}: the head would be behind the camera")
    entry = at_frame(corrections, frame) or FrameCorrection(frame)
    return with_entry(corrections, replace(entry, reach=reach, pose=PinnedPose(pose)))


class PinBoard:
    """A performance on whose surface pins are put; pixels are those of the footage's file."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        self._surface = RefinedSurface(performance)
        size = performance.stored_size
        self.stored_size = performance.image_size if size is None else size

    def grabbed(
        self, corrections: Corrections, frame: int, pixel: tuple[float, float], std: float
    ) -> SkinPin:
        """The pin at a pixel of a frame, or a new one of the skin that is seen there.

        Raises InvalidInput beside the face, and in a frame that was not captured.
        """
        i = self.performance.index_of(frame)
        x, y = self._shown(pixel)
        entry = at_frame(corrections, frame)
        for pin in entry.pins if entry else ():
            apart = np.abs(self._stored(pin.pixel) - np.asarray(pixel)).max()
            if apart <= SAME_PLACE:
                return pin
        place = place_under(self._surface, (x, y), i)
        if place is None or place[0] >= load_template().num_skin_faces:
            raise InvalidInput(
                f"frame {frame}: no skin of the captured face is seen at {pixel[0]:.0f}, "
                f"{pixel[1]:.0f}"
            )
        return SkinPin(*place, (x, y), std)

    def with_pin(
        self,
        corrections: Corrections,
        frame: int,
        pin: SkinPin,
        pixel: tuple[float, float],
        reach: float,
    ) -> Corrections:
        """A pin of `grabbed` put to a pixel."""
        entry = at_frame(corrections, frame) or FrameCorrection(frame)
        others = [
            other for other in entry.pins if (other.face, other.weights) != (pin.face, pin.weights)
        ]
        moved = replace(pin, pixel=self._shown(pixel))
        return with_entry(corrections, replace(entry, reach=reach, pins=(*others, moved)))

    def lines(self, corrections: Corrections, frame: int) -> NDArray[np.float64]:
        """2P x 2, parts of the picture: of each pin the skin's place as captured, then its own."""
        entry = at_frame(corrections, frame)
        if entry is None or not entry.pins:
            return np.zeros((0, 2))
        i = self.performance.index_of(frame)
        places = PinnedPlaces(load_template(), entry.pins)
        points = places.positions(self.performance.surface_in_camera(i))
        ends = np.array([pin.pixel for pin in entry.pins])
        pairs = np.stack([self.performance.project(points), ends], axis=1)
        return picture_coordinates(pairs.reshape(-1, 2), self.performance.image_size)

    def _shown(self, pixel: tuple[float, float]) -> tuple[float, float]:
        x, y = rescaled(pixel, self.stored_size, self.performance.image_size)[0]
        return float(x), float(y)

    def _stored(self, pixel: tuple[float, float]) -> NDArray[np.float64]:
        return rescaled(pixel, self.performance.image_size, self.stored_size)[0]
