# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Link Face's packet: one datagram a frame, 61 numbers, as Unreal's plug-in reads them."""

from __future__ import annotations

import math
import struct
import time
import uuid
from collections.abc import Sequence

from mimetic.performance.gaze import GAZE
from mimetic.performance.head_turn import angles, head_turn
from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.live_units import live_units

VERSION = 6
SUBJECT = "Mimetic"
NUM_VALUES = 61  # 52 shapes; head yaw, pitch, roll; left eye's yaw, pitch, roll; right eye's


class LiveLinkPackets:
    """Packets of one subject. names: of the states' values, `live_names`; fps: nominal."""

    def __init__(self, names: Sequence[str], fps: float, subject: str = SUBJECT) -> None:
        self._units = live_units()
        self._gaze = [list(names).index(name) for name in GAZE]
        self._fps = max(1, round(fps))
        encoded = subject.encode()
        device = f"${str(uuid.uuid4()).upper()}".encode()
        self._head = struct.pack("<I", VERSION) + device
        self._head += struct.pack("!i", len(encoded)) + encoded

    def pack(self, state: LiveState) -> list[bytes]:
        # ARKit's eyes turn about the head's axes as heads do: pitch is positive downwards
        left_yaw, left_pitch, right_yaw, right_pitch = (
            math.radians(state.values[i]) for i in self._gaze
        )
        eyes = left_yaw, -left_pitch, 0.0, right_yaw, -right_pitch, 0.0
        head = angles(head_turn(state.head_pose))
        values = [*self._units.weights(state.values[None])[0].tolist(), *head, *eyes]
        frame = time_of_day() * self._fps
        code = struct.pack("!If", int(frame), frame % 1) + struct.pack("!II", self._fps, 1)
        return [self._head + code + struct.pack(f"!B{NUM_VALUES}f", NUM_VALUES, *values)]


def time_of_day() -> float:
    """Seconds since midnight, for time codes."""
    now = time.time()
    local = time.localtime(now)
    return local.tm_hour * 3600 + local.tm_min * 60 + local.tm_sec + now % 1
