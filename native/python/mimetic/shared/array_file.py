# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading untrusted numpy archives: headers first, no pickles, no more memory than allowed.

An .npz is a zip of .npy files, each a header and numbers. The header is a literal of Python's,
which is matched here and never evaluated; what it claims is compared with the bytes that are there
and with the memory that the converted numbers take, before any is allocated.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import IO, cast

import numpy as np
from numpy.typing import DTypeLike

from mimetic import InvalidInput, UnreadableMedia
from mimetic.shared.regular_file import check_input
from mimetic.shared.shown_text import shortened

LARGEST_BYTES = 2 << 30  # of a file, and of its arrays as they are kept in memory
MOST_ARRAYS = 1000
LONGEST_HEADER = 10_000  # bytes, as numpy allows
LONGEST_TEXT = 1024  # characters
LONGEST_NAME = 60  # bytes; Blender cuts longer ones
LARGEST_NUMBER = 1e15  # products of two still have a square
AT_ONCE = 1 << 20  # bytes read from the file; the list of an archive's contents is no longer
LAST_CHARACTER = 0x10FFFF
COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # what numpy writes
# What zipfile and zlib raise for archives that are damaged, or built to look as if they were not
DAMAGE = (
    *(OSError, zipfile.BadZipFile, zlib.error, EOFError, struct.error),
    *(ValueError, KeyError, IndexError, OverflowError, RuntimeError),
)

HEADER_LENGTHS = {b"\1\0": "<H", b"\2\0": "<I", b"\3\0": "<I"}  # version: how its length is written
DESCR = r"""['"]descr['"]\s*:\s*(?P<descr>'[^'\\]{1,40}'|"[^"\\]{1,40}"|\[.*\])"""
ORDER = r"""['"]fortran_order['"]\s*:\s*(?P<order>True|False)"""
SHAPE = r"""['"]shape['"]\s*:\s*\((?P<shape>(?:\d{1,15}\s*,\s*)+(?:\d{1,15}\s*)?|)\)"""
ITEM = re.compile(rf"\s*(?:{DESCR}|{ORDER}|{SHAPE})\s*(?:,|(?=\}}))", re.DOTALL)
TYPE = re.compile(r"[<>|=]?(?:b1|[iu][1248]|f[248]|U\d{1,4})")


@dataclass(frozen=True)
class ArrayHeader:
    shape: tuple[int, ...]
    dtype: np.dtype
    fortran_order: bool
    length: int  # bytes before the numbers

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    def bytes_as(self, dtype: DTypeLike | None = None) -> int:
        """What the array takes in memory, converted to a type if one is given."""
        return self.count * max(self.dtype.itemsize, np.dtype(dtype or self.dtype).itemsize)


class ArrayArchive:
    """The arrays of an .npz: their headers, all checked, and what they hold when it is asked for.

    Errors are InvalidInput for what the file claims, UnreadableMedia for damage; neither names it.
    """

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        self._members: dict[str, zipfile.ZipInfo] = {}
        self.headers: dict[str, ArrayHeader] = {}
        members = archive.infolist()
        if len(members) > MOST_ARRAYS:
            raise InvalidInput(f"holds {len(members)} arrays; at most {MOST_ARRAYS} are read")
        for member in members:
            self._add(member)
        self._check_bytes({name: None for name in self.headers})

    def _add(self, member: zipfile.ZipInfo) -> None:
        name, dot, suffix = member.filename.rpartition(".")
        if suffix != "npy" or not dot:
            raise InvalidInput(f"holds {member.filename}, which is not a numpy array")
        if name in self.headers:
            raise InvalidInput(f"holds the array {name} twice")
        if member.flag_bits & 1:
            raise InvalidInput("is encrypted")
        if member.compress_type not in COMPRESSIONS:
            raise InvalidInput(
                f"array {name} is compressed in a way that is not read; numpy.savez_compressed "
                "writes what is"
            )
        with _damage_told(), self._archive.open(member) as stream:
            header = _read_header(stream, name)
        size = header.length + header.bytes_as()
        if size != member.file_size:
            raise InvalidInput(
                f"array {name} claims {size} bytes of arrays and their header; the file has "
                f"{member.file_size}"
            )
        self._members[name], self.headers[name] = member, header

    def _check_bytes(self, dtypes: Mapping[str, DTypeLike | None]) -> None:
        total = sum(self.headers[name].bytes_as(dtype) for name, dtype in dtypes.items())
        if total > LARGEST_BYTES:
            raise InvalidInput(
                f"claims {total} bytes of arrays as they are kept; at most {LARGEST_BYTES} are read"
            )

    def read(self, dtypes: Mapping[str, DTypeLike | None]) -> dict[str, np.ndarray]:
        """The arrays named, each converted to its type if it has one.

        Nothing is read if they would take more than LARGEST_BYTES together.
        """
        self._check_bytes(dtypes)
        return {name: self.read_one(name, dtype) for name, dtype in dtypes.items()}

    def read_one(self, name: str, dtype: DTypeLike | None = None) -> np.ndarray:
        header = self.headers[name]
        numbers = np.empty(header.count, header.dtype)
        content = numbers.view(np.uint8).data if header.bytes_as() else memoryview(b"")
        with _damage_told(), self._archive.open(self._members[name]) as stream:
            stream.read(header.length)
            for start in range(0, len(content), AT_ONCE):
                chunk = content[start : start + AT_ONCE]
                if cast(zipfile.ZipExtFile, stream).readinto(chunk) != len(chunk):
                    raise EOFError(f"array {name} is cut short")
        if header.fortran_order:
            numbers = numbers.reshape(header.shape[::-1]).transpose()
        else:
            numbers = numbers.reshape(header.shape)
        return _converted(name, numbers, dtype)


