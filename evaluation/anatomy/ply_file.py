# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh from a .ply file (Turk 1994), as text or binary. Files are not trusted: what a header
claims is checked against the file's length before anything is made of it.

Of the elements only `vertex` (x, y, z) and `face` (vertex_indices) are used.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from mimetic.character.foreign_mesh import MAX_VERTICES
from numpy.typing import NDArray

MAX_HEADER = 65_536  # bytes
MAX_CORNERS = 64  # of one polygon
MAX_PROPERTIES = 64  # of one element
LONGEST_LINE = 65_536  # bytes, of a text file
AHEAD = 64  # rows that are looked at for being alike; twice as many each time they are
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
TYPES |= {"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2"}
TYPES |= {"uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}
USED = ("x", "y", "z", "vertex_indices", "vertex_index")


@dataclass(frozen=True)
class Property:
    name: str
    type: str  # numpy's, of the values
    count_type: str = ""  # of a list's length; empty for a single value


@dataclass(frozen=True)
class Element:
    name: str
    count: int
    properties: list[Property]

    def least_bytes(self) -> int:
        """Of one row in a binary file, its lists empty."""
        return sum(np.dtype(p.count_type or p.type).itemsize for p in self.properties)


def parse_ply(content: bytes, where: str) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices V x 3 and faces F x 4, triangles end in -1; polygons of more corners are cut.

    Raises InvalidInput, saying `where`.
    """
    order, elements, start = _header(content, where)
    read = (
        _TextBody(content[start:], where)
        if not order
        else _BinaryBody(content, start, order, where)
    )
    vertices = faces = None
    for element in elements:
        columns = read.element(element)
        if element.name == "vertex":
            single = {p.name for p in element.properties if not p.count_type}
            if missing := [axis for axis in "xyz" if axis not in single]:
                raise InvalidInput(f"{where}: its vertices have no {missing[0]}")
            vertices = np.column_stack([columns[axis] for axis in "xyz"]).astype(np.float64)
            if not np.isfinite(vertices).all():
                raise InvalidInput(f"{where}: its vertices are not finite")
        elif element.name == "face":
            corners = columns.get("vertex_indices", columns.get("vertex_index"))
            whole = {p.name for p in element.properties if p.count_type and p.type[0] in "iu"}
            if not isinstance(corners, list) or not whole & {"vertex_indices", "vertex_index"}:
                raise InvalidInput(f"{where}: its faces have no list vertex_indices")
            faces = _faces(corners, where)
        if vertices is not None and faces is not None:
            break
    if vertices is None or faces is None or not len(vertices) or not len(faces):
        raise InvalidInput(f"{where}: there are no faces in this file; is it a cloud of points?")
    if faces.min() < -1 or faces.max() >= len(vertices):
        raise InvalidInput(f"{where}: a face names a vertex that the file does not have")
    return vertices, faces


def _header(content: bytes, where: str) -> tuple[str, list[Element], int]:
    head, end, _ = content[:MAX_HEADER].partition(b"end_header")
    rest = content[len(head) + len(end) :][:2]
    if not end or not head.startswith(b"ply"):
        raise InvalidInput(f"{where}: not a .ply file")
    start = len(head) + len(end) + (2 if rest == b"\r\n" else 1)
    order, elements = None, []
    for line in head.decode("ascii", errors="replace").splitlines()[1:]:
        words = line.split()
        try:
            if not words or words[0] in ("comment", "obj_info"):
                continue
            if words[0] == "format":
                order = ORDERS[words[1]]
            elif words[0] == "element":
                elements.append(Element(words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                list_property = Property(words[4], TYPES[words[3]], TYPES[words[2]])
                elements[-1].properties.append(list_property)
            elif words[0] == "property":
                elements[-1].properties.append(Property(words[2], TYPES[words[1]]))
            else:
                raise ValueError
        except (KeyError, IndexError, ValueError):
            raise InvalidInput(f"{where}: the header's line {line[:60]!r} cannot be read") from None
    if order is None:
        raise InvalidInput(f"{where}: the header names no format")
    for element in elements:
        names = [p.name for p in element.properties]
        if not names or len(set(names)) != len(names) or len(names) > MAX_PROPERTIES:
            raise InvalidInput(
                f"{where}: {element.name} needs 1 to {MAX_PROPERTIES} properties with names of "
                "their own"
            )
        most = MAX_VERTICES if element.name == "vertex" else 2 * MAX_VERTICES
        room = (len(content) - start) // max(element.least_bytes() if order else 1, 1)
        if not 0 <= element.count <= most:
            raise InvalidInput(f"{where}: {element.count} of {element.name}, at most are {most}")
        if element.count > room:
            raise InvalidInput(
                f"{where}: cut short, it has no room for {element.count} {element.name}"
            )
    return order, elements, start


class _TextBody:
    def __init__(self, body: bytes, where: str) -> None:
        self.stream = io.BytesIO(body)
        self.where = where

    def _words(self) -> Iterator[bytes]:
        """Of the next line that holds any, none at the end."""
        while line := self.stream.readline(LONGEST_LINE):
            if len(line) == LONGEST_LINE:
                raise InvalidInput(f"{self.where}: a line is longer than {LONGEST_LINE} bytes")
            if words := line.split():
                return iter(words)
        return iter(())

    def element(self, element: Element) -> dict:
        """Single values as lists of numbers, lists as lists of lists; of what is used alone."""
        columns: dict[str, list] = {p.name: [] for p in element.properties if p.name in USED}
        for row in range(element.count):
            words = self._words()
            try:
                for p in element.properties:
                    values = self._values(p, words)
                    if p.name in columns:
                        columns[p.name].append(values)
            except (StopIteration, ValueError, OverflowError):
                raise InvalidInput(f"{self.where}: {element.name} {row} cannot be read") from None
        return columns

    @staticmethod
    def _values(p: Property, words: Iterator[bytes]) -> float | list[int]:
        if not p.count_type:
            return float(next(words))
        corners = [int(float(next(words))) for _ in range(int(next(words)))]
        if any(abs(corner) > MAX_VERTICES for corner in corners):
            raise ValueError
        return corners


class _BinaryBody:
    def __init__(self, content: bytes, start: int, order: str, where: str) -> None:
        self.content, self.at, self.order, self.where = content, start, order, where

    def element(self, element: Element) -> dict:
        """Single values as arrays, lists as lists of arrays."""
        lists = [p for p in element.properties if p.count_type]
        if not lists:
            rows = self._rows(element, self._row_type(element, {}))
            return {p.name: rows[p.name] for p in element.properties}
        # Most files have faces of one kind, which are read at once
        columns: dict[str, list] = {p.name: [] for p in element.properties}
        row, ahead = 0, AHEAD
        row_types: dict[tuple[int, ...], np.dtype] = {}
        while row < element.count:
            counts = self._counts(element, row)
            key = tuple(counts.values())
            if key not in row_types:
                row_types[key] = self._row_type(element, counts)
            row_type = row_types[key]
            room = (len(self.content) - self.at) // row_type.itemsize
            left = min(element.count - row, room, ahead)
            rows = np.frombuffer(self.content, row_type, max(left, 0), self.at)
            alike = np.ones(len(rows), bool)
            for p in lists:
                alike &= rows[f"number of {p.name}"] == counts[p.name]
            same = len(rows) if alike.all() else int(np.argmin(alike))
            if same == 0:
                raise InvalidInput(f"{self.where}: cut short in {element.name} {row}")
            for p in element.properties:
                columns[p.name].extend(rows[p.name][:same])
            self.at += same * row_type.itemsize
            row += same
            ahead = 2 * ahead if same == left else AHEAD
        return columns

    def _rows(self, element: Element, row_type: np.dtype) -> NDArray:
        if self.at + element.count * row_type.itemsize > len(self.content):
            raise InvalidInput(f"{self.where}: cut short in {element.name}")
        rows = np.frombuffer(self.content, row_type, element.count, self.at)
        self.at += rows.nbytes
        return rows

    def _row_type(self, element: Element, counts: dict[str, int]) -> np.dtype:
        fields: list = []
        for p in element.properties:
            if p.count_type:
                fields.append((f"number of {p.name}", self.order + p.count_type))
                fields.append((p.name, self.order + p.type, (counts[p.name],)))
            else:
                fields.append((p.name, self.order + p.type))
        return np.dtype(fields)

    def _counts(self, element: Element, row: int) -> dict[str, int]:
        """Lengths of the lists of the next row."""
        counts, at = {}, self.at
        for p in element.properties:
            if p.count_type:
                size = np.dtype(p.count_type).itemsize
                if at + size > len(self.content):
                    raise InvalidInput(f"{self.where}: cut short in {element.name} {row}")
                counts[p.name] = int(
                    np.frombuffer(self.content, self.order + p.count_type, 1, at)[0]
                )
                if not 0 <= counts[p.name] <= MAX_CORNERS:
                    raise InvalidInput(
                        f"{self.where}: {element.name} {row} has a list of {counts[p.name]}"
                    )
                at += size + counts[p.name] * np.dtype(p.type).itemsize
            else:
                at += np.dtype(p.type).itemsize
        return counts


def _faces(corners: list, where: str) -> NDArray[np.int64]:
    counts = np.array([len(face) for face in corners])
    if len(counts) and not 3 <= counts.min() <= counts.max() <= MAX_CORNERS:
        face = int(np.argmax((counts < 3) | (counts > MAX_CORNERS)))
        raise InvalidInput(
            f"{where}: face {face} has {counts[face]} corners, 3 to {MAX_CORNERS} can be"
        )
    if len(counts) and counts.max() <= 4:
        faces = np.full((len(counts), 4), -1, np.int64)
        for count in (3, 4):
            own = np.flatnonzero(counts == count)
            if len(own):
                faces[own, :count] = [corners[i] for i in own]
        wrong = (faces < 0).any(axis=1) & (counts == 4) | (faces[:, :3] < 0).any(axis=1)
        if wrong.any():
            raise InvalidInput(f"{where}: face {int(np.argmax(wrong))} names a vertex below 0")
        return faces
    pieces = []
    for index, face in enumerate(corners):
        if min(face) < 0:
            raise InvalidInput(f"{where}: face {index} names a vertex below 0")
        if len(face) == 4:
            pieces.append(tuple(face))
        else:
            pieces += [(face[0], face[k], face[k + 1], -1) for k in range(1, len(face) - 1)]
    return np.array(pieces, np.int64).reshape(-1, 4)


def read_ply(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    return parse_ply(path.read_bytes(), str(path))
