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
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.skin.checks import check_span, unfold
from mimetic.skin.mesh import split_quads

REQUIRED = (
    *("eye_inner.L", "eye_inner.R", "eye_outer.L", "eye_outer.R"),
    *("brow_inner.L", "brow_inner.R", "brow_outer.L", "brow_outer.R"),
    *("nose_bridge", "nose_tip", "mouth_corner.L", "mouth_corner.R"),
    *("lip_upper_inner", "lip_lower_inner", "chin"),
)
MAX_VERTICES = 1_000_000
MAX_SKIN_VERTICES = 80_000  # 70,000 take 1.2 GB and 40 s; a face needs 5,000
MAX_OFF_SKIN = 0.02  # m, of a landmark given as a point, at the template's size
MAX_AROUND = 256  # triangles at a vertex


@dataclass(frozen=True)
class Similarity:
    """target = scale * rotation @ source + shift."""

    scale: float
    rotation: NDArray[np.float64]
    shift: NDArray[np.float64]

    def apply(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.scale * points @ self.rotation.T + self.shift

    def turn(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.scale * displacements @ self.rotation.T

    def inverse(self) -> Similarity:
        rotation = self.rotation.T
        return Similarity(1 / self.scale, rotation, -rotation @ self.shift / self.scale)


def fit_similarity(source: NDArray[np.float64], target: NDArray[np.float64]) -> Similarity:
    """Least squares (Umeyama 1991); raises InvalidInput if only a mirrored one would fit."""
    a, b = source - source.mean(0), target - target.mean(0)
    u, singular, vt = np.linalg.svd(b.T @ a)
    if np.linalg.det(u @ vt) < 0:
        raise InvalidInput(
            "the landmarks are a mirror image of a face's: .L is the subject's own left; "
            "swap the .L and .R landmarks, or mirror the mesh"
        )
    scale = singular.sum() / (a**2).sum()
    return Similarity(scale, u @ vt, target.mean(0) - scale * u @ vt @ source.mean(0))


@dataclass(frozen=True)
class ForeignSkin:
    """The skin of a foreign mesh, in the template's frame and size.

    vertices: N x 3; triangles: T x 3; face: T, the caller's face of each; landmarks: name -> (3,).
    user_from_skin: similarity to the caller's coordinates; skin_vertex: of each of the caller's V
    vertices, -1 on loose parts; user_vertices: V x 3 in the template's frame; loose: V, the number
    of the loose part, -1 on the skin.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    face: NDArray[np.int64]
    landmarks: dict[str, NDArray[np.float64]]
    user_from_skin: Similarity
    skin_vertex: NDArray[np.int64]
    user_vertices: NDArray[np.float64]
    loose: NDArray[np.int64]
    notes: tuple[str, ...]

    @cached_property
    def surface(self) -> _core.MuscleSurface:
        return _core.MuscleSurface(
            self.vertices, self.triangles, np.ones(len(self.triangles), bool)
        )

    @contextmanager
    def named_by_caller(self) -> Iterator[None]:
        """Errors about faces and vertices of the skin name the caller's instead."""
        first = np.full(len(self.vertices), -1)
        on_skin = np.flatnonzero(self.skin_vertex >= 0)
        first[self.skin_vertex[on_skin][::-1]] = on_skin[::-1]

        def name(match: re.Match) -> str:
            word, number = match.group(1), int(match.group(2))
            table = self.face if word == "face" else first
            text = f"{word} {table[number]}"
            return text + (f"-{first[int(match.group(3))]}" if match.group(3) else "")

        try:
            yield
        except InvalidInput as error:
            text = re.sub(r"\b(face|vertex|edge) (\d+)(?:-(\d+))?", name, str(error))
            raise InvalidInput(text) from None


def read_skin(
    vertices: ArrayLike,
    faces: ArrayLike,
    landmarks: Mapping[str, int | ArrayLike],
    template,
) -> ForeignSkin:
    """Check a mesh and its landmarks; arguments and errors as for `foreign_head.attach_foreign`."""
    points = _check_vertices(vertices)
    triangles, face = _triangulate(points, faces)
    given = _check_landmarks(landmarks, points, template)
    names = list(given)
    canonical = np.array([template.vertices[template.landmark(name)] for name in names])
    core = [names.index(name) for name in REQUIRED]
    targets = np.array(list(given.values()))
    user_from_skin = fit_similarity(canonical[core], targets[core])
    check_span(0.063 * user_from_skin.scale, "the eyes, as the landmarks tell,")
    points = user_from_skin.inverse().apply(points)
    targets = user_from_skin.inverse().apply(targets)

    # Weld, keep the part that the landmarks lie on
    _, kept, welded = np.unique(points, axis=0, return_index=True, return_inverse=True)
    welded = welded.reshape(-1)
    corners = welded[triangles]
    part = _parts(corners, len(kept))
    used = np.unique(corners)
    nearest = [used[np.argmin(((points[kept[used]] - p) ** 2).sum(1))] for p in targets]
    skin_part = np.bincount(part[nearest]).argmax()
    _check_on_skin(names, targets, points[kept], used[part[used] == skin_part])
    chosen = part[corners[:, 0]] == skin_part
    corners, face = corners[chosen], face[chosen]
    collapsed = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
    notes = []
    if collapsed.any():
        notes.append(f"{collapsed.sum()} faces without extent were left out")
    corners, face = corners[~collapsed], face[~collapsed]
    own = np.unique(corners)
    if len(own) > MAX_SKIN_VERTICES:
        raise InvalidInput(
            f"the skin has {len(own)} vertices, at most {MAX_SKIN_VERTICES} can be solved: attach "
            "the muscles to a coarser copy of the mesh"
        )
    if np.bincount(corners.reshape(-1)).max() > MAX_AROUND:
        vertex = kept[np.bincount(corners.reshape(-1)).argmax()]
        raise InvalidInput(f"more than {MAX_AROUND} faces meet at vertex {vertex}")
    number = np.full(len(kept), -1)
    number[own] = np.arange(len(own))
    skin = ForeignSkin(
        vertices=np.ascontiguousarray(points[kept[own]]),
        triangles=number[corners].astype(np.int32),
        face=face,
        landmarks=dict(zip(names, targets, strict=True)),
        user_from_skin=user_from_skin,
        skin_vertex=number[welded],
        user_vertices=points,
        loose=np.where(number[welded] >= 0, -1, part[welded]),
        notes=tuple(notes),
    )
    _check_outward(skin)
    return _unfolded(skin)


def _check_outward(skin: ForeignSkin) -> None:
    """The nose and the chin of a head look forwards."""
    normals = skin.surface.normals
    front = [skin.landmarks[name] for name in ("nose_bridge", "nose_tip", "chin")]
    nearest = [np.argmin(((skin.vertices - place) ** 2).sum(1)) for place in front]
    if normals[nearest, 2].mean() < 0:
        raise InvalidInput("the faces look inwards: reverse the order of each face's vertices")


def _unfolded(skin: ForeignSkin) -> ForeignSkin:
    with skin.named_by_caller():
        _check_areas(skin)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        vertices = unfold(skin.vertices, lambda _: skin.triangles, skin.face)
    notes = (*skin.notes, *(str(warning.message) for warning in caught))
    values = {name: getattr(skin, name) for name in skin.__dataclass_fields__}
    return ForeignSkin(**{**values, "vertices": vertices, "notes": notes})


def _check_areas(skin: ForeignSkin) -> None:
    corners = skin.vertices[skin.triangles]
    sides = corners - np.roll(corners, 1, axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 1], sides[:, 2]), axis=1)
    empty = np.flatnonzero(~(doubled > 1e-9 * (sides**2).sum(2).max(1)))
    if len(empty):
        raise InvalidInput(f"face {empty[0]} has no area: remove it or merge its vertices")


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


