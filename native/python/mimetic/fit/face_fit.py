# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's neutral head as fitted to footage, and its file fit.json."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.depth_bumps import between_bumps, depth_bumps
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitted_view import FittedView, checked_frame
from mimetic.fit.line_modes import line_modes
from mimetic.fit.residual_shape import residual_modes
from mimetic.fit.rest_choice import RestChoice
from mimetic.fit.still_cover import StillCover
from mimetic.muscles.calibration import Calibration
from mimetic.shared.documents import checked_places, checked_pose, named, numbers
from mimetic.shared.json_file import read_json
from mimetic.shared.parallel import both
from mimetic.shared.pinhole import camera_of
from mimetic.shared.shown_text import shortened, shown
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import FaceTemplate

SCHEMA = 9
REQUIRED = ("schema", "frame", "image_size", "intrinsics", "head_pose", "identity")
# Key: the schema that it came with; files of older schemas still load.
OPTIONAL = {"features": 1, "error": 1, "warnings": 1}
OPTIONAL |= {"residual": 2, "views": 2, "calibration": 3, "relief": 4, "depth": 6}
OPTIONAL |= {"lines": 7, "rest": 7, "depth_std": 8, "still_cover": 9}
LARGEST_FILE = 4 << 20  # bytes
MOST_VIEWS = 100


@dataclass
class FaceFit:
    """A person's neutral head in one frame: proportions, pose and camera.

    `views` holds what the fit rests on, the reference frame first, so that it can be solved again
    without the footage (`mimetic.fit.fitting.refit`); a fit from an older file has none.
    """

    frame: int  # the reference: number in the footage, first = 1
    image_size: tuple[int, int]  # width, height, pixels
    intrinsics: NDArray[np.float64]  # 3 x 3, pixels
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head, metres; camera x right, y down
    identity: dict[str, float]  # coefficients of the template's identity modes
    features: dict[str, tuple[float, float]] = field(default_factory=dict)  # measured, pixels
    error: float = 0.0  # rms of the measured points and lines, pupil distances
    warnings: list[str] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)  # of `residual_shape.residual_modes`
    views: list[FittedView] = field(default_factory=list)
    # Of the components of `face_shape`; `mimetic.solve.relief` finds it
    relief: list[float] = field(default_factory=list)
    # Metres, head frame, by which each of `depth_bumps` is moved; found with the relief
    depth: list[list[float]] = field(default_factory=list)
    # Metres, one a bump: s.d. of the depth there beside the whole face's; found with the relief
    depth_std: list[float] = field(default_factory=list)
    # Of `line_modes.line_modes`; `mimetic.fit.line_fit` finds it
    lines: list[float] = field(default_factory=list)
    calibration: Calibration = field(default_factory=Calibration)  # `mimetic calibrate` finds it
    rest: RestChoice = field(default_factory=RestChoice)  # why the face is at rest in `frame`
    # In all frames before the face, whatever it does; `mimetic.solve.find_face` finds it
    still_cover: StillCover = field(default_factory=StillCover)

    def __post_init__(self) -> None:
        _check(self)

    @property
    def camera(self) -> _core.Camera:
        return camera_of(self.intrinsics, self.image_size)

    @property
    def pins(self) -> dict[int, dict[str, tuple[float, float]]]:
        """Frame: landmark: the pixel it is pinned to. `mimetic.fit.fitting.refit` changes them."""
        return {view.frame: dict(view.pins) for view in self.views if view.pins}

    def rest_text(self) -> str:
        """Which frame is taken as rest, and why."""
        return self.rest.text(self.frame)

    def head_place(self) -> tuple[float, float]:
        """The pixel of the head's origin in the reference frame: which person it is."""
        place = self.intrinsics @ self.head_pose[:3, 3]
        return float(place[0] / place[2]), float(place[1] / place[2])

    def neutral_vertices(self, template: FaceTemplate) -> NDArray[np.float64]:
        """V x 3 control vertices of the person at rest, metres, head frame."""
        vertices = template.neutral(self.identity)
        if self.residual and self.lines:  # the first time, each solves for a skin of its own
            both(lambda: residual_modes(template), lambda: line_modes(template))
        if self.residual:
            vertices += _moved("residual", self.residual, residual_modes(template))
        if self.relief:
            vertices += _moved("relief", self.relief, face_shape(template).components)
        if self.depth:
            vertices += _moved("depth", self.depth, depth_bumps(template)).T
        if self.lines:
            vertices += _moved("lines", self.lines, line_modes(template))
        return vertices

    def neutral_depth_std(self, template: FaceTemplate) -> NDArray[np.float64] | None:
        """S: s.d. of the skin vertices' depth, metres; None where no relief was found."""
        if not self.depth_std:
            return None
        return between_bumps(template, np.array(self.depth_std))

    def view(self, frame: int) -> FittedView | None:
        """The view of a frame, if the fit rests on it."""
        return next((view for view in self.views if view.frame == frame), None)

    def save(self, path: str | os.PathLike) -> None:
        """Writes JSON, whole or not at all; raises OSError."""
        document = {
            "schema": SCHEMA,
            "frame": self.frame,
            "image_size": list(self.image_size),
            "intrinsics": self.intrinsics.tolist(),
            "head_pose": self.head_pose.tolist(),
            "identity": {name: value for name, value in self.identity.items() if value != 0},
            "features": {name: list(place) for name, place in self.features.items()},
            "error": self.error,
            "warnings": self.warnings,
            "residual": self.residual,
            "relief": self.relief,
            "depth": self.depth,
            "depth_std": self.depth_std,
            "lines": self.lines,
            "views": [view.as_json() for view in self.views],
            "calibration": self.calibration.as_json(),
            "rest": self.rest.as_json(),
            "still_cover": self.still_cover.as_json(),
        }
        with whole_file(path) as stream:
            stream.write(json.dumps(document, indent=1, allow_nan=False).encode() + b"\n")

    @classmethod
    def load(cls, path: str | os.PathLike) -> FaceFit:
        """Reads JSON; raises UnreadableMedia without such a file, InvalidInput if it is no fit."""
        document = read_json(path, "a face fit", LARGEST_FILE)
        try:
            return cls(**_fields(document))
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {shortened(error)}") from None


