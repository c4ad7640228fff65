# SPDX-License-Identifier: GPL-3.0-or-later
"""One actuation of a muscle with an exponent of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Firing:
    """A muscle's application, hold and release; `values` as a `Phase` has them. Seconds."""

    control: str
    amplitude: float
    start: float
    rise: float
    exponent: float
    hold: float
    release: float
    relaxation: float
    relaxed_share: float

    def values(self, times: np.ndarray) -> np.ndarray:
        s = np.clip((times - self.start) / self.rise, 0, 1)
        k = self.exponent
        applied = np.expm1(k * s) / np.expm1(k)
        since = np.clip(times - self.start - self.rise - self.hold, 0, None)
        fast, slow = np.exp(-since / self.release), np.exp(-since / self.relaxation)
        fallen = (1 - self.relaxed_share) * fast + self.relaxed_share * slow
        return self.amplitude * applied * fallen
