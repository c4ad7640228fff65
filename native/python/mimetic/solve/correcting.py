# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing a list of corrections, as a person does with a mouse and sliders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.muscles.extras import LIP_CLOSING, articulator_limits
from mimetic.performance.corrections import (
    LIP_GAP,
    ROTATION_STD,
    TRANSLATION_STD,
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
from mimetic.solve.stated import lip_gap_of, states_more_than_pins
from mimetic.solve.stated_pose import PoseDrag, turned
from mimetic.template.face_template import load_template

__all__ = [
    "PIN",
    "POSE",
    "PinBoard",
    "PoseDrag",
    "as_document",
    "at_frame",
    "corrections_in",
    "is_refined_by",
    "kind_of",
    "parts_of",
    "pinned_at",
    "refined",
    "states_more_than_pins",
    "turn_at",
    "value_at",
    "value_names",
    "with_entry",
    "with_turn",
    "with_value",
    "without",
    "without_frame",
    "without_pin",
    "without_pose",
    "without_value",
]

# Names of what is stated beside values
POSE, PIN = "pose", "pin "
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
    gone = _entry(corrections, frame)
    return tuple(entry for entry in corrections if entry is not gone)


def without(corrections: Corrections, frame: int, what: str = "") -> Corrections:
    """Without one thing that is stated in a frame, by its name in `parts_of`; empty: without all.

    Raises InvalidInput where that is not corrected there.
    """
    if not what:
        return without_frame(corrections, frame)
    if what == POSE:
        return without_pose(corrections, frame)
    if what.startswith(PIN):
        number = what.removeprefix(PIN)
        return without_pin(corrections, frame, int(number) if number.isdecimal() else 0)
    return without_value(corrections, frame, what)


def without_value(corrections: Corrections, frame: int, name: str) -> Corrections:
    """Raises InvalidInput where it is not stated there."""
    if pinned_at(corrections, frame, name) is None:
        raise InvalidInput(f"frame {frame}: {name} is not corrected there")
    entry = _entry(corrections, frame)
    if name == LIP_GAP:
        return with_entry(corrections, replace(entry, lip_gap=None))
    values = {other: pinned for other, pinned in entry.values.items() if other != name}
    return with_entry(corrections, replace(entry, values=values))


def without_pin(corrections: Corrections, frame: int, number: int) -> Corrections:
    """number: from 1. Raises InvalidInput where there are fewer pins."""
    entry = _entry(corrections, frame)
    if not 1 <= number <= len(entry.pins):
        raise InvalidInput(f"frame {frame} has {len(entry.pins)} pins, counted from {PIN}1")
    pins = entry.pins[: number - 1] + entry.pins[number:]
    return with_entry(corrections, replace(entry, pins=pins))


def without_pose(corrections: Corrections, frame: int) -> Corrections:
    """Raises InvalidInput where no pose is stated."""
    entry = _entry(corrections, frame)
    if entry.pose is None:
        raise InvalidInput(f"frame {frame}: no {POSE} is corrected there")
    return with_entry(corrections, replace(entry, pose=None))


def parts_of(entry: FrameCorrection) -> list[str]:
    """Names of what an entry states: `pin 1`, ..., `pose`, values."""
    names = [f"{PIN}{number}" for number in range(1, len(entry.pins) + 1)]
    names += [POSE] * (entry.pose is not None) + [*entry.values]
    return names + [LIP_GAP] * (entry.lip_gap is not None)


def _entry(corrections: Corrections, frame: int) -> FrameCorrection:
    entry = at_frame(corrections, frame)
    if entry is None:
        raise InvalidInput(f"nothing is corrected in frame {frame}")
    return entry


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


def value_at(
    performance: Performance, frame: int, name: str, corrections: Corrections = ()
) -> float:
    """A value that a correction may state: as stated in the frame, otherwise as captured."""
    i = performance.index_of(frame)
    if (pinned := pinned_at(corrections, frame, name)) is not None:
        return pinned.value
    if name in performance.muscles:
        return float(performance.activations[i, performance.muscles.index(name)])
    if name == LIP_GAP:
        return lip_gap_of(performance, i)
    if name not in performance.articulators:
        return 0.0
    seen = seen_articulators(performance, slice(i, i + 1))[0]
    return float(seen[performance.articulators.index(name)])


def pinned_at(corrections: Corrections, frame: int, name: str) -> Pinned | None:
    """What is stated of a value in a frame."""
    entry = at_frame(corrections, frame)
    if entry is None:
        return None
    return entry.lip_gap if name == LIP_GAP else entry.values.get(name)


def kind_of(name: str) -> str:
    """What a value is: `share`, `signed` (below 0 too), `closing` (a lip's way to the slit or off
    it), `angle` in degrees, `gap` in metres."""
    if name == LIP_GAP:
        return "gap"
    if name in GAZE:
        return "angle"
    if name in LIP_CLOSING:
        return "closing"
    lowest, _ = articulator_limits().get(name, (0.0, 1.0))
    return "signed" if lowest < 0 else "share"


def with_turn(
    corrections: Corrections,
    performance: Performance,
    frame: int,
    degrees: ArrayLike,
    metres: ArrayLike,
    reach: float,
    rotation_std: float = ROTATION_STD,
    translation_std: float = TRANSLATION_STD,
) -> Corrections:
    """The captured pose turned about the camera's axes (3) and moved along them (3).

    rotation_std in radians, translation_std in metres.
    """
    pose = turned(performance, frame, degrees, metres)
    entry = at_frame(corrections, frame) or FrameCorrection(frame)
    pinned = PinnedPose(pose, rotation_std, translation_std)
    return with_entry(corrections, replace(entry, reach=reach, pose=pinned))


def turn_at(
    corrections: Corrections, performance: Performance, frame: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """By what `with_turn` states the pose that is stated: degrees (3), metres (3); 0 if none is."""
    entry = at_frame(corrections, frame)
    if entry is None or entry.pose is None:
        return np.zeros(3), np.zeros(3)
    captured, stated = performance.head_pose[performance.index_of(frame)], entry.pose.head_pose
    turn = np.ascontiguousarray(stated[:3, :3] @ captured[:3, :3].T)
    degrees = np.degrees(_core.rotation_vectors(turn[None])[0])
    return degrees, stated[:3, 3] - captured[:3, 3]


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
