# SPDX-License-Identifier: GPL-3.0-or-later
"""Where live values are sent to: another program, by datagrams. Nothing is ever received."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable, Sequence
from urllib.parse import urlsplit

from mimetic import InvalidInput, UnreadableMedia
from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.livelink import LiveLinkPackets
from mimetic.puppet.vmc import VmcPackets

SCHEMES = ("osc", "livelink")
Pack = Callable[[LiveState], list[bytes]]


class Receiver:
    """A program at an address, given each state.

    address: osc://HOST:PORT or livelink://HOST:PORT; names: of the states' values; fps: nominal.
    Raises InvalidInput for an address that is none, UnreadableMedia for a host that is not known.
    """

    def __init__(self, address: str, names: Sequence[str], fps: float) -> None:
        scheme, host, port = parse_address(address)
        self.address = address
        self.num_failed = 0  # datagrams that the system did not take
        self._pack: Pack
        if scheme == "osc":
            self._pack = VmcPackets(names).pack
        else:
            self._pack = LiveLinkPackets(names, fps).pack
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        except OSError as error:
            raise UnreadableMedia(f"{address}: {host} is not known ({error.strerror})") from None
        # localhost is often ::1 first, and most receivers listen on IPv4 alone
        family, kind, protocol, _, target = min(found, key=lambda one: one[0] != socket.AF_INET)
        self._socket = socket.socket(family, kind, protocol)
        self._socket.setblocking(False)
        self._target = target

    def send(self, state: LiveState) -> None:
        """What cannot be sent at once is dropped: the next state is newer."""
        for packet in self._pack(state):
            try:
                self._socket.sendto(packet, self._target)
            except OSError:
                self.num_failed += 1

    def unsent(self) -> list[str]:
        """A line on what did not leave the machine, if there is any."""
        remarks = []
        if self.num_failed:
            remarks.append(f"{self.address}: {self.num_failed} packets were not sent")
        return remarks

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._socket.close()


def parse_address(address: str) -> tuple[str, str, int]:
    """(scheme, host, port); raises InvalidInput."""
    advice = f"--send {address}: give osc://HOST:PORT or livelink://HOST:PORT"
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        raise InvalidInput(advice) from None
    has_more = parts.path not in ("", "/") or parts.query or parts.username
    if parts.scheme not in SCHEMES or not host or not port or has_more:
        raise InvalidInput(advice)
    return parts.scheme, host, port
