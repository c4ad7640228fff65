# SPDX-License-Identifier: GPL-3.0-or-later
"""OSC bundles of the VMC protocol: blend shapes, then Apply, and the head as a bone."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

from mimetic.performance.gaze import GAZE
from mimetic.performance.head_turn import head_turn, quaternion
from mimetic.puppet.arkit import ArkitShapes, shape_names
from mimetic.puppet.live_filter import LiveState

LARGEST_BUNDLE = 1400  # bytes: a datagram that no network on the way has to split
BUNDLE = b"#bundle\0" + struct.pack("!Q", 1)  # 1: at once


class VmcPackets:
    """Bundles of each state.

    names: of the states' values. The 52 shapes are sent under ARKit's names with a capital, as
    avatars made for face tracking have them, muscles and articulators under their own.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._shapes = ArkitShapes(names)
        self._shape_names = [name[0].upper() + name[1:] for name in shape_names()]
        self._own = [(i, name) for i, name in enumerate(names) if name not in GAZE]

    def pack(self, state: LiveState) -> list[bytes]:
        weights = self._shapes.weights(state.values)
        w, x, y, z = quaternion(head_turn(state.head_pose)).tolist()
        # Unity's axes are left-handed, and avatars look along z: x is mirrored
        head = ("Head", 0.0, 0.0, 0.0, x, -y, -z, w)
        messages = [message("/VMC/Ext/Bone/Pos", *head)]
        values = [(name, float(v)) for name, v in zip(self._shape_names, weights, strict=True)]
        values += [(name, float(state.values[i])) for i, name in self._own]
        messages += [message("/VMC/Ext/Blend/Val", name, value) for name, value in values]
        messages.append(message("/VMC/Ext/Blend/Apply"))
        messages += [message("/VMC/Ext/OK", 1), message("/VMC/Ext/T", state.time)]
        return bundles(messages)


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


def bundles(messages: Iterable[bytes]) -> list[bytes]:
    """As few bundles as hold the messages in their order."""
    packed = [BUNDLE]
    for one in messages:
        if len(packed[-1]) + 4 + len(one) > LARGEST_BUNDLE and packed[-1] != BUNDLE:
            packed.append(BUNDLE)
        packed[-1] += struct.pack("!i", len(one)) + one
    return packed


def _text(text: str) -> bytes:
    """Ended by a zero, filled up to a multiple of four bytes."""
    encoded = text.encode()
    return encoded + b"\0" * (4 - len(encoded) % 4)
