# SPDX-License-Identifier: GPL-3.0-or-later
"""What a performance's pictures say about its values, in other units of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def evidence_factors(scale: NDArray[np.float64]) -> NDArray[np.float32]:
    """E: times the evidence of values (M) it is that of these values over `scale` (M)."""
    of_state = np.append(np.ones(6), scale)
    row, column = np.tril_indices(len(of_state))
    return np.append(of_state[row] * of_state[column], of_state).astype(np.float32)
