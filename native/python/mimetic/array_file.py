# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading numpy archives from strangers: headers first, no pickles."""

from __future__ import annotations

import os
import zipfile
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.lib import format as npy

from mimetic import InvalidInput, UnreadableMedia

LARGEST_BYTES = 4 << 30


@dataclass(frozen=True)
class ArrayHeader:
    shape: tuple[int, ...]
    dtype: np.dtype


def read_headers(archive: zipfile.ZipFile) -> dict[str, ArrayHeader]:
    """Shape and type of every array of an .npz, without reading one; raises InvalidInput."""
    headers = {}
    total = 0
    for member in archive.infolist():
        name, dot, suffix = member.filename.rpartition(".")
        if suffix != "npy" or not dot:
            raise InvalidInput(f"holds {member.filename}, which is not a numpy array")
        if member.flag_bits & 1:
            raise InvalidInput("is encrypted")
        with archive.open(member) as stream:
            headers[name] = header = _read_header(stream, name)
        total += int(np.prod(header.shape, dtype=object)) * header.dtype.itemsize
    if total > LARGEST_BYTES:
        raise InvalidInput(f"claims {total} bytes of arrays; at most {LARGEST_BYTES} are read")
    return headers


def read_array(archive: zipfile.ZipFile, name: str) -> np.ndarray:
    """One array of an .npz whose header has been checked; raises InvalidInput."""
    with archive.open(f"{name}.npy") as stream:
        try:
            return npy.read_array(stream, allow_pickle=False)
        except ValueError as error:
            raise InvalidInput(f"array {name} cannot be read: {error}") from None


def read_arrays(
    archive: zipfile.ZipFile,
    shapes: dict[str, tuple[int | str, ...]],
    kinds: dict[str, str],
    largest: dict[str, int],
) -> dict[str, np.ndarray]:
    """The arrays named in `shapes`, each checked before the first is read; raises InvalidInput.

    kinds: a type's name or kind, by array; without one "f". Named lengths agree between arrays.
    """
    headers = read_headers(archive)
    if missing := sorted(shapes.keys() - headers.keys()):
        raise InvalidInput(f"lacks {', '.join(missing)}")
    lengths: dict[str, int] = {}
    for name, shape in shapes.items():
        header, kind = headers[name], kinds.get(name, "f")
        check_shape(name, header.shape, shape, lengths, largest)
        if kind not in (header.dtype.name, header.dtype.kind):
            raise InvalidInput(f"{name} has the type {header.dtype}, expected {kind}")
    return {name: read_array(archive, name) for name in shapes}


def read_archive(
    path: str | os.PathLike,
    shapes: dict[str, tuple[int | str, ...]],
    kinds: dict[str, str],
    largest: dict[str, int],
) -> dict[str, np.ndarray]:
    """`read_arrays` of a file; raises InvalidInput, and UnreadableMedia for what is no archive."""
    try:
        with zipfile.ZipFile(path) as archive:
            return read_arrays(archive, shapes, kinds, largest)
    except (OSError, zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        raise UnreadableMedia(f"{path}: {error}") from None
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None


def check_shape(
    what: str,
    actual: tuple[int, ...],
    shape: tuple[int | str, ...],
    lengths: dict[str, int],
    largest: dict[str, int],
) -> None:
    """Raises InvalidInput unless `actual` fits `shape` and the named lengths met so far."""
    fits = len(actual) == len(shape)
    for length, wanted in zip(actual, shape, strict=False):
        if isinstance(wanted, str):
            fits &= length <= largest[wanted] and lengths.setdefault(wanted, length) == length
        else:
            fits &= length == wanted
    if not fits:
        expected = " x ".join(str(length) for length in shape)
        known = ", ".join(f"{name} = {length}" for name, length in lengths.items())
        raise InvalidInput(f"{what} has the shape {actual}, expected {expected} ({known})")


def _read_header(stream, name: str) -> ArrayHeader:
    try:
        version = npy.read_magic(stream)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        if version not in ((1, 0), (2, 0)):
            raise ValueError(f"version {version} of the format")
        shape, _, dtype = read(stream)
    except ValueError as error:
        raise InvalidInput(f"array {name} cannot be read: {error}") from None
    if dtype.hasobject or dtype.names is not None:
        raise InvalidInput(f"array {name} holds Python objects, which are never read")
    if any(length < 0 for length in shape):
        raise InvalidInput(f"array {name} claims a negative length")
    return ArrayHeader(tuple(shape), dtype)
