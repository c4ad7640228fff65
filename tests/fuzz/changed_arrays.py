# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of an .npz: what headers claim, what the arrays hold, how the archive is built."""

from __future__ import annotations

import io
import math
import re
import struct
import warnings
import zipfile
from random import Random

import numpy as np

from fuzz.changed_bytes import change_bytes, change_text

NUMBERS = (
    "-1",
    "0",
    "1",
    "2",
    "True",
    "None",
    "1.5",
    "1e9",
    "'x'",
    "[1]",
    "99999999",
    "9" * 400,
    "9" * 5000,
)
NUMBERS += ("(1,)", "1L", "0x5", "1_0", "2147483648", "4294967297", "1000000000000000")
TYPES = (
    "|O",
    "<f2",
    ">f8",
    "<c16",
    "<M8[s]",
    "|S5",
    "|V8",
    "<U9",
    "<U0",
    "<i8",
    "|i1",
    "|b1",
    "<f16",
    "<u8",
)
TYPES += ("<U99999", "<f4", "<U1", "|S99999999999", "=f8", "f8", "object", "x")
HEADERS = (
    *(
        "",
        "{",
        "}",
        "[1, 2]",
        "{}",
        "(" * 3000,
        "{" * 90,
        "None",
        "{b'descr': '<f8', b'shape': (1,)}",
    ),
    "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,), }",
    "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), 'more': 1}",
    "{'descr': '<f8', 'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
)
FLOATS = (np.nan, np.inf, -np.inf, -1.0, 0.0, 1e300, -1e300, 1e-320, 1e16, 2.0, 1e9)
WHOLE = (0, -1, 1, 127, -128, 2**31, -(2**31), 2**53 + 1, 2**63 - 1, -(2**63))
CODES = (0, 0x1B, 0x202E, 0xD800, 0xDFFF, 0x10FFFF, 0x110000, 0xFFFFFFFF, 0x0A, 0x7F, 0x301)
KEPT_AS = ("f2", "f4", ">f8", "i1", "u1", "i2", ">i4", "u8", "b1", "U3", "c8", "f8", "i8")
NAMES = ("../x.npy", "x.txt", "x", ".npy", "é.npy", "\x1b[2J.npy", "a/b.npy", "x" * 300 + ".npy")
PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)

Members = list[tuple[str, bytes]]


