# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of any head from files, .obj, .ply, .glb or .gltf. Files are not trusted."""

from __future__ import annotations

from functools import partial
from math import isfinite
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, UnreadableMedia
from mimetic.character.foreign_mesh import MAX_VERTICES
from mimetic.character.landmarks_file import LONGEST_LINE
from numpy.typing import NDArray

from evaluation.anatomy.gltf_mesh import check_bytes, read_gltf
from evaluation.anatomy.ply_file import read_ply

MAX_CORNERS = 64  # of one polygon


def read_mesh(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices V x 3 and faces F x 4 of a file, by its suffix; triangles end in -1.

    Raises UnreadableMedia, InvalidInput.
    """
    if path.suffix.lower() not in READERS:
        raise InvalidInput(f"{path}: meshes are read from {', '.join(READERS)} files")
    try:
        check_bytes(path)
        return READERS[path.suffix.lower()](path)
    except UnreadableMedia:
        raise
    except OSError as error:
        raise UnreadableMedia(f"{path}: {error.strerror}") from None


def read_obj(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices V x 3 and faces F x 4 of all objects in the file; triangles end in -1.

    Polygons of more than four corners are cut into triangles, which count as faces of their own.
    Raises UnreadableMedia, InvalidInput naming the line.
    """
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    try:
        check_bytes(path)
        with path.open(encoding="utf-8", errors="replace") as stream:
            for number, line in enumerate(iter(partial(stream.readline, LONGEST_LINE), ""), 1):
                where = f"{path}, line {number}"
                if len(line) == LONGEST_LINE:
                    raise InvalidInput(f"{where}: longer than {LONGEST_LINE} characters")
                _read_line(line, vertices, faces, where)
    except UnreadableMedia:
        raise
    except OSError as error:
        raise UnreadableMedia(f"{path}: {error.strerror}") from None
    if not vertices or not faces:
        raise InvalidInput(f"{path}: there are no faces in this file; is it a Wavefront .obj?")
    index = np.array(faces, dtype=np.int64)
    if index.max() >= len(vertices):
        raise InvalidInput(f"{path}: a face names a vertex that the file does not have")
    return np.array(vertices), index


def _read_line(line: str, vertices: list, faces: list, where: str) -> None:
    words = line.split("#", 1)[0].split()
    if not words or words[0] not in ("v", "f"):
        return
    try:
        if words[0] == "v":
            x, y, z = (float(word) for word in words[1:4])
            if not all(map(isfinite, (x, y, z))):
                raise ValueError
            vertices.append((x, y, z))
        else:
            # No number of a vertex has twenty digits
            corners = [int(word.split("/", 1)[0][:20]) for word in words[1:]]
    except ValueError:
        raise InvalidInput(f"{where}: {line.strip()[:60]!r} cannot be read") from None
    if len(vertices) > MAX_VERTICES or len(faces) > 2 * MAX_VERTICES:
        raise InvalidInput(
            f"{where}: the mesh has more than {MAX_VERTICES} vertices or twice that many faces"
        )
    if words[0] == "f":
        faces.extend(_pieces(corners, len(vertices), where))


def _pieces(corners: list[int], count: int, where: str) -> list[tuple[int, ...]]:
    """A polygon with indices from 1, or from the end if negative, as quads and triangles."""
    if not 3 <= len(corners) <= MAX_CORNERS:
        raise InvalidInput(f"{where}: a face has {len(corners)} corners, 3 to {MAX_CORNERS} can be")
    index = [corner - 1 if corner > 0 else count + corner for corner in corners]
    if 0 in corners or min(index) < 0 or max(index) >= MAX_VERTICES:
        raise InvalidInput(f"{where}: a face names a vertex that the file does not have")
    if len(index) == 4:
        return [tuple(index)]
    return [(index[0], index[k], index[k + 1], -1) for k in range(1, len(index) - 1)]


READERS = {".obj": read_obj, ".ply": read_ply, ".glb": read_gltf, ".gltf": read_gltf}
