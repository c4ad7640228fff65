# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers with their 95 % intervals."""

from __future__ import annotations

from dataclasses import dataclass

WITHIN = 1.96  # standard deviations, within which 95 % lie


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval; nan where nothing is known."""

    value: float
    lower: float
    upper: float
