# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a glTF 2.0 file (.glb, or .gltf with its buffers beside it), as it stands at rest.

Nodes' transforms are applied; skins and animation are not. Files are not trusted: lengths are
checked before anything is made, and buffers are read from the file's own folder alone.
"""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from mimetic import InvalidInput
from mimetic.character.foreign_mesh import MAX_VERTICES
from mimetic.character.gltf import read_chunks
from mimetic.shared.json_file import parse_json
from mimetic.shared.regular_file import check_input
from mimetic.shared.shown_text import shortened
from numpy.typing import NDArray

TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3}
TRIANGLES = 4
MAX_BYTES = 400_000_000
MAX_NODES = 100_000
DEEPEST = 100  # of nodes in nodes


def check_bytes(path: Path) -> None:
    """Raise InvalidInput on a file too large, UnreadableMedia on none."""
    check_input(path, "a mesh")
    if path.stat().st_size > MAX_BYTES:
        raise InvalidInput(f"{path}: larger than {MAX_BYTES // 10**6} MB")


def read_gltf(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices V x 3 and triangles F x 4 that end in -1, of the scene's meshes; metres, y up.

    Raises InvalidInput, OSError.
    """
    content = path.read_bytes()
    try:
        if content[:4] == b"glTF":
            document, binary = read_chunks(content)
        else:
            document, binary = parse_json(content), None
        if not isinstance(document, dict):
            raise InvalidInput("not a glTF file")
        return _Reader(document, binary, path.parent).mesh()
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {shortened(error)}") from None
    except (LookupError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise InvalidInput(
            f"{path}: not a sound glTF file ({type(error).__name__}: {shortened(error)})"
        ) from None


class _Reader:
    def __init__(self, document: dict, binary: bytes | None, folder: Path) -> None:
        extensions = set(document.get("extensionsRequired", []))
        if codecs := sorted(n for n in extensions if "compression" in n or "quantization" in n):
            raise InvalidInput(f"needs {codecs[0]}: export it without compression")
        self.document, self.binary, self.folder = document, binary, folder
        self.buffers: dict[int, bytes] = {}

    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        vertices, faces, count, num_faces, num_primitives = [], [], 0, 0, 0
        for number, matrix in self._placed_meshes():
            for primitive in self.document["meshes"][number]["primitives"]:
                num_primitives += 1
                if num_primitives > MAX_NODES:
                    raise InvalidInput(f"more than {MAX_NODES} primitives")
                if primitive.get("mode", TRIANGLES) != TRIANGLES:
                    continue  # points, lines; strips are no longer written by anything
                points = self._accessor(primitive["attributes"]["POSITION"], "VEC3", "f")
                triangles = (
                    self._accessor(primitive["indices"], "SCALAR", "u").reshape(-1)
                    if "indices" in primitive
                    else np.arange(len(points))
                )
                if len(triangles) % 3 or (len(triangles) and triangles.max() >= len(points)):
                    raise InvalidInput("its triangles name vertices that it does not have")
                triangles = triangles.astype(np.int64).reshape(-1, 3) + count
                if np.linalg.det(matrix[:3, :3]) < 0:
                    triangles = triangles[:, ::-1]
                count += len(points)
                num_faces += len(triangles)
                if count > MAX_VERTICES or num_faces > 2 * MAX_VERTICES:
                    raise InvalidInput(f"more than {MAX_VERTICES} vertices, or twice as many faces")
                vertices.append(points @ matrix[:3, :3].T + matrix[:3, 3])
                faces.append(triangles)
        if not count or not num_faces:
            raise InvalidInput("there are no triangles in this file")
        triangles, points = np.concatenate(faces), np.concatenate(vertices)
        if not np.isfinite(points).all():
            raise InvalidInput("its vertices are not finite")
        return points, np.column_stack([triangles, np.full(len(triangles), -1)])

    def _placed_meshes(self) -> list[tuple[int, NDArray[np.float64]]]:
        """Meshes of the scene shown first, with their matrices."""
        nodes = self.document.get("nodes", [])
        if len(nodes) > MAX_NODES:
            raise InvalidInput(f"more than {MAX_NODES} nodes")
        scenes = self.document.get("scenes", [])
        roots = (
            scenes[self.document.get("scene", 0)].get("nodes", []) if scenes else range(len(nodes))
        )
        meshes, visited_nodes = [], set()
        waiting = [(root, np.eye(4), 0) for root in roots]
        while waiting:
            number, parent, depth = waiting.pop()
            if number in visited_nodes or depth > DEEPEST:
                raise InvalidInput("its nodes contain each other in a circle")
            visited_nodes.add(number)
            matrix = parent @ _matrix(nodes[number])
            if "mesh" in nodes[number]:
                meshes.append((nodes[number]["mesh"], matrix))
            waiting += [(child, matrix, depth + 1) for child in nodes[number].get("children", [])]
        return meshes

    def _accessor(self, index: int, kind: str, sort: str) -> NDArray[np.float64]:
        entry = self.document["accessors"][index]
        dtype = np.dtype(TYPES[entry["componentType"]])
        if entry["type"] != kind or dtype.kind != sort or "sparse" in entry:
            raise InvalidInput(f"accessor {index} is of a kind that is not read")
        view = self.document["bufferViews"][entry["bufferView"]]
        content = self._buffer(view["buffer"])
        width, count = WIDTHS[kind] * dtype.itemsize, entry["count"]
        stride = view.get("byteStride", width)
        start, within = view.get("byteOffset", 0), entry.get("byteOffset", 0)
        whole = all(isinstance(n, int) and n >= 0 for n in (count, stride, start, within))
        if not whole or count > 6 * MAX_VERTICES or stride < width:
            raise InvalidInput(f"accessor {index} has a length that cannot be")
        end = start + within + max(count - 1, 0) * stride + width
        if count and end > min(len(content), start + view["byteLength"]):
            raise InvalidInput(f"accessor {index} reaches beyond its buffer: the file is cut short")
        rows = np.ndarray(
            (count, WIDTHS[kind]), dtype, content, start + within, (stride, dtype.itemsize)
        )
        return rows.astype(np.float64 if sort == "f" else np.int64)

    def _buffer(self, index: int) -> bytes:
        if index not in self.buffers:
            entry = self.document["buffers"][index]
            uri = entry.get("uri")
            if uri is None:
                if self.binary is None or index != 0:
                    raise InvalidInput("a buffer has no content")
                self.buffers[index] = self.binary
            elif uri.startswith("data:"):
                try:
                    self.buffers[index] = base64.b64decode(uri.partition(",")[2], validate=True)
                except binascii.Error:
                    raise InvalidInput("a buffer in the file cannot be read") from None
            else:
                name = unquote(uri)
                if Path(name).name != name or name in ("", ".", ".."):
                    raise InvalidInput(f"buffer {uri[:60]!r} lies outside of the file's folder")
                self.buffers[index] = self._file(self.folder / name)
        return self.buffers[index]

    def _file(self, path: Path) -> bytes:
        if path.is_symlink() or not path.is_file():
            raise InvalidInput(f"buffer {path.name} is not beside the file")
        check_bytes(path)
        return path.read_bytes()


def _matrix(node: dict) -> NDArray[np.float64]:
    """4 x 4, parent from node."""
    if "matrix" in node:
        matrix = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    else:
        x, y, z, w = (float(v) for v in node.get("rotation", (0, 0, 0, 1)))
        turn = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        matrix = np.eye(4)
        matrix[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
        matrix[:3, 3] = np.array(node.get("translation", (0, 0, 0)), dtype=np.float64)
    if not np.isfinite(matrix).all():
        raise InvalidInput("a node's transform is not finite")
    return matrix
