# SPDX-License-Identifier: GPL-3.0-or-later
"""A head's mesh that is not the template's: checked, made one skin, with its landmarks on it.

Vertices at exactly the same place are one (files part them where textures are cut). The skin is
the connected part that the landmarks lie on; eyes, teeth, lashes and clothes are loose parts.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.skin.checks import check_span, unfold
from mimetic.template.face_template import FaceTemplate

REQUIRED = (
    *("eye_inner.L", "eye_inner.R", "eye_outer.L", "eye_outer.R"),
    *("brow_inner.L", "brow_inner.R", "brow_outer.L", "brow_outer.R"),
    *("nose_bridge", "nose_tip", "mouth_corner.L", "mouth_corner.R"),
    *("lip_upper_inner", "lip_lower_inner", "chin"),
)
MAX_VERTICES = 1_000_000
FRONT = ("nose_bridge", "nose_tip", "chin")  # of a head they look forwards


def fit_similarity(source: NDArray[np.float64], target: NDArray[np.float64]) -> _core.Similarity:
    """Least squares (Umeyama 1991); raises InvalidInput if only a mirrored one would fit."""
    similarity = _core.fit_similarity(source, target)
    if similarity.is_mirror:
        raise InvalidInput(
            "the landmarks are a mirror image of a face's: .L is the subject's own left; "
            "swap the .L and .R landmarks, or mirror the mesh"
        )
    return similarity


@dataclass(frozen=True)
class ForeignSkin:
    """The skin of a foreign mesh, in the template's frame and size.

    vertices: N x 3; landmarks: name -> (3,); user_from_skin: similarity to the caller's
    coordinates; user_triangles: of the caller's vertices, loose parts included. Of `mesh`:
    triangles, T x 3; face: T, the face of each; skin_vertex: of each of the caller's V vertices, -1
    on loose parts; user_vertices: V x 3 in the template's frame; loose: V, the number of the loose
    part, -1 on the skin.
    """

    mesh: _core.ForeignSkin
    vertices: NDArray[np.float64]
    landmarks: dict[str, NDArray[np.float64]]
    user_from_skin: _core.Similarity
    user_triangles: NDArray[np.int32]
    notes: tuple[str, ...]

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        return self.mesh.triangles

    @cached_property
    def skin_vertex(self) -> NDArray[np.int32]:
        return self.mesh.skin_vertex

    @cached_property
    def user_vertices(self) -> NDArray[np.float64]:
        return self.mesh.user_vertices

    @cached_property
    def first_vertex(self) -> NDArray[np.int64]:
        """N: the first of the caller's vertices that lies at each of the skin's."""
        first = np.full(len(self.vertices), -1)
        on_skin = np.flatnonzero(self.skin_vertex >= 0)
        first[self.skin_vertex[on_skin][::-1]] = on_skin[::-1]
        return first

    @cached_property
    def surface(self) -> _core.MuscleSurface:
        return _core.MuscleSurface(self.vertices, self.triangles, [True] * len(self.triangles))

    @contextmanager
    def named_by_caller(self) -> Iterator[None]:
        """Errors about faces and vertices of the skin name the caller's instead."""

        def name(match: re.Match) -> str:
            word, number = match.group(1), int(match.group(2))
            table = self.mesh.face if word == "face" else self.first_vertex
            text = f"{word} {table[number]}"
            end = match.group(3)
            return text + (f"-{self.first_vertex[int(end)]}" if end else "")

        try:
            yield
        except InvalidInput as error:
            text = re.sub(r"\b(face|vertex|edge) (\d+)(?:-(\d+))?", name, str(error))
            raise InvalidInput(text) from None


def read_skin(
    vertices: ArrayLike,
    faces: ArrayLike,
    landmarks: Mapping[str, int | ArrayLike],
    template: FaceTemplate,
) -> ForeignSkin:
    """Check a mesh and its landmarks; arguments and errors as for `foreign_head.attach_foreign`."""
    points = _check_vertices(vertices)
    triangles, face = _core.cut_faces(points, _check_faces(faces))
    landmark_places = _check_landmarks(landmarks, points, template)
    names = list(landmark_places)
    targets = np.array(list(landmark_places.values()))
    core = [names.index(name) for name in REQUIRED]
    _check_sides(landmark_places)
    canonical = template.vertices[[template.landmark(name) for name in REQUIRED]]
    user_from_skin = fit_similarity(canonical, targets[core])
    check_span(_core.PUPIL_DISTANCE * user_from_skin.scale, "the eyes, by the landmarks,")
    front = [names.index(name) for name in FRONT]
    mesh = _core.read_foreign_skin(points, triangles, face, names, targets, front, user_from_skin)
    num_collapsed = mesh.num_collapsed
    return _unfolded(
        ForeignSkin(
            mesh=mesh,
            vertices=mesh.vertices,
            landmarks=dict(zip(names, mesh.landmarks, strict=True)),
            user_from_skin=user_from_skin,
            user_triangles=triangles,
            notes=(f"{num_collapsed} faces without extent were left out",) if num_collapsed else (),
        )
    )


