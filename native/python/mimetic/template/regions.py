# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of the head's regions."""

from __future__ import annotations

FACE = (
    *("forehead", "temple", "brow", "nasal_bridge", "nose", "eyelid", "cheek", "zygomatic"),
    *("upper_lip", "lower_lip", "chin", "jaw_line"),
)
