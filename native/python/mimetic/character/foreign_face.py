# SPDX-License-Identifier: GPL-3.0-or-later
"""Any head's mesh as a face with sliders: what a program that holds it in an object's own frame
needs of `mimetic.character.foreign_head`."""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.character.foreign_head import ForeignHead, attach_foreign
from mimetic.character.foreign_mesh import MAX_VERTICES, REQUIRED
from mimetic.character.head_parts import PartMesh, WornParts, lies_in, shapes_of, with_parts
from mimetic.character.live_contact import LiveContact
from mimetic.character.placement import to_head, to_object
from mimetic.character.polygons import Polygons
from mimetic.character.shapes import Shape, group_shapes, shapes_of_anatomy, shapes_of_extras
from mimetic.shared.progress import Progress
from mimetic.template.face_template import load_template

__all__ = [
    "ForeignFace",
    "PartMesh",
    "Polygons",
    "WornParts",
    "attach_face",
    "guess_landmarks",
    "lies_in",
    "shapes_of",
    "with_parts",
]

KEPT = 2  # heads in memory
Mark = int | tuple[float, ...]  # a vertex, or a place
Marks = tuple[tuple[str, Mark], ...]


@dataclass(frozen=True)
class ForeignFace:
    """Shapes of a head in the head frame's axes (`placement`) and in an object's own unit."""

    head: ForeignHead
    shapes: list[Shape]
    groups: list[Shape]
    object_from_head: NDArray[np.float64]  # 3 x 3, of displacements of the head's own frame
    eye_centers: NDArray[np.float64]  # 2 x 3, left first, the object's frame
    notes: tuple[str, ...]  # of the head, with the numbers of polygons

    def unit_shapes(self) -> tuple[list[Shape], tuple[str, ...]]:
        """ARKit's 52, and what to know of them."""
        units = self.head.make_units()
        shapes = [
            Shape(name, "ARKit", to_head(mode @ self.object_from_head.T), np.zeros(0), 0.0, 1.0)
            for name, mode in zip(units.names, units.modes, strict=True)
        ]
        return shapes, units.notes

    @cached_property
    def live_contact(self) -> LiveContact:
        """Solved on first use."""
        return LiveContact(self.head.make_contact().turned(self.object_from_head))


_cache: dict[
    tuple[bytes, bytes, bytes, Marks, bytes], ForeignFace
] = {}  # the most recently used last
_cache_lock = threading.Lock()


def attach_face(
    points: ArrayLike,
    polygons: Polygons,
    landmarks: Mapping[str, int | ArrayLike],
    metres_from_object: ArrayLike,
    progress: Progress | None = None,
) -> ForeignFace:
    """Muscles, jaw, lids and extras on a mesh; the same one again costs nothing.

    points: V x 3, the object's frame; landmarks: as for `attach_foreign`, places in metres;
    metres_from_object: 4 x 4; progress: False raises KeyboardInterrupt. Raises InvalidInput, naming
    polygons by their numbers.
    """
    # In single precision, as a file of the program's keeps them: found again after it is opened
    marks = tuple((name, _mark(place)) for name, place in sorted(landmarks.items()))
    points = np.ascontiguousarray(points, dtype=np.float64)
    matrix = np.asarray(metres_from_object, dtype=np.float32).astype(np.float64)
    if points.ndim != 2 or len(points) > MAX_VERTICES:
        raise InvalidInput(f"the mesh has {len(points)} vertices, at most are {MAX_VERTICES}")
    starts, corners = (
        np.ascontiguousarray(a, np.int64) for a in (polygons.starts, polygons.corners)
    )
    key = (points.tobytes(), starts.tobytes(), corners.tobytes(), marks, matrix.tobytes())
    with _cache_lock:
        face = _cache.pop(key, None)
    if face is None:
        face = _attach_face(points, Polygons(starts, corners), marks, matrix, progress)
    with _cache_lock:
        _cache[key] = face
        while len(_cache) > KEPT:
            _cache.pop(next(iter(_cache)))  # the least recently used
    return face


def _mark(place: int | ArrayLike) -> Mark:
    values = np.asarray(place)
    return int(values) if values.ndim == 0 else tuple(values.astype(np.float32).tolist())


def _attach_face(
    own: NDArray[np.float64],
    polygons: Polygons,
    marks: Marks,
    metres_from_object: NDArray[np.float64],
    progress: Progress | None,
) -> ForeignFace:
    faces, polygon = polygons.pieces(own)
    vertices, faces, object_from_head = _core.place_mesh(own, faces, metres_from_object)
    landmarks = {
        name: place if isinstance(place, int) else np.array(place) for name, place in marks
    }
    try:
        head = attach_foreign(vertices, faces, landmarks, load_template(), progress)
    except InvalidInput as error:
        raise InvalidInput(_by_polygon(str(error), polygon)) from None

    def in_object(shape: Shape) -> Shape:
        offsets = to_head(shape.offsets @ object_from_head.T)
        return Shape(shape.name, shape.group, offsets, shape.values, shape.lowest, shape.highest)

    anatomy = head.anatomy
    shapes = [*shapes_of_anatomy(anatomy), *shapes_of_extras(head.extras)]
    groups = group_shapes(anatomy.muscle_names, anatomy.groups, anatomy.muscle_modes)
    return ForeignFace(
        head,
        list(map(in_object, shapes)),
        list(map(in_object, groups)),
        object_from_head,
        (head.eye_centers - metres_from_object[:3, 3]) @ object_from_head.T,
        tuple(_by_polygon(note, polygon) for note in head.notes),
    )


def _by_polygon(text: str, polygon: NDArray[np.int32]) -> str:
    """A text that names faces by their row, with the numbers of their polygons."""

    def number(match: re.Match) -> str:
        return match.group(1) + re.sub(
            r"\d+", lambda digits: str(polygon[int(digits.group())]), match.group(2)
        )

    return re.sub(r"\b(faces? )(\d+(?:, \d+)*)", number, text)


def guess_landmarks(points: ArrayLike) -> dict[str, NDArray[np.float64]]:
    """Where the needed landmarks may be on a head that looks along -y with its top in z, metres.

    points: V x 3. A start for the hand: the template's own landmarks, moved and scaled to the top
    and the front of the head, each on the vertex next to it.
    """
    template = load_template()
    usual = to_object(template.vertices[: int(template.num_skin_vertices)])
    places = usual[[template.landmark(name) for name in REQUIRED]]
    nose = REQUIRED.index("nose_tip")
    guesses = _core.guess_places(np.asarray(points, dtype=np.float64), usual, places, nose)
    return dict(zip(REQUIRED, guesses, strict=True))
