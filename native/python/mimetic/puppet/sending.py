# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a clip sent to other programs when the clip would show them."""

from __future__ import annotations

import time
from collections.abc import Sequence

from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.receiver import Receiver


class PacedSending:
    """Sends states, each when its time has come since the first; late ones at once.

    addresses: of `Receiver`; names: of the states' values; fps: nominal. Raises what `Receiver`
    raises.
    """

    def __init__(self, addresses: Sequence[str], names: Sequence[str], fps: float) -> None:
        self._receivers = [Receiver(address, names, fps) for address in addresses]
        self._start: float | None = None  # by `monotonic`'s clock, of a state at 0 s

    @property
    def has_receivers(self) -> bool:
        return bool(self._receivers)

    def send(self, state: LiveState) -> None:
        now = time.monotonic()
        if self._start is None:
            self._start = now - state.time
        time.sleep(max(self._start + state.time - now, 0.0))
        for receiver in self._receivers:
            receiver.send(state)

    def unsent(self) -> list[str]:
        """Lines on what did not leave the machine."""
        return [line for receiver in self._receivers for line in receiver.unsent()]

    def close(self) -> None:
        for receiver in self._receivers:
            receiver.close()
