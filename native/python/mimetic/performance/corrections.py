# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person says of a captured face in single frames, and its file (docs/guide/corrections.md).

Corrections are measurements, each with a standard deviation: a refinement weighs them against what
the pictures show. Files are not trusted.
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.gaze import GAZE
from mimetic.shared.json_file import parse_json, read_json, write_json
from mimetic.shared.shown_text import shortened

SCHEMA = 1
LARGEST_FILE = 16 << 20  # bytes
MOST_FRAMES, MOST_PINS = 100_000, 1000  # a file's; a frame's
REACH, LONGEST_REACH = 8.0, 1000.0  # frames
PIXEL_STD, VALUE_STD = 1.0, 0.03
ROTATION_STD, TRANSLATION_STD = 0.01, 0.002  # rad, metres
GAP_STD = 3e-4  # metres
LIP_GAP = "lip_gap"  # beside the names of values
# Lowest and highest value, usual standard deviation
GAP_LIMITS, VALUE_LIMITS = (-0.05, 0.1), (-1.0, 1.0)
CLOSING_LIMITS = (-1.6, 1.0)  # of lips to the slit, and off it
GAZE_LIMITS, GAZE_STD = (-50.0, 50.0), 1.0  # degrees
LARGEST_STD = 1e4
ROUNDING = 1e-4  # of weights that sum to 1, of a rotation


@dataclass(frozen=True)
class SkinPin:
    """A place of the skin that is to be seen at a pixel."""

    face: int  # of the performance's quads
    weights: tuple[float, float, float, float]  # of the quad's corners in turn; they sum to 1
    pixel: tuple[float, float]  # of pictures of the performance's image_size
    std: float = PIXEL_STD  # pixels


@dataclass(frozen=True)
class PinnedPose:
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head, metres
    rotation_std: float = ROTATION_STD
    translation_std: float = TRANSLATION_STD


@dataclass(frozen=True)
class Pinned:
    """A number and its standard deviation."""

    value: float
    std: float


@dataclass(frozen=True)
class FrameCorrection:
    """The corrections of one frame."""

    frame: int  # number in the footage, first = 1
    reach: float = REACH  # frames before and after within which it counts
    pins: tuple[SkinPin, ...] = ()
    pose: PinnedPose | None = None
    values: dict[str, Pinned] = field(default_factory=dict)  # by muscle or articulator
    lip_gap: Pinned | None = None  # metres between the inner edges of the lips; 0: they touch

    def as_json(self) -> dict[str, Any]:
        document: dict[str, Any] = {"frame": self.frame, "reach": self.reach}
        if self.pins:
            document["pins"] = [
                {
                    "face": pin.face,
                    "weights": list(pin.weights),
                    "pixel": list(pin.pixel),
                    "std": pin.std,
                }
                for pin in self.pins
            ]
        if self.pose is not None:
            document["pose"] = {
                "head_pose": self.pose.head_pose.tolist(),
                "rotation_std": self.pose.rotation_std,
                "translation_std": self.pose.translation_std,
            }
        if self.values:
            document["values"] = {name: _as_json(entry) for name, entry in self.values.items()}
        if self.lip_gap is not None:
            document["lip_gap"] = _as_json(self.lip_gap)
        return document


Corrections = tuple[FrameCorrection, ...]


def limits_of(name: str) -> tuple[float, float]:
    """Lowest and highest value that may be stated of a muscle, an articulator, the lips' gap."""
    if name == LIP_GAP:
        return GAP_LIMITS
    if name.startswith("oris_close_"):
        return CLOSING_LIMITS
    return GAZE_LIMITS if name in GAZE else VALUE_LIMITS


def usual_std(name: str) -> float:
    """The standard deviation of a value of which none is stated."""
    if name == LIP_GAP:
        return GAP_STD
    return GAZE_STD if name in GAZE else VALUE_STD


