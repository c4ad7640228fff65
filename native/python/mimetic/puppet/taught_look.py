# SPDX-License-Identifier: GPL-3.0-or-later
"""A look to teach: its name, its frame, which parts, and what muscles do in it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mimetic import InvalidInput
from mimetic.library.expression import Expression
from mimetic.performance.document import Performance
from mimetic.puppet.parts import KINDS, PARTS

LOOK = re.compile(r"(?P<name>[^=:/]{1,60})=(?P<frame>\d{1,9})(?::(?P<parts>[\w.,]+))?")
SHOWN_LOOK = re.compile(r"(?P<name>[^=:/]{1,60})(?::(?P<parts>[\w.,]+))?")  # to a camera
SOLVED = re.compile(r"(?P<file>.+\.npz):(?P<frame>\d{1,9})")
SHORT = {"brows": ("brow.L", "brow.R"), "eyes": ("eye.L", "eye.R"), "parts": PARTS}


@dataclass(frozen=True)
class Look:
    """frame: 0 where it is shown to a camera; values: of muscles and articulators by name; None:
    those of the solved frame, or of the live filter.
    """

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
    return Look(match["name"].strip(), int(match["frame"]), _parts(text, match["parts"]))


def parse_shown_look(text: str) -> Look:
    """`NAME[:PART,PART]`, which is shown to a camera; raises InvalidInput."""
    match = SHOWN_LOOK.fullmatch(text)
    if not match or not match["name"].strip():
        raise InvalidInput(
            f"{text!r} is not NAME or NAME:PART,PART, as smile:mouth (a camera has no frames)"
        )
    return Look(match["name"].strip(), 0, _parts(text, match["parts"]))


def named_looks(
    looks: Iterable[Look], states: Iterable[str], channels: Collection[str]
) -> list[Look]:
    """With what `--state` says that they drive. channels: that there are; raises InvalidInput."""
    by_name: dict[str, Look] = {}
    for look in looks:
        if look.name in by_name:
            raise InvalidInput("--look: two looks have one name")
        by_name[look.name] = look
    for text in states:
        name, values = parse_state(text, channels)
        if name not in by_name:
            raise InvalidInput(f"--state {name}: there is no --look of that name")
        by_name[name] = replace(by_name[name], values=values)
    return list(by_name.values())


def parse_state(text: str, channels: Collection[str]) -> tuple[str, dict[str, float]]:
    """`NAME=FILE.npz` of the library, `NAME=PERFORMANCE.npz:FRAME`, or sliders
    `NAME=MUSCLE:VALUE,...`.

    channels: muscles and articulators that there are. Raises InvalidInput, UnreadableMedia.
    """
    name, equals, state = text.partition("=")
    if not equals or not name:
        raise InvalidInput(
            f"{text!r} is not NAME=EXPRESSION.npz, NAME=PERFORMANCE.npz:FRAME or "
            "NAME=MUSCLE:VALUE,..."
        )
    if solved := SOLVED.fullmatch(state):
        values = _solved(solved["file"], int(solved["frame"]))
    elif state.endswith(".npz"):
        expression = Expression.load(state)
        row = expression.values[expression.peak]
        values = dict(zip(expression.channels, row.tolist(), strict=True))
    else:
        return name, _sliders(text, state, channels)
    return name, {channel: value for channel, value in values.items() if channel in channels}


def _parts(text: str, words: str | None) -> tuple[str, ...]:
    parts: list[str] = []
    for word in (words or "").split(","):
        if word:
            parts += SHORT.get(word, (word,))
    if unknown := [part for part in parts if part not in KINDS]:
        raise InvalidInput(
            f"{text!r}: no part {unknown[0]!r}; there are {', '.join((*KINDS, *SHORT))}"
        )
    return tuple(dict.fromkeys(parts))


def _solved(path: str, frame: int) -> dict[str, float]:
    """What a performance has in a frame; raises InvalidInput, UnreadableMedia."""
    performance = Performance.load(path)
    i = performance.index_of(frame)
    row = [*performance.activations[i].tolist(), *performance.articulator_values[i].tolist()]
    return dict(zip([*performance.muscles, *performance.articulators], row, strict=True))


def _sliders(text: str, state: str, channels: Collection[str]) -> dict[str, float]:
    values = {}
    for item in state.split(","):
        channel, _, number = item.rpartition(":")
        if channel not in channels:
            raise InvalidInput(f"{text!r}: there is no muscle or articulator {channel!r}")
        try:
            values[channel] = float(number)
        except ValueError:
            raise InvalidInput(f"{text!r}: {number!r} is not a number") from None
        if not np.isfinite(values[channel]) or abs(values[channel]) > 1e3:
            raise InvalidInput(f"{text!r}: {number!r} is out of range")
    return values
