# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding a face in an image and fitting the head to it."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.face_model import face_model, identity_names
from mimetic.face_template import FaceTemplate, data_folder, load_template
from mimetic.rest import expression, rest_score
from mimetic.whole_file import whole_file

SCHEMA = 1
LARGEST_FILE = 1 << 20  # bytes
DEFAULT_FOCAL = 1.2  # image widths: a webcam's 45 degrees
LARGEST_ERROR = 0.1  # rms of a face that was found, pupil distances; usual are 0.02
SEARCHES = (0.12, 0.07)  # half widths of the measurements after the first fit, pupil distances


class NoFace(InvalidInput):
    """No face in the image that a head could be fitted to; the text says why."""


@dataclass
class FaceFit:
    """A person's neutral head in one frame: proportions, pose and camera."""

    frame: int  # number in the footage, first = 1
    image_size: tuple[int, int]  # width, height, pixels
    intrinsics: NDArray[np.float64]  # 3 x 3, pixels
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head, metres; camera x right, y down
    identity: dict[str, float]  # coefficients of the template's identity modes
    features: dict[str, tuple[float, float]] = field(default_factory=dict)  # measured, pixels
    error: float = 0.0  # rms of the measured points and lines, pupil distances
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        _check(self)

    @property
    def camera(self) -> _core.Camera:
        k = self.intrinsics
        return _core.Camera(k[0, 0], k[1, 1], k[0, 2], k[1, 2], *self.image_size)

    def neutral_vertices(self, template: FaceTemplate) -> NDArray[np.float64]:
        """V x 3 control vertices of the person at rest, metres, head frame."""
        return template.neutral(self.identity)

    def save(self, path: str | os.PathLike) -> None:
        """Writes JSON, whole or not at all; raises OSError."""
        path = Path(path)
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
        }
        text = json.dumps(document, indent=1, allow_nan=False) + "\n"
        with whole_file(path) as stream:
            stream.write(text.encode())

    @classmethod
    def load(cls, path: str | os.PathLike) -> FaceFit:
        """Reads JSON; raises UnreadableMedia without such a file, InvalidInput if it is no fit."""
        path = Path(path)
        try:
            if path.stat().st_size > LARGEST_FILE:
                raise InvalidInput(f"{path}: not a face fit: larger than {LARGEST_FILE} bytes")
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise UnreadableMedia(f"{path}: {error.strerror}; give a face fit (JSON)") from None
        except UnicodeDecodeError:
            raise InvalidInput(f"{path}: not a face fit: not UTF-8 text") from None
        try:
            document = json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            raise InvalidInput(f"{path}: not a face fit: {error}") from None
        try:
            return cls(**_fields(document))
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None


def score_frame(image: NDArray[np.uint8]) -> float | None:
    """How well a frame serves as the neutral reference: 0 to 1, or None without a face.

    Sharp, frontal, level, with open eyes and a mouth at rest scores high. Compare frames of one
    clip only.
    """
    judged = judge_frame(image)
    return judged[0] if judged else None


def judge_frame(image: NDArray[np.uint8]) -> tuple[float, NDArray[np.float64]] | None:
    """The score of `score_frame`, and the expression (6) by which frames of a clip compare."""
    image = as_rgb(image)
    faces = _locator().locate(image)
    return (rest_score(image, faces[0]), expression(faces[0])) if faces else None


def find_face(
    image: NDArray[np.uint8],
    frame: int = 1,
    *,
    template: FaceTemplate | None = None,
    camera: _core.Camera | None = None,
    choice: int = 0,
) -> FaceFit:
    """Finds a face and fits pose and proportions of the head to it.

    image: (H, W, 3) RGB or (H, W) grey, uint8
    camera: its focal length is kept; without one, 1.2 image widths
    choice: which face, the largest first
    Raises NoFace with the reason, InvalidInput for an image that cannot be worked with.
    """
    image = as_rgb(image)
    height, width = image.shape[:2]
    template = template or load_template()
    faces = _locator().locate(image)
    if not faces:
        raise NoFace(
            f"no frontal face in frame {frame} ({width} x {height}): choose a frame in which the "
            "face looks at the camera, is lit and at least an eighth of the picture high, "
            "or give a face fit"
        )
    if not 0 <= choice < len(faces):
        raise InvalidInput(
            f"face {choice} was asked for, but frame {frame} shows {len(faces)}: count from 0"
        )
    warnings = []
    if len(faces) > 1:
        boxes = "; ".join(
            f"{i}: {f.box[2]:.0f} px wide, its left top at ({f.box[0]:.0f}, {f.box[1]:.0f})"
            for i, f in enumerate(faces)
        )
        warnings.append(f"{len(faces)} faces in frame {frame}, face {choice} is used ({boxes})")
    if camera is None:
        focal = DEFAULT_FOCAL * width
        camera = _core.Camera(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)
    elif (camera.width, camera.height) != (width, height):
        raise InvalidInput(
            f"the camera is for {camera.width} x {camera.height} pixels, "
            f"the image has {width} x {height}"
        )
    model = face_model(template)
    features = faces[choice]
    estimate = _core.fit_face(model, features, camera)
    for search in SEARCHES:
        features = _core.measure_features(
            image, _expected(model, estimate, camera, features), search
        )
        estimate = _core.fit_face(model, features, camera)
    if not estimate.converged or estimate.rms_ipd > LARGEST_ERROR:
        raise NoFace(
            f"what looks like a face in frame {frame} does not fit a head: choose another frame, "
            "or give a face fit"
        )
    names = identity_names(template)
    focal = estimate.focal
    return FaceFit(
        frame=frame,
        image_size=(width, height),
        intrinsics=np.array([[focal, 0, camera.cx], [0, focal, camera.cy], [0, 0, 1.0]]),
        head_pose=estimate.camera_from_head,
        identity={
            name: round(float(value), 6)
            for name, value in zip(names, estimate.identity, strict=True)
        },
        features={f.name: (float(f.position[0]), float(f.position[1])) for f in features.features},
        error=float(estimate.rms_ipd),
        warnings=warnings,
    )