def load_corrections(path: str | os.PathLike[str]) -> Corrections:
    """Reads a file of corrections; raises UnreadableMedia, InvalidInput naming file and place."""
    document = read_json(path, "corrections", LARGEST_FILE)
    try:
        return corrections_from(document)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {shortened(error)}") from None


def save_corrections(path: str | os.PathLike[str], corrections: Corrections) -> None:
    """Writes the file whole or not at all; raises OSError."""
    write_json(Path(path), as_document(corrections))


def as_document(corrections: Iterable[FrameCorrection]) -> dict[str, Any]:
    return {"schema": SCHEMA, "corrections": [entry.as_json() for entry in corrections]}


def corrections_from(document: object) -> Corrections:
    """Of a JSON document, by frame; raises InvalidInput naming the place."""
    fields = _keys("the document", document, ("schema", "corrections"), ())
    if fields["schema"] != SCHEMA or isinstance(fields["schema"], bool):
        raise InvalidInput(
            f"corrections have schema {fields['schema']!r}, this version reads {SCHEMA}"
        )
    entries = _list("corrections", fields["corrections"], MOST_FRAMES)
    read = [_correction(f"corrections[{i}]", entry) for i, entry in enumerate(entries)]
    frames = sorted(entry.frame for entry in read)
    for frame, following in itertools.pairwise(frames):
        if frame == following:
            raise InvalidInput(f"corrections has frame {frame} twice: one entry a frame is needed")
    return tuple(sorted(read, key=lambda entry: entry.frame))


def corrections_in(text: str) -> Corrections:
    """Of the text of a file; raises InvalidInput."""
    return corrections_from(parse_json(text.encode("utf-8", "surrogatepass")))


def texts_of(corrections: Iterable[FrameCorrection]) -> list[str]:
    """One JSON text a frame, as a performance keeps them."""
    return [json.dumps(entry.as_json(), allow_nan=False) for entry in corrections]


def from_texts(texts: Sequence[str]) -> Corrections:
    """The inverse of `texts_of`; raises InvalidInput."""
    entries = [parse_json(text.encode("utf-8", "surrogatepass")) for text in texts]
    return corrections_from({"schema": SCHEMA, "corrections": entries})


class Corrected(Protocol):
    """The key of a performance that holds them."""

    corrections: list[str] | None


def corrected_frames(performance: Corrected) -> list[int]:
    """Numbers of the frames that a person corrected."""
    return [entry.frame for entry in from_texts(performance.corrections or [])]


def check_corrections(
    corrections: Corrections, frames: tuple[int, int], num_faces: int, names: Sequence[str]
) -> None:
    """Raises InvalidInput for corrections of other frames, faces, muscles than a capture's.

    frames: its first and last; num_faces: quads of skin; names: of muscles and articulators.
    """
    first, last = frames
    for entry in corrections:
        where = f"corrections of frame {entry.frame}"
        if not first <= entry.frame <= last:
            raise InvalidInput(f"{where}: the capture has frames {first} to {last}")
        for i, pin in enumerate(entry.pins):
            if pin.face >= num_faces:
                raise InvalidInput(
                    f"{where}: pins[{i}].face is {pin.face}, the skin has faces 0 to "
                    f"{num_faces - 1}"
                )
        for name in entry.values:
            if name not in names:
                raise InvalidInput(f"{where}: values.{name}: the capture has no such value")


def _correction(where: str, value: object) -> FrameCorrection:
    optional = ("reach", "pins", "pose", "values", "lip_gap")
    fields = _keys(where, value, ("frame",), optional)
    frame = _whole(f"{where}.frame", fields["frame"], 1)
    where = f"frame {frame}"
    pins = _list(f"{where}: pins", fields.get("pins", []), MOST_PINS)
    pose, gap = fields.get("pose"), fields.get("lip_gap")
    return FrameCorrection(
        frame,
        _number(f"{where}: reach", fields.get("reach", REACH), 1.0, LONGEST_REACH),
        tuple(_pin(f"{where}: pins[{i}]", pin) for i, pin in enumerate(pins)),
        None if pose is None else _pose(f"{where}: pose", pose),
        _values(f"{where}: values", fields.get("values", {})),
        None if gap is None else _pinned(f"{where}: lip_gap", gap, LIP_GAP),
    )