@contextlib.contextmanager
def open_arrays(
    path: str | os.PathLike, what: str = "an archive of arrays"
) -> Iterator[ArrayArchive]:
    """The arrays of a file; errors in the block, too, get the file's name.

    what: the file is supposed to be. Raises UnreadableMedia, InvalidInput.
    """
    check_input(path, what)
    try:
        with contextlib.ExitStack() as stack:
            stream = stack.enter_context(_FrugalFile(path))
            if os.fstat(stream.fileno()).st_size > LARGEST_BYTES:
                raise InvalidInput(f"is larger than {LARGEST_BYTES} bytes")
            archive = stack.enter_context(_opened_zip(stream))
            yield ArrayArchive(archive)
    except _Damage as error:
        raise UnreadableMedia(f"{path} is not {what} or is damaged ({shortened(error)})") from None
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {shortened(error)}") from None


def read_archive(
    path: str | os.PathLike,
    shapes: dict[str, tuple[int | str, ...]],
    kinds: dict[str, str],
    largest: dict[str, int],
) -> dict[str, np.ndarray]:
    """The arrays named in `shapes`, each checked before the first is read.

    kinds: a type's name or kind, by array; without one "f". Named lengths agree between arrays.
    Raises InvalidInput, and UnreadableMedia for what is no archive.
    """
    with open_arrays(path) as archive:
        if missing := sorted(shapes.keys() - archive.headers.keys()):
            raise InvalidInput(f"lacks {', '.join(missing)}")
        lengths: dict[str, int] = {}
        for name, shape in shapes.items():
            header, kind = archive.headers[name], kinds.get(name, "f")
            check_shape(name, header.shape, shape, lengths, largest)
            if kind not in (header.dtype.name, header.dtype.kind):
                raise InvalidInput(f"{name} has the type {header.dtype}, expected {kind}")
        return archive.read({name: None for name in shapes})


def check_shape(
    what: str,
    actual: tuple[int, ...],
    shape: tuple[int | str, ...],
    lengths: dict[str, int],
    largest: dict[str, int],
) -> None:
    """Raises InvalidInput unless `actual` fits `shape` and the named lengths met so far."""
    fits = len(actual) == len(shape)
    for length, side in zip(actual, shape, strict=False):
        if isinstance(side, str):
            fits &= length <= largest[side] and lengths.setdefault(side, length) == length
        else:
            fits &= length == side
    if not fits:
        shape_text = " x ".join(str(length) for length in shape)
        lengths_text = ", ".join(f"{name} = {length}" for name, length in lengths.items())
        raise InvalidInput(f"{what} has the shape {actual}, expected {shape_text} ({lengths_text})")


def is_bounded(numbers: np.ndarray) -> bool:
    """Whether all are finite and no larger than anything that is measured."""
    # As Python's floats: numpy 2 makes the limit a half, and so infinite, beside an array of halves
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 0.0)
    return bool(low >= -LARGEST_NUMBER and high <= LARGEST_NUMBER)  # False for nan, too


