# SPDX-License-Identifier: GPL-3.0-or-later
"""OSC bundles of the VMC protocol: the head as a bone, blend shapes, then Apply."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic.performance.gaze import GAZE
from mimetic.performance.head_turn import head_turn, quaternion
from mimetic.retarget.unit_fit import unit_order

LARGEST_BUNDLE = 1400  # bytes: a datagram that no network on the way has to split
BUNDLE = b"#bundle\0"
AT_ONCE = 1  # time tag

Floats = NDArray[np.float64]


def vmc_messages(
    head_pose: Floats, weights: Floats | None, names: Sequence[str], values: Floats, seconds: float
) -> list[bytes]:
    """One state of a face as the VMC protocol has it.

    head_pose: 4 x 4, camera from head; weights: 52, in the order of `unit_order`, sent under
    ARKit's names with a capital, as avatars made for face tracking have them, None for a character
    of other names; values: by name, sent under these, but for gaze, which the weights have.
    """
    w, x, y, z = quaternion(head_turn(head_pose)).tolist()
    # Unity's axes are left-handed, and avatars look along z: x is mirrored
    messages = [message("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, x, -y, -z, w)]
    units = () if weights is None else zip(unit_order(), weights, strict=True)
    blends = [(name[0].upper() + name[1:], float(weight)) for name, weight in units]
    blends += [(n, float(v)) for n, v in zip(names, values, strict=True) if n not in GAZE]
    messages += [message("/VMC/Ext/Blend/Val", name, value) for name, value in blends]
    messages.append(message("/VMC/Ext/Blend/Apply"))
    return [*messages, message("/VMC/Ext/OK", 1), message("/VMC/Ext/T", float(seconds))]


def message(address: str, *values: str | float | int) -> bytes:
    """One OSC message."""
    tags, body = ",", b""
    for value in values:
        if isinstance(value, str):
            tags, body = tags + "s", body + _text(value)
        elif isinstance(value, int):
            tags, body = tags + "i", body + struct.pack("!i", value)
        else:
            tags, body = tags + "f", body + struct.pack("!f", value)
    return _text(address) + _text(tags) + body


def bundles(messages: Iterable[bytes], time_tag: int = AT_ONCE) -> list[bytes]:
    """As few bundles as hold the messages in their order."""
    head = BUNDLE + struct.pack("!Q", time_tag)
    packed = [head]
    for one in messages:
        if len(packed[-1]) + 4 + len(one) > LARGEST_BUNDLE and packed[-1] != head:
            packed.append(head)
        packed[-1] += struct.pack("!i", len(one)) + one
    return packed


def _text(text: str) -> bytes:
    """Ended by a zero, filled up to a multiple of four bytes."""
    encoded = text.encode()
    return encoded + b"\0" * (4 - len(encoded) % 4)