def _triangulate(points, faces: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles and the face of each; quads are cut along their shorter diagonal."""
    faces = np.asarray(faces)
    if faces.ndim != 2 or faces.shape[1] not in (3, 4) or len(faces) == 0:
        raise InvalidInput(f"faces are {faces.shape}, needed are F x 3 or F x 4")
    if faces.dtype.kind not in "iu":
        raise InvalidInput(f"faces are {faces.dtype}, needed are integers")
    if len(faces) > 2 * MAX_VERTICES:
        raise InvalidInput(f"the mesh has {len(faces)} faces, at most are {2 * MAX_VERTICES}")
    faces = faces.astype(np.int64)
    is_quad = np.zeros(len(faces), bool) if faces.shape[1] == 3 else faces[:, 3] >= 0
    corners = np.where(np.arange(faces.shape[1]) < 3 + is_quad[:, None], faces, 0)
    wrong = np.flatnonzero(((corners < 0) | (corners >= len(points))).any(axis=1))
    if len(wrong):
        raise InvalidInput(
            f"face {wrong[0]} names a vertex that the mesh does not have: "
            f"{faces[wrong[0]].tolist()}"
        )
    index = np.arange(len(faces))
    quads = split_quads(points, faces[is_quad]) if is_quad.any() else np.zeros((0, 3), int)
    return (
        np.concatenate([faces[~is_quad, :3], quads]).astype(np.int64),
        np.concatenate([index[~is_quad], np.repeat(index[is_quad], 2)]),
    )


def _check_landmarks(landmarks, points, template) -> dict[str, NDArray[np.float64]]:
    """Name -> point; missing, unknown and out of range ones are named."""
    if missing := [name for name in REQUIRED if name not in landmarks]:
        raise InvalidInput(f"landmarks lack {', '.join(missing)}")
    if unknown := [name for name in landmarks if name not in template.landmark_names]:
        raise InvalidInput(
            f"there is no landmark {unknown[0]!r}; there are {', '.join(template.landmark_names)}"
        )
    found = {}
    for name, value in landmarks.items():
        place = np.asarray(value)
        if place.shape == () and place.dtype.kind in "iu":
            if not 0 <= int(place) < len(points):
                raise InvalidInput(
                    f"landmark {name} is vertex {int(place)}, the mesh has {len(points)}"
                )
            found[name] = points[int(place)]
        elif place.shape == (3,) and place.dtype.kind in "iuf" and np.isfinite(place).all():
            found[name] = place.astype(np.float64)
        else:
            raise InvalidInput(
                f"landmark {name} is {value!r}: needed is a vertex's index or x, y, z in metres"
            )
    return found


def _check_on_skin(names, targets, points, skin) -> None:
    for name, target in zip(names, targets, strict=True):
        gap = np.sqrt(((points[skin] - target) ** 2).sum(1).min())
        if gap > MAX_OFF_SKIN:
            raise InvalidInput(
                f"landmark {name} lies {1e3 * gap:.0f} mm (on a head of usual size) off the part "
                "that carries most landmarks: put it on the skin, and make the skin one piece"
            )


def _parts(triangles: NDArray[np.int64], num_vertices: int) -> NDArray[np.int64]:
    """The connected part of each vertex, by the smallest vertex in it."""
    label = np.arange(num_vertices)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    while True:
        low = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        before = label.copy()
        for k in (0, 1):  # roots hang on the smaller root, then paths are cut short
            np.minimum.at(label, before[edges[:, k]], low)
        label = label[label]
        while (label != label[label]).any():
            label = label[label]
        if (label == before).all():
            return label
