# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of eyes and mouth by networks that have seen real faces, on crops placed by the pose."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.shared.installed_data import data_folder, installed
from mimetic.template.face_template import FaceTemplate

# Mesh, iris, and the heads that see lips, left and right eye again
FILES = tuple(
    f"{name}.onnx"
    for name in ("face_mesh", "iris_landmark", "face_lips", "face_eye_left", "face_eye_right")
)
# Regressor of lids and irises, fitted to drawn people (scripts/train_eyes_and_lips)
EYE_POINTS = "eye_points.onnx"
# What is before a face, fitted to drawn people (scripts/train_occlusion)
OCCLUSION = "occlusion.onnx"
ANCHORS = ("hairline", "menton", "eye_outer.L", "eye_inner.L", "eye_outer.R", "eye_inner.R")
# Points of the mesh and of the eye's contour, by name: each of the network that errs least there
MESH_POINTS = {
    **{"eye_outer.R": 33, "eye_inner.R": 133, "eye_inner.L": 362, "eye_outer.L": 263},
    **{"mouth_corner.R": 61, "mouth_corner.L": 291},
    **{"lip_outer_upper": 0, "lip_inner_upper": 13, "lip_inner_lower": 14, "lip_outer_lower": 17},
}
CONTOUR_POINTS = {"lid_lower": 4, "lid_upper": 12}


def installed_networks() -> _core.FeatureNetworks | None:
    """The networks, or None where they are not installed; raises UnreadableMedia if damaged."""
    files = [data_folder() / name for name in FILES]
    if not all(file.is_file() for file in files):
        return None
    return _load(*(str(file) for file in (*files, data_folder() / EYE_POINTS)))


def eye_regressor() -> _core.EyeRegressor:
    """What was fitted to drawn people, alone: for lids and irises where there are no networks.

    Raises UnreadableMedia.
    """
    return installed(EYE_POINTS, _load_regressor)


def occlusion_network() -> _core.OcclusionNetwork:
    """What sees hands and other things before a face. Raises UnreadableMedia."""
    return installed(OCCLUSION, _load_occlusion)


def _load_occlusion(file: Path) -> _core.OcclusionNetwork:
    return _core.OcclusionNetwork(str(file))


def _load_regressor(file: Path) -> _core.EyeRegressor:
    return _core.EyeRegressor(str(file))


@lru_cache(maxsize=1)
def _load(*files: str) -> _core.FeatureNetworks:
    return _core.FeatureNetworks(*files)


def feature_anchors(
    neutral_vertices: NDArray[np.float64], template: FaceTemplate
) -> NDArray[np.float64]:
    """Where on one person's head the networks look: 6 x 3, metres, head frame."""
    return neutral_vertices[[template.landmark(name) for name in ANCHORS]]


def feature_places(
    networks: _core.FeatureNetworks, image: NDArray[np.uint8], crops: _core.FeatureCrops
) -> dict[str, NDArray[np.float64]]:
    """Pixels by name: `iris`, `eye_outer`, ... with `.L` and `.R`, `mouth_corner`, lips' middles.

    image: H x W x 3 uint8 RGB.
    """
    mesh = networks.mesh(image, crops.face, refine_eyes=True).places
    places = {name: mesh[i] for name, i in MESH_POINTS.items()}
    for side, crop in zip("LR", crops.eyes, strict=True):
        eye = networks.eye(image, crop, side == "L")
        places[f"iris.{side}"] = eye.iris[0]
        places |= {f"{name}.{side}": eye.contour[i] for name, i in CONTOUR_POINTS.items()}
    return places


def network_features(
    networks: _core.FeatureNetworks, image: NDArray[np.uint8], crops: _core.FeatureCrops
) -> _core.FaceFeatures:
    """Eyes and mouth as points and lines with their errors, as a fit takes them.

    image: H x W x 3 uint8 RGB.
    """
    mesh = networks.mesh(image, crops.face, True)
    return _core.network_features(mesh, *both_eyes(networks, image, crops))


def both_eyes(
    source: _core.FeatureNetworks | _core.EyeRegressor,
    image: NDArray[np.uint8],
    crops: _core.FeatureCrops,
) -> tuple[_core.EyePoints, _core.EyePoints]:
    """The left and the right eye. image: H x W x 3 uint8 RGB."""
    left, right = crops.eyes
    return source.eye(image, left, True), source.eye(image, right, False)
