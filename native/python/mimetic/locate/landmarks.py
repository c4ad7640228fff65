# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks of a face by supervised descent: which they are, and the trained cascade's file."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.shared.array_file import check_names, is_bounded, read_archive
from mimetic.shared.array_writer import write_arrays
from mimetic.shared.installed_data import installed
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE

FILE_NAME = "face_landmarks.npz"  # in the folder of installed data
BETWEEN_PREFIX = "skin."  # of points that have no name of their own
NUM_PLACES = 44  # on the left half and the midline, named ones among them
ALIKE = 1.6  # what sigma is multiplied by: landmarks of a face err together
# Nothing in a picture marks these points: they follow from the rest of the face as in drawn
# people; measured lines are better evidence of a real one
ON_BARE_SKIN = (BETWEEN_PREFIX, "gonion", "zygion", "tragus")
BARE = 3.0  # what sigma there is multiplied by, too
SHAPES: dict[str, tuple[int | str, ...]] = {
    "schema": (),
    "names": ("L",),
    "reference": ("L", 2),
    "yaws": ("V",),
    "starts": ("V", "L", 2),
    "sigmas": ("V", "L"),
    "cells": ("K",),
    "means": ("K", "D"),
    "bases": ("K", "M", "D"),
    # Regressions are kept as products: outputs x R, R x inputs
    "outputs": ("K", "O", "R"),
    "inputs": ("K", "R", "I"),
}
SCHEMA = 1
KINDS = {"schema": "i", "names": "U"}
# Products of O x I float64 a stage: 0.4 GB at most
LARGEST = {"L": 200, "V": 9, "K": 12, "D": 128, "M": 128, "O": 400, "R": 400, "I": 1 << 13}


def landmark_points(template: FaceTemplate) -> tuple[list[str], NDArray[np.float64]]:
    """Names of the cascade's landmarks (L), and weights L x (S + 2) of skin points and eyeballs.

    The head's own landmarks, the eyeballs' centres (`pupil.L`, `pupil.R`: what the fit calls so),
    and points of the face between them, named `skin.` and their vertex.
    """
    skin = template.num_skin_vertices
    vertex_of = dict(
        zip(template.landmark_names, map(int, template.landmark_vertices), strict=True)
    )
    landmark_vertices = set(vertex_of.values())
    for vertex in _spread(template):
        for v in (vertex, int(template.mirror[vertex])):
            if v not in landmark_vertices:
                landmark_vertices.add(v)
                vertex_of[f"{BETWEEN_PREFIX}{v}"] = v
    vertex_of |= {"pupil.L": skin, "pupil.R": skin + 1}
    weights = np.zeros((len(vertex_of), skin + 2))
    weights[np.arange(len(vertex_of)), list(vertex_of.values())] = 1
    return list(vertex_of), weights


def mirrored_order(template: FaceTemplate) -> NDArray[np.int64]:
    """L: which landmark has the place of each when a picture is turned left for right."""
    names = landmark_points(template)[0]
    other = {"L": "R", "R": "L"}

    def mirror(name: str) -> str:
        stem, dot, side = name.rpartition(".")
        if stem + dot == BETWEEN_PREFIX:
            return f"{BETWEEN_PREFIX}{int(template.mirror[int(side)])}"
        return f"{stem}.{other[side]}" if side in other else name

    return np.array([names.index(mirror(name)) for name in names])


def _spread(template: FaceTemplate) -> list[int]:
    """Vertices of the face's left half and midline, well apart, the named ones first."""
    points = template.vertices[: template.num_skin_vertices]
    candidates = template.in_region(*FACE) & (points[:, 0] > -1e-6)
    landmarks = [int(v) for v in template.landmark_vertices if points[v, 0] > -1e-6]
    return _core.spread_rows(points, landmarks, candidates.tolist(), NUM_PLACES)


def installed_cascade() -> _core.LandmarkCascade:
    """The cascade that comes with the package; raises UnreadableMedia without it."""
    return installed(FILE_NAME, load)


def measured_landmarks(
    image: NDArray[np.uint8], face: _core.FaceFeatures, yaw: float | None = None
) -> _core.FaceFeatures:
    """What the cascade says of a face that was found.

    yaw: degrees, of the view to start from; by default the one that the finder saw. Raises
    InvalidInput where the regression leaves the face.
    """
    cascade = installed_cascade()
    right, left = (
        feature.position
        for name in ("pupil.R", "pupil.L")
        for feature in face.features
        if feature.name == name
    )
    start = cascade.start(right, left, face.yaw if yaw is None else yaw)
    landmarks = cascade.settle(image, start)
    weight = [ALIKE * (BARE if name.startswith(ON_BARE_SKIN) else 1) for name in cascade.names]
    features = [
        _core.Feature(*one)
        for one in zip(cascade.names, landmarks.places, weight * landmarks.sigma_px, strict=True)
    ]
    return _core.FaceFeatures(features, [], face.box, face.likelihood)


def save(arrays: dict[str, NDArray], path: str | os.PathLike) -> None:
    """Writes an .npz of the arrays in SHAPES, whole or not at all; raises OSError."""
    write_arrays(path, arrays | {"schema": np.array(SCHEMA)})


def load(path: str | os.PathLike) -> _core.LandmarkCascade:
    """Raises InvalidInput for a file that holds no cascade, UnreadableMedia for one unreadable."""
    arrays = read_archive(path, SHAPES, KINDS, LARGEST)
    if (schema := int(arrays["schema"])) != SCHEMA:
        raise InvalidInput(f"{path}: has schema {schema}, this version reads {SCHEMA}")
    for name, array in arrays.items():
        if array.dtype.kind != "U" and not is_bounded(array):
            raise InvalidInput(f"{path}: {name} is not finite")
    try:
        check_names("names", arrays["names"].tolist())
        return cascade_of(arrays)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None


def cascade_of(arrays: dict[str, NDArray]) -> _core.LandmarkCascade:
    """The cascade of arrays with the shapes in SHAPES; raises InvalidInput."""
    a = {n: v if v.dtype.kind == "U" else v.astype(np.float64) for n, v in arrays.items()}
    stages = [
        _core.LandmarkStage(cell, mean, basis, outputs @ inputs)
        for cell, mean, basis, outputs, inputs in zip(
            *(a[n] for n in ("cells", "means", "bases", "outputs", "inputs")), strict=True
        )
    ]
    views = [
        _core.LandmarkView(*view) for view in zip(a["yaws"], a["starts"], a["sigmas"], strict=True)
    ]
    return _core.LandmarkCascade(a["names"].tolist(), a["reference"], views, stages)
