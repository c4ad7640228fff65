# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head: one neutral adult, the ways in which heads differ, landmarks and regions.

Derived at build time by `scripts/make_face` from MakeHuman's base mesh (CC0). Metres, head frame:
x to the subject's left, y up, z out of the face, origin midway between the tragi, scaled to an
interpupillary distance of 63 mm.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.shared.array_file import ArrayArchive, open_arrays
from mimetic.shared.installed_data import data_folder
from mimetic.shared.shown_text import shortened

# key: (kind of number, shape); letters are lengths that must agree between the keys
KEYS: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "vertices": ("f8", ("V", 3)),
    "faces": ("i4", ("F", 4)),
    "num_skin_vertices": ("i8", ()),
    "num_skin_faces": ("i8", ()),
    "part": ("i1", ("F",)),
    "part_names": ("U", ("P",)),
    "uv": ("f4", ("F", 4, 2)),
    "mirror": ("i4", ("V",)),
    "region": ("i1", ("S",)),
    "region_names": ("U", ("R",)),
    "landmark_names": ("U", ("L",)),
    "landmark_vertices": ("i4", ("L",)),
    "eye_centers": ("f8", (2, 3)),
    "eye_radius": ("f8", ()),
    "jaw_hinge": ("f8", (2, 3)),
    "identity_names": ("U", ("I",)),
    "identity_modes": ("f4", ("I", "V", 3)),
    "identity_limits": ("f8", ("I", 2)),
    "unit_names": ("U", (52,)),
    "unit_modes": ("f4", (52, "V", 3)),
}
LARGEST = {"V": 100_000, "F": 100_000, "S": 100_000, "P": 100, "R": 100, "L": 1000, "I": 1000}


