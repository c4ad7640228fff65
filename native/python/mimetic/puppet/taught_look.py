# SPDX-License-Identifier: GPL-3.0-or-later
"""A look to teach: its name, its frame, which parts, and what muscles do in it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimetic import InvalidInput
from mimetic.library.expression import Expression
from mimetic.performance.document import Performance
from mimetic.puppet.parts import KINDS, PARTS

LOOK = re.compile(r"(?P<name>[^=:/]{1,60})=(?P<frame>\d{1,9})(?::(?P<parts>[\w.,]+))?")
SHORT = {"brows": ("brow.L", "brow.R"), "eyes": ("eye.L", "eye.R"), "parts": PARTS}


@dataclass(frozen=True)
class Look:
    """values: of muscles and articulators by name; None: those of the solved frame."""

    name: str
    frame: int
    parts: tuple[str, ...] = ()  # of KINDS; none: all in which it differs from the other looks
    values: Mapping[str, float] | None = None


def parse_look(text: str) -> Look:
    """`NAME=FRAME[:PART,PART]`; raises InvalidInput."""
    match = LOOK.fullmatch(text)
    if not match:
        raise InvalidInput(
            f"{text!r} is not NAME=FRAME or NAME=FRAME:PART,PART, as smile=120:mouth"
        )
    parts: list[str] = []
    for word in (match["parts"] or "").split(","):
        if word:
            parts += SHORT.get(word, (word,))
    if unknown := [part for part in parts if part not in KINDS]:
        raise InvalidInput(
            f"{text!r}: no part {unknown[0]!r}; there are {', '.join((*KINDS, *SHORT))}"
        )
    return Look(match["name"].strip(), int(match["frame"]), tuple(dict.fromkeys(parts)))


def parse_state(text: str, performance: Performance) -> tuple[str, dict[str, float]]:
    """`NAME=FILE.npz` of the library, or sliders `NAME=muscle:value,...`; raises InvalidInput."""
    name, equals, state = text.partition("=")
    if not equals or not name:
        raise InvalidInput(f"{text!r} is not NAME=EXPRESSION.npz or NAME=MUSCLE:VALUE,...")
    if state.endswith(".npz"):
        expression = Expression.load(state)
        row = expression.values[expression.peak]
        values = dict(zip(expression.channels, row.tolist(), strict=True))
        known = {*performance.muscles, *performance.articulators}
        return name, {channel: value for channel, value in values.items() if channel in known}
    values = {}
    for item in state.split(","):
        channel, _, number = item.rpartition(":")
        if channel not in performance.muscles + performance.articulators:
            raise InvalidInput(
                f"{text!r}: the performance has no muscle or articulator {channel!r}"
            )
        try:
            values[channel] = float(number)
        except ValueError:
            raise InvalidInput(f"{text!r}: {number!r} is not a number") from None
        if not np.isfinite(values[channel]) or abs(values[channel]) > 1e3:
            raise InvalidInput(f"{text!r}: {number!r} is out of range")
    return name, values
