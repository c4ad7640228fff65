# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as a file of timed OSC bundles: what a live session sends by VMC, to be sent later.

As OSC 1.0 has packets in a stream, and scores of SuperCollider: each bundle behind its size, a
32-bit integer, big-endian; time tags count from the clip's first frame, seconds in the upper 32
bits and parts of a second in the lower.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.puppet.osc import BUNDLE, bundles, vmc_messages
from mimetic.retarget.unit_fit import unit_values
from mimetic.shared.regular_file import check_input
from mimetic.shared.whole_file import whole_file

LARGEST = 2_000_000_000  # bytes
TAG = 2.0**32  # of a second
LONGEST_MESSAGE = 65536  # bytes

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class TimedMessage:
    """seconds: from the clip's first frame; values: texts, integers and floats."""

    seconds: float
    address: str
    values: tuple[str | int | float, ...]


def write_osc(performance: Performance, path: str | os.PathLike[str]) -> str:
    """Writes the file, whole or not at all; returns what is in it.

    Raises InvalidInput for a performance that is not of the canonical mesh.
    """
    names = [*performance.muscles, *performance.articulators]
    values = np.hstack([performance.activations, performance.articulator_values])
    return _write(performance, unit_values(performance), names, values, path)


def write_control_osc(
    performance: Performance, names: Sequence[str], values: Floats, path: str | os.PathLike[str]
) -> str:
    """The same of a character's own controls (N x K) alone, by their names."""
    return _write(performance, [None] * len(values), names, values, path)


def _write(
    performance: Performance,
    weights: Sequence[Floats | None] | Floats,
    names: Sequence[str],
    values: Floats,
    path: str | os.PathLike[str],
) -> str:
    seconds = (np.asarray(performance.frame) - 1) / performance.fps
    poses = np.asarray(performance.head_pose)
    count = 0
    with whole_file(Path(path)) as stream:
        for time, pose, weight, row in zip(seconds, poses, weights, values, strict=True):
            messages = vmc_messages(pose, weight, names, row, float(time))
            count += len(messages)
            for bundle in bundles(messages, round(float(time) * TAG)):
                stream.write(struct.pack("!i", len(bundle)) + bundle)
    return f"{len(seconds)} frames of {count // max(1, len(seconds))} OSC messages"


def read_osc(path: str | os.PathLike[str]) -> list[TimedMessage]:
    """The messages of a file, in their order. Raises InvalidInput."""
    path = Path(path)
    check_input(path, "a file of OSC bundles")
    if path.stat().st_size > LARGEST:
        raise InvalidInput(f"{path}: larger than {LARGEST / 1e9:.0f} GB")
    messages: list[TimedMessage] = []
    number = 0
    with path.open("rb") as stream:
        try:
            while head := stream.read(4):
                number += 1
                (size,) = struct.unpack("!i", head)
                if not 16 <= size <= LONGEST_MESSAGE or size % 4:
                    raise ValueError(f"of {size} bytes")
                bundle = stream.read(size)
                if len(bundle) < size or bundle[:8] != BUNDLE:
                    raise ValueError("cut short" if len(bundle) < size else "no OSC bundle")
                messages += _messages(bundle)
        except (ValueError, struct.error, IndexError) as error:
            raise InvalidInput(f"{path}: bundle {number}: {error}") from None
    return messages


def _messages(bundle: bytes) -> list[TimedMessage]:
    (tag,) = struct.unpack_from("!Q", bundle, 8)
    messages, at = [], 16
    while at < len(bundle):
        (size,) = struct.unpack_from("!i", bundle, at)
        at += 4
        if size <= 0 or size % 4 or at + size > len(bundle):
            raise ValueError(f"a message of {size} bytes")
        address, values = _message(bundle[at : at + size])
        messages.append(TimedMessage(tag / TAG, address, values))
        at += size
    return messages


def _message(body: bytes) -> tuple[str, tuple[str | int | float, ...]]:
    address, at = _text(body, 0)
    tags, at = _text(body, at)
    values: list[str | int | float] = []
    if not address.startswith("/") or not tags.startswith(","):
        raise ValueError("a message without an address or types")
    for kind in tags[1:]:
        if kind == "s":
            text, at = _text(body, at)
            values.append(text)
        elif kind in "if":
            values.append(struct.unpack_from(f"!{kind}", body, at)[0])
            at += 4
        else:
            raise ValueError(f"a value of type {kind!r}")
    return address, tuple(values)


def _text(body: bytes, at: int) -> tuple[str, int]:
    end = body.index(b"\0", at)
    return body[at:end].decode("utf-8", errors="replace"), end + 4 - end % 4