def _pin(where: str, value: object) -> SkinPin:
    fields = _keys(where, value, ("face", "weights", "pixel"), ("std",))
    weights = _numbers(f"{where}.weights", fields["weights"], 4, 0.0, 1.0)
    if abs(sum(weights) - 1) > ROUNDING:
        raise InvalidInput(f"{where}.weights sum to {sum(weights):.6g}; they must sum to 1")
    x, y = _numbers(f"{where}.pixel", fields["pixel"], 2, -1e5, 1e5)
    return SkinPin(
        _whole(f"{where}.face", fields["face"], 0),
        (weights[0], weights[1], weights[2], weights[3]),
        (x, y),
        _std(f"{where}.std", fields.get("std", PIXEL_STD)),
    )


def _pose(where: str, value: object) -> PinnedPose:
    fields = _keys(where, value, ("head_pose",), ("rotation_std", "translation_std"))
    rows = _list(f"{where}.head_pose", fields["head_pose"], 4)
    if len(rows) != 4:
        raise InvalidInput(f"{where}.head_pose must be 4 rows of 4 numbers")
    pose = np.array(
        [_numbers(f"{where}.head_pose[{i}]", row, 4, -1e3, 1e3) for i, row in enumerate(rows)]
    )
    if not _core.are_rigid(pose[None], ROUNDING)[0] or pose[2, 3] <= 0:
        raise InvalidInput(
            f"{where}.head_pose must be a rotation and a translation before the camera (z > 0)"
        )
    return PinnedPose(
        pose,
        _std(f"{where}.rotation_std", fields.get("rotation_std", ROTATION_STD)),
        _std(f"{where}.translation_std", fields.get("translation_std", TRANSLATION_STD)),
    )


def _values(where: str, value: object) -> dict[str, Pinned]:
    if not isinstance(value, dict):
        raise InvalidInput(f"{where} must map names to a value and a std")
    return {name: _pinned(f"{where}.{name}", entry, name) for name, entry in value.items()}


def _pinned(where: str, value: object, name: str) -> Pinned:
    fields = _keys(where, value, ("value",), ("std",))
    return Pinned(
        _number(f"{where}.value", fields["value"], *limits_of(name)),
        _std(f"{where}.std", fields.get("std", usual_std(name))),
    )


def _as_json(entry: Pinned) -> dict[str, float]:
    return {"value": entry.value, "std": entry.std}


def _keys(
    where: str, value: object, required: Sequence[str], optional: Sequence[str]
) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise InvalidInput(f"{where} must be an object")
    if missing := [key for key in required if key not in value]:
        raise InvalidInput(f"{where} lacks {', '.join(missing)}")
    if unknown_keys := sorted(value.keys() - {*required, *optional}):
        raise InvalidInput(
            f"{where} has unknown keys: {', '.join(unknown_keys)}; "
            f"known are {', '.join((*required, *optional))}"
        )
    return value


def _list(where: str, value: object, most: int) -> list[Any]:
    if not isinstance(value, list) or len(value) > most:
        raise InvalidInput(f"{where} must be a list of at most {most}")
    return value


def _numbers(where: str, value: object, count: int, low: float, high: float) -> list[float]:
    if not isinstance(value, list) or len(value) != count:
        raise InvalidInput(f"{where} must be {count} numbers")
    return [_number(f"{where}[{i}]", entry, low, high) for i, entry in enumerate(value)]


def _number(where: str, value: object, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InvalidInput(f"{where} is {value!r}; a number from {low:g} to {high:g} is needed")
    return float(value)


def _std(where: str, value: object) -> float:
    return _number(where, value, 1e-6, LARGEST_STD)


def _whole(where: str, value: object, low: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= 10**9:
        raise InvalidInput(f"{where} is {value!r}; a whole number from {low} is needed")
    return value