def as_rgb(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(H, W, 3) uint8, C order, from RGB, RGBA or grey; raises InvalidInput."""
    image = np.asarray(image)
    if image.dtype != np.uint8:
        raise InvalidInput(f"image is {image.dtype}; 8-bit pixels (uint8) are needed")
    if image.ndim == 3 and image.shape[2] == 1:
        image = image[:, :, 0]
    if image.ndim == 2:
        image = np.repeat(image[:, :, None], 3, axis=2)
    if image.ndim != 3 or image.shape[2] not in (3, 4):
        raise InvalidInput(
            f"image has shape {image.shape}; (height, width) or (height, width, 3) is needed"
        )
    return np.ascontiguousarray(image[:, :, :3])


def _expected(model, estimate, camera, features):
    projected = _core.project_features(model, estimate, camera)
    return _core.FaceFeatures(
        projected.features, projected.curves, features.box, features.likelihood
    )


@lru_cache(maxsize=1)
def _locator() -> _core.FaceLocator:
    return _core.FaceLocator(str(data_folder()))


def _fields(document: object) -> dict:
    """Arguments of FaceFit from a JSON document of the right schema and keys."""
    if not isinstance(document, dict):
        raise InvalidInput("not a face fit: the document must be an object")
    known = {
        "schema",
        "frame",
        "image_size",
        "intrinsics",
        "head_pose",
        "identity",
        "features",
        "error",
        "warnings",
    }
    needed = known - {"features", "error", "warnings"}
    schema = document.get("schema")
    if schema != SCHEMA:
        raise InvalidInput(
            f"face fit has schema {schema!r}, this version reads {SCHEMA}: "
            "update Mimetic or fit again"
        )
    if missing := sorted(needed - document.keys()):
        raise InvalidInput(f"face fit lacks {', '.join(missing)}")
    if unknown := sorted(document.keys() - known):
        raise InvalidInput(f"face fit has unknown keys: {', '.join(unknown)}")
    return {key: value for key, value in document.items() if key != "schema"}


def _numbers(name: str, value: object, shape: tuple[int, ...]) -> NDArray[np.float64]:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"face fit's {name} must be numbers of shape {shape}") from None
    if array.shape != shape or not np.isfinite(array).all():
        raise InvalidInput(f"face fit's {name} must be finite numbers of shape {shape}")
    return array


def _check(fit: FaceFit) -> None:
    """Brings the fields to their types; raises InvalidInput naming the field."""
    if isinstance(fit.frame, bool) or not isinstance(fit.frame, int) or fit.frame < 1:
        raise InvalidInput(f"face fit's frame is {fit.frame!r}; it is a number from 1")
    size = _numbers("image_size", fit.image_size, (2,))
    if (size != np.round(size)).any() or (size < 16).any() or (size > 16384).any():
        raise InvalidInput(
            f"face fit's image_size is {fit.image_size}; whole pixels from 16 to 16384 are needed"
        )
    fit.image_size = (int(size[0]), int(size[1]))
    fit.intrinsics = _numbers("intrinsics", fit.intrinsics, (3, 3))
    k = fit.intrinsics
    if not (k[0, 0] > 0 and k[1, 1] > 0) or k[0, 1] or k[1, 0] or k[2].tolist() != [0, 0, 1]:
        raise InvalidInput(
            "face fit's intrinsics must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], fx and fy above 0"
        )
    fit.head_pose = _numbers("head_pose", fit.head_pose, (4, 4))
    rotation = fit.head_pose[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) or np.linalg.det(rotation) < 0:
        raise InvalidInput("face fit's head_pose must hold a rotation (orthonormal, determinant 1)")
    if fit.head_pose[3].tolist() != [0, 0, 0, 1] or fit.head_pose[2, 3] <= 0:
        raise InvalidInput(
            "face fit's head_pose must end in the row 0 0 0 1 and lie before the camera (z > 0)"
        )
    fit.identity = {
        name: float(_numbers(f"identity {name}", v, ()))
        for name, v in _items("identity", fit.identity)
    }
    fit.features = {
        name: tuple(_numbers(f"feature {name}", v, (2,)).tolist())
        for name, v in _items("features", fit.features)
    }
    fit.error = float(_numbers("error", fit.error, ()))
    if not isinstance(fit.warnings, list) or not all(
        isinstance(text, str) for text in fit.warnings
    ):
        raise InvalidInput("face fit's warnings must be a list of texts")


def _items(name: str, value: object):
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
        raise InvalidInput(f"face fit's {name} must map names to numbers")
    return value.items()