def change_arrays(content: bytes, random: Random) -> bytes:
    """One or two changes of an .npz."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = [(name, archive.read(name)) for name in archive.namelist()]
    changes = (_change_header, _change_numbers, _change_kind, _change_shape, _change_members)
    for _ in range(random.choice((1, 1, 2))):
        at = random.randrange(len(members))
        random.choice(changes)(members, at, random)
        if not members:
            break
    result = _packed(members, random)
    return change_bytes(result, random) if random.random() < 0.1 else result


def _packed(members: Members, random: Random) -> bytes:
    usual = random.random() < 0.8
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of names that are there twice
        with zipfile.ZipFile(stream, "w") as archive:
            for name, content in members:
                how = zipfile.ZIP_DEFLATED if usual else random.choice(PACKED)
                entry = zipfile.ZipInfo(name)  # of no time, so that a seed makes the same file
                entry.compress_type = how
                archive.writestr(entry, content, compresslevel=1)
    result = bytearray(stream.getvalue())
    if random.random() < 0.1:  # flags, compression or sizes of one entry of the list
        entries = [match.start() for match in re.finditer(b"PK\x01\x02", result)]
        at = random.choice(entries or [0]) + random.choice((8, 10, 16, 20, 24, 28, 30, 42))
        result[at : at + 2] = random.randbytes(2)
    return bytes(result)


def _parted(content: bytes) -> tuple[str, bytes]:
    """Header and numbers of an .npy."""
    if content[:8] != b"\x93NUMPY\x01\x00":
        return "", content
    (length,) = struct.unpack_from("<H", content, 8)
    return content[10 : 10 + length].decode("latin-1"), content[10 + length :]


def _joined(header: str, numbers: bytes, version: int = 1) -> bytes:
    text = header.encode("utf-8", errors="replace")
    length = struct.pack("<H" if version == 1 else "<I", min(len(text), 65535))
    return b"\x93NUMPY" + bytes([version, 0]) + length + text[:65535] + numbers


def _change_header(members: Members, at: int, random: Random) -> None:
    name, content = members[at]
    header, numbers = _parted(content)
    kind = random.randrange(6)
    result = list(re.finditer(r"(?<=[(, ])\d+", header))
    if kind < 2 and result:
        match = random.choice(result)
        header = header[: match.start()] + random.choice(NUMBERS) + header[match.end() :]
    elif kind == 2:
        header = re.sub(r"'[<>|=][^']*'", repr(random.choice(TYPES)), header, count=1)
    elif kind == 3:
        header = header.replace("False", random.choice(("True", "1", "None", "'no'", "[]")))
    elif kind == 4:
        header = random.choice(HEADERS)
    else:
        header = change_text(header.encode(), random).decode("utf-8", errors="replace")
    members[at] = name, _joined(header, numbers, random.choice((1, 1, 1, 2, 3, 4, 0)))


def _array(content: bytes) -> np.ndarray | None:
    try:
        return np.load(io.BytesIO(content), allow_pickle=False)
    except Exception:  # changed before; numpy's own reader fails in many ways
        return None


def _stored(members: Members, at: int, array: np.ndarray) -> None:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=False)
    members[at] = members[at][0], stream.getvalue()


def _change_numbers(members: Members, at: int, random: Random) -> None:
    array = _array(members[at][1])
    if array is None or not array.size or array.dtype.kind not in "fiuUb":
        return
    array = np.ascontiguousarray(array).copy()
    kind = array.dtype.kind
    flat = array.reshape(-1)
    if kind == "U":
        flat = flat.view("<u4")
    elif kind == "b":
        flat = flat.view("u1")
    chosen = {"f": FLOATS, "U": CODES, "b": (2, 255, 0, 1)}.get(kind, WHOLE)
    value = random.choice(chosen)
    some = random.choice((1, 1, 3, flat.size))
    with np.errstate(all="ignore"):
        number = np.array(value, "f8" if kind == "f" else "i8").astype(flat.dtype)
    flat[[random.randrange(flat.size) for _ in range(min(some, 1000))]] = number
    if some == flat.size:
        flat[:] = number
    _stored(members, at, array)


def _change_kind(members: Members, at: int, random: Random) -> None:
    array = _array(members[at][1])
    if array is None:
        return
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            array = array.astype(random.choice(KEPT_AS))
    except (ValueError, TypeError):
        return
    _stored(members, at, np.asfortranarray(array) if random.random() < 0.3 else array)


def _change_shape(members: Members, at: int, random: Random) -> None:
    array = _array(members[at][1])
    if array is None:
        return
    kind = random.randrange(6)
    if kind == 0:
        array = array[None]
    elif kind == 1 and array.ndim:
        array = array[: random.randrange(len(array) + 1)]
    elif kind == 2 and array.ndim:
        array = np.concatenate([array, array])
    elif kind == 3:
        array = array.reshape(-1)
    elif kind == 4:
        array = array.transpose()
    else:  # more than there is, and true: zeros that deflate
        length = random.choice((10, 1000, 100_000))
        dtype = np.dtype(random.choice(("i1", array.dtype.str)))
        shape = (length, *array.shape[1:])
        if math.prod(shape) * dtype.itemsize > 50_000_000:
            return
        array = np.zeros(shape, dtype)
    _stored(members, at, array)


def _change_members(members: Members, at: int, random: Random) -> None:
    name, content = members[at]
    kind = random.randrange(6)
    if kind == 0:
        del members[at]
    elif kind == 1:
        members.append((name, content))
    elif kind == 2:
        members[at] = random.choice(NAMES), content
    elif kind == 3:
        other = random.randrange(len(members))
        members[at], members[other] = (name, members[other][1]), (members[other][0], content)
    elif kind == 4:
        members.append((random.choice(NAMES), content))
    else:
        members[at] = name, change_bytes(content, random)