def check_names(what: str, names: list[str]) -> None:
    """Raises InvalidInput unless the names are distinct, and such as can be shown and looked up."""
    for name in names:
        if not name or not name.isprintable() or len(name.encode()) > LONGEST_NAME:
            raise InvalidInput(
                f"{what} holds the name {name[:80]!r}; needed are 1 to {LONGEST_NAME} bytes that "
                "can be printed"
            )
    if len(set(names)) != len(names):
        raise InvalidInput(f"{what} must have distinct names")


class _Damage(Exception):
    """The archive is damaged; becomes UnreadableMedia where its path is known."""


class _FrugalFile(io.FileIO):
    """A file of which no more is read at once than is needed, whatever an archive's end claims."""

    def read(self, size: int | None = -1) -> bytes:
        if size is None or size < 0:
            size = os.fstat(self.fileno()).st_size - self.tell()
        if size > AT_ONCE:
            raise zipfile.BadZipFile("its list of contents is too long")
        return super().read(size) or b""


@contextlib.contextmanager
def _damage_told() -> Iterator[None]:
    try:
        yield
    except InvalidInput:
        raise
    except DAMAGE as error:
        raise _Damage(str(error) or type(error).__name__) from None


def _opened_zip(stream: io.FileIO) -> zipfile.ZipFile:
    with _damage_told():
        return zipfile.ZipFile(stream)


def _read_header(stream: IO[bytes], name: str) -> ArrayHeader:
    """Of the format that numpy.lib.format describes; Python's syntax only as numpy writes it."""
    start = stream.read(8)
    length_type = HEADER_LENGTHS.get(start[6:8]) if start[:6] == b"\x93NUMPY" else None
    if length_type is None:
        raise InvalidInput(f"array {name} cannot be read: not a .npy file of version 1 to 3")
    size = struct.calcsize(length_type)
    (length,) = struct.unpack(length_type, stream.read(size))
    if length > LONGEST_HEADER:
        raise InvalidInput(f"array {name} cannot be read: its header has {length} bytes")
    text = stream.read(length).decode("utf-8").strip()
    items: dict[str, str] = {}
    at = 1
    while match := ITEM.match(text, at):
        items |= {key: value for key, value in match.groupdict().items() if value is not None}
        at = match.end()
    if text[:1] != "{" or text[at:].strip() != "}" or items.keys() != {"descr", "order", "shape"}:
        raise InvalidInput(f"array {name} cannot be read: its header is {text[:80]!r}")
    shape = tuple(int(number) for number in items["shape"].split(",") if number.strip())
    dtype = _checked_type(name, items["descr"])
    return ArrayHeader(shape, dtype, items["order"] == "True", 8 + size + length)


def _checked_type(name: str, text: str) -> np.dtype:
    descr = text[1:-1]
    if text[0] == "[" or descr.lstrip("<>|=").startswith("O"):
        raise InvalidInput(f"array {name} holds Python objects, which are never read")
    if not TYPE.fullmatch(descr):
        raise InvalidInput(f"array {name} has the type {descr!r}; numbers and texts are read")
    dtype = np.dtype(descr)
    if dtype.kind == "U" and not 0 < dtype.itemsize <= 4 * LONGEST_TEXT:
        raise InvalidInput(f"array {name} holds texts of {dtype.itemsize // 4} characters")
    return dtype


def _converted(name: str, array: np.ndarray, dtype: DTypeLike | None) -> np.ndarray:
    """In the machine's byte order, and as `dtype`; infinite where that cannot hold a number."""
    kind = array.dtype.kind
    if kind == "U":
        codes = np.ascontiguousarray(array).view(array.dtype.str[0] + "u4")
        if array.size and codes.max() > LAST_CHARACTER:
            raise InvalidInput(f"array {name} holds characters that there are not")
    if kind == "b":
        array = array.view(np.uint8) != 0  # any other byte would be neither true nor false
    target = np.dtype(dtype or array.dtype).newbyteorder("=")
    if kind == "u" and target.kind == "i" and array.size and array.max() > np.iinfo(target).max:
        raise InvalidInput(f"array {name} holds numbers above {np.iinfo(target).max}")
    with np.errstate(over="ignore", invalid="ignore"):
        return array.astype(target, copy=False)