def _moved(name: str, coefficients: list, modes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of modes (N x ...) with coefficients (N ...), metres; raises InvalidInput."""
    if len(modes) != len(coefficients):
        raise InvalidInput(
            f"face fit has {len(coefficients)} {name} coefficients, this head has "
            f"{len(modes)}: fit again"
        )
    return np.tensordot(np.transpose(coefficients), modes, axes=1)


def _fields(document: object) -> dict:
    """Arguments of FaceFit from a JSON document of the right schema and keys."""
    if not isinstance(document, dict):
        raise InvalidInput("not a face fit: the document must be an object")
    schema = document.get("schema")
    if not isinstance(schema, int) or isinstance(schema, bool) or not 1 <= schema <= SCHEMA:
        raise InvalidInput(
            f"face fit has schema {schema!r}, this version reads {SCHEMA}: "
            "update Mimetic or fit again"
        )
    known_keys = {*REQUIRED, *(key for key, number in OPTIONAL.items() if schema >= number)}
    if missing := sorted(set(REQUIRED) - document.keys()):
        raise InvalidInput(f"face fit lacks {', '.join(missing)}")
    if unknown_keys := sorted(document.keys() - known_keys):
        raise InvalidInput(f"face fit has unknown keys: {', '.join(unknown_keys)}")
    fields = {key: value for key, value in document.items() if key != "schema"}
    views = fields.get("views", [])
    if not isinstance(views, list) or len(views) > MOST_VIEWS:
        raise InvalidInput(f"face fit's views must be a list of at most {MOST_VIEWS}")
    calibration = Calibration.from_json(fields.get("calibration", {}))
    return fields | {
        "views": [FittedView.from_json(view) for view in views],
        "calibration": calibration,
        "rest": RestChoice.from_json(fields.get("rest", {})),
        "still_cover": StillCover.from_json(fields.get("still_cover", {})),
    }


def _check(fit: FaceFit) -> None:
    """Brings the fields to their types; raises InvalidInput naming the field."""
    fit.frame = checked_frame(fit.frame)
    size = numbers("image_size", fit.image_size, (2,))
    if (size != np.round(size)).any() or (size < 16).any() or (size > 16384).any():
        raise InvalidInput(
            f"face fit's image_size is {fit.image_size}; whole pixels from 16 to 16384 are needed"
        )
    fit.image_size = (int(size[0]), int(size[1]))
    fit.intrinsics = numbers("intrinsics", fit.intrinsics, (3, 3))
    k = fit.intrinsics
    if not (k[0, 0] > 0 and k[1, 1] > 0) or k[0, 1] or k[1, 0] or k[2].tolist() != [0, 0, 1]:
        raise InvalidInput(
            "face fit's intrinsics must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], fx and fy above 0"
        )
    fit.head_pose = checked_pose(fit.head_pose)
    fit.identity = {
        name: float(numbers(f"identity {name}", v, ()))
        for name, v in named("identity", fit.identity)
    }
    fit.features = checked_places("feature", fit.features)
    fit.error = float(numbers("error", fit.error, ()))
    if not isinstance(fit.warnings, list) or not all(
        isinstance(text, str) for text in fit.warnings
    ):
        raise InvalidInput("face fit's warnings must be a list of texts")
    fit.warnings = [shown(text) for text in fit.warnings]
    for name in ("residual", "relief", "lines", "depth_std"):
        coefficients = getattr(fit, name)
        if not isinstance(coefficients, list | tuple | np.ndarray):
            raise InvalidInput(f"face fit's {name} must be a list of numbers")
        setattr(fit, name, numbers(name, coefficients, (len(coefficients),)).tolist())
    if not isinstance(fit.depth, list | tuple | np.ndarray):
        raise InvalidInput("face fit's depth must be a list of places")
    if len(fit.depth) > 0:
        fit.depth = numbers("depth", fit.depth, (len(fit.depth), 3)).tolist()
    if any(std < 0 for std in fit.depth_std):
        raise InvalidInput("face fit's depth_std must be 0 or more")
    frames = [view.frame for view in fit.views]
    if frames and (frames[0] != fit.frame or len(set(frames)) != len(frames)):
        raise InvalidInput("face fit's views must start with its frame and show each frame once")
