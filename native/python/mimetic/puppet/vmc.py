# SPDX-License-Identifier: GPL-3.0-or-later
"""A live face by the VMC protocol."""

from __future__ import annotations

from collections.abc import Sequence

from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.live_units import live_units
from mimetic.puppet.osc import bundles, vmc_messages


class VmcPackets:
    """Bundles of each live state. names: of the states' values, `live_names`."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names, self._units = list(names), live_units()

    def pack(self, state: LiveState) -> list[bytes]:
        weights = self._units.weights(state.values[None])[0]
        parts = vmc_messages(state.head_pose, weights, self._names, state.values, state.time)
        return bundles(parts)