@dataclass(frozen=True, eq=False)
class FaceTemplate:
    """V vertices, F quads, S skin vertices (skin first), L landmarks, I identity modes."""

    vertices: NDArray[np.float64]  # V x 3
    faces: NDArray[np.int32]  # F x 4, wound so that normals point outward
    num_skin_vertices: int
    num_skin_faces: int  # visible skin, then the linings of the mouth and the eye sockets
    part: NDArray[np.int8]  # F, into part_names
    part_names: list[str]
    uv: NDArray[np.float32]  # F x 4 x 2; eyes and lashes as `scripts/build/face/unfold.py` says
    mirror: NDArray[np.int32]  # V, the vertex at the same place on the other side
    region: NDArray[np.int8]  # S, into region_names
    region_names: list[str]
    landmark_names: list[str]  # L, with `.L` and `.R` where there are two
    landmark_vertices: NDArray[np.int32]  # L
    eye_centers: NDArray[np.float64]  # 2 x 3, left first
    eye_radius: float
    jaw_hinge: NDArray[np.float64]  # 2 x 3, the condyles, left first
    identity_names: list[str]  # I; `asym_...` are odd under the mirror, all others even
    identity_modes: NDArray[np.float32]  # I x V x 3, displacement at coefficient 1
    identity_limits: NDArray[np.float64]  # I x 2, range of a plausible coefficient
    unit_names: list[str]  # 52, as in ARKit
    unit_modes: NDArray[np.float32]  # 52 x V x 3, displacement at value 1

    def landmark(self, name: str) -> int:
        """Vertex of a landmark; raises InvalidInput if there is none of that name."""
        return int(self.landmark_vertices[_index(name, self.landmark_names, "landmark")])

    def part_faces(self, *names: str) -> NDArray[np.int64]:
        """Indices of the faces in the named parts."""
        indices = [_index(name, self.part_names, "part") for name in names]
        return np.flatnonzero(np.isin(self.part, indices))

    def part_vertices(self, *names: str) -> NDArray[np.int32]:
        """Indices of the vertices that the faces of the named parts use, ascending."""
        return np.unique(self.faces[self.part_faces(*names)])

    def in_region(self, *names: str) -> NDArray[np.bool_]:
        """S booleans: which skin vertices lie in the named regions."""
        indices = [_index(name, self.region_names, "region") for name in names]
        return np.isin(self.region, indices)

    @cached_property
    def skin_faces(self) -> NDArray[np.int32]:
        """Quads of the whole skin, linings included: one manifold, open at the neck only."""
        return self.faces[: self.num_skin_faces]

    def neutral(self, coefficients: Mapping[str, float]) -> NDArray[np.float64]:
        """Control vertices (V x 3) of a person, by identity mode name -> coefficient."""
        vertices = self.vertices.copy()
        for name, value in coefficients.items():
            if not np.isfinite(value):
                raise InvalidInput(f"identity {name} is {value}; a finite number is needed")
            mode = _index(name, self.identity_names, "identity mode")
            vertices += float(value) * self.identity_modes[mode]
        return vertices

    def eye_spheres(self, vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Centres (2 x 3, left first) and mean radius of the eyeballs of a neutral (V x 3)."""
        spheres = [
            _core.nearest_sphere(vertices[self.part_vertices(name)]) for name in ("eye.L", "eye.R")
        ]
        return np.array([s[0] for s in spheres]), float(np.mean([s[1] for s in spheres]))


def load_template(path: str | os.PathLike | None = None) -> FaceTemplate:
    """The installed head, or the one in a file.

    Raises UnreadableMedia if there is no such file or it is damaged, InvalidInput if it is not a
    face template.
    Loading the same unchanged file again returns the same object; its arrays are read-only.
    """
    path = Path(path) if path is not None else data_folder() / "face.npz"
    try:
        modification_time = path.stat().st_mtime_ns
    except OSError as error:
        raise UnreadableMedia(
            f"{path}: {error.strerror}; scripts/make_face derives it, then build the package again"
        ) from None
    return _load(path.resolve(), modification_time)


@lru_cache(maxsize=2)
def _load(path: Path, _modification_time: int) -> FaceTemplate:
    with open_arrays(path, "a face template") as archive:
        lengths = _check_headers(archive)
        arrays = archive.read({key: None for key in KEYS})
    for array in arrays.values():
        array.flags.writeable = False
    values: dict[str, Any] = dict(arrays)
    for key, (kind, shape) in KEYS.items():
        if kind == "U":
            values[key] = [str(name) for name in values[key]]
        elif shape == ():
            values[key] = values[key].item()
    template = FaceTemplate(**{field.name: values[field.name] for field in fields(FaceTemplate)})
    try:
        _check(template, lengths)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None
    return template


def _check_headers(archive: ArrayArchive) -> dict[str, int]:
    """Keys, types and agreeing shapes, before any array is read."""
    headers = archive.headers
    if missing := [key for key in KEYS if key not in headers]:
        raise InvalidInput(f"face template lacks {', '.join(missing)}; run scripts/make_face")
    lengths: dict[str, int] = {}
    for key, (kind, shape) in KEYS.items():
        header = headers[key]
        matches = header.dtype.kind == "U" if kind == "U" else header.dtype == np.dtype(kind)
        if not matches or len(header.shape) != len(shape):
            raise InvalidInput(
                f"face template {key} is {header.dtype} {header.shape}, expected {kind} {shape}"
            )
        for length, name in zip(header.shape, shape, strict=True):
            length_needed = lengths.setdefault(name, length) if isinstance(name, str) else name
            limit = LARGEST.get(str(name), length_needed)
            if length != length_needed or length > limit:
                raise InvalidInput(
                    f"face template {key} has shape {header.shape}, expected {shape}"
                    f" with {name} = {min(length_needed, limit)}"
                )
    return lengths


def _check(template: FaceTemplate, lengths: Mapping[str, int]) -> None:
    for key, (kind, _) in KEYS.items():
        value = getattr(template, key)
        if kind.startswith("f") and not np.isfinite(value).all():
            raise InvalidInput(f"face template {key} is not finite")
        if kind == "U" and len(set(value)) != len(value):
            raise InvalidInput(f"face template {key} names something twice")
    skin, vertices = template.num_skin_vertices, lengths["V"]
    if not 0 < template.num_skin_faces <= lengths["F"] or skin != lengths["S"] or skin > vertices:
        raise InvalidInput("face template's skin counts do not fit its arrays")
    for key, limit in (
        ("faces", vertices),
        ("mirror", vertices),
        ("landmark_vertices", skin),
        ("part", lengths["P"]),
        ("region", lengths["R"]),
    ):
        array = getattr(template, key)
        if array.size and (array.min() < 0 or array.max() >= limit):
            raise InvalidInput(f"face template {key} must lie in 0 to {limit - 1}")
    if template.skin_faces.max() >= skin:
        raise InvalidInput("face template's skin faces use vertices that are not skin")
    if template.eye_radius <= 0:
        raise InvalidInput(f"face template eye_radius is {template.eye_radius}")
    if (template.identity_limits[:, 0] > template.identity_limits[:, 1]).any():
        raise InvalidInput("face template identity_limits has a lower limit above the upper")


def _index(name: str, names: list[str], what: str) -> int:
    if name not in names:
        raise InvalidInput(f"there is no {what} {name!r}; there are {shortened(', '.join(names))}")
    return names.index(name)