def _unfolded(skin: ForeignSkin) -> ForeignSkin:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        vertices = unfold(skin.vertices, lambda _: skin.triangles, skin.mesh.face)
    notes = (*skin.notes, *(str(warning.message) for warning in caught))
    skin.mesh.vertices = vertices
    return replace(skin, vertices=vertices, notes=notes)


def _check_vertices(vertices: ArrayLike) -> NDArray[np.float64]:
    points = np.ascontiguousarray(vertices, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise InvalidInput(f"vertices are {points.shape}, needed are V x 3")
    if len(points) > MAX_VERTICES:
        raise InvalidInput(f"the mesh has {len(points)} vertices, at most are {MAX_VERTICES}")
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise InvalidInput(f"vertex {bad} is not finite")
    return points


def _check_faces(faces: ArrayLike) -> NDArray[np.int64]:
    """F x 4, a triangle ends in -1."""
    faces = np.asarray(faces)
    if faces.ndim != 2 or faces.shape[1] not in (3, 4) or len(faces) == 0:
        raise InvalidInput(f"faces are {faces.shape}, needed are F x 3 or F x 4")
    if faces.dtype.kind not in "iu":
        raise InvalidInput(f"faces are {faces.dtype}, needed are integers")
    if len(faces) > 2 * MAX_VERTICES:
        raise InvalidInput(f"the mesh has {len(faces)} faces, at most are {2 * MAX_VERTICES}")
    faces = faces.astype(np.int64)
    if faces.shape[1] == 3:
        faces = np.column_stack([faces, np.full(len(faces), -1)])
    return np.ascontiguousarray(faces)


def _check_landmarks(
    landmarks: Mapping[str, int | ArrayLike], points: NDArray[np.float64], template: FaceTemplate
) -> dict[str, NDArray[np.float64]]:
    """Name -> point; missing, unknown and out of range ones are named."""
    if missing := [name for name in REQUIRED if name not in landmarks]:
        raise InvalidInput(f"landmarks lack {', '.join(missing)}")
    if unknown_names := [name for name in landmarks if name not in template.landmark_names]:
        raise InvalidInput(
            f"there is no landmark {unknown_names[0]!r}; there are "
            f"{', '.join(template.landmark_names)}"
        )
    checked_places = {}
    for name, value in landmarks.items():
        place = np.asarray(value)
        if place.shape == () and place.dtype.kind in "iu":
            if not 0 <= int(place) < len(points):
                raise InvalidInput(
                    f"landmark {name} is vertex {int(place)}, the mesh has {len(points)}"
                )
            checked_places[name] = points[int(place)]
        elif place.shape == (3,) and place.dtype.kind in "iuf" and np.isfinite(place).all():
            checked_places[name] = place.astype(np.float64)
        else:
            raise InvalidInput(
                f"landmark {name} is {value!r}: needed is a vertex's index or x, y, z in metres"
            )
    return checked_places


def _check_sides(places: Mapping[str, NDArray[np.float64]]) -> None:
    """Pairs stand all the same way round: eyes larger than a face has room for cross others."""
    pairs = [name.removesuffix(".L") for name in REQUIRED if name.endswith(".L")]
    across = np.array([places[f"{pair}.L"] - places[f"{pair}.R"] for pair in pairs])
    is_crossed = across @ across.sum(axis=0) < 0
    if is_crossed.any():
        pair = pairs[int(np.flatnonzero(is_crossed)[0])]
        raise InvalidInput(
            f"{pair}.L and {pair}.R stand the other way round than the other landmarks do: "
            "exchange the two if they were mistaken for each other; where two eyes overlap, place "
            "their inner corners on the skin between them"
        )
