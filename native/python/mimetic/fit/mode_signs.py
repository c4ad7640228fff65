# SPDX-License-Identifier: GPL-3.0-or-later
"""The signs of a face's modes, as the coefficients in fit.json count them.

A mode and its opposite are the same direction: what solves for them chooses one. The core takes
the one with its largest share positive; files of schema 2 on were written with some inverted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Bit i from the right: mode i is the reverse of the core's
RESIDUAL_REVERSED = 0x79E58496E1814A3796604AFC648276231F45A2F0F
COMPONENTS_REVERSED = 0x7B2A2AE0045600B6582B3BE6


def signs(reversed_modes: int, count: int) -> NDArray[np.float64]:
    """1 or -1 for each of the modes."""
    return np.array([-1.0 if reversed_modes >> i & 1 else 1.0 for i in range(count)])
