# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that characters' controls are known by: what each is in the 52 face units.

Known are ARKit's names in both spellings, VRM 0 and 1.0, VRoid's, Unified Expressions,
MetaHuman's curves and the bones of Rigify's faces (`data/control_names.toml`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import load_table
from mimetic.template.face_template import load_template

PREFIXED = re.compile(r"Fcl_[A-Z]+_.+")  # VRoid's, behind the name of the model
CHANNEL = re.compile(r"(.+) (?:along|turn) [xyz]")  # of a bone, as `bone_channels` names it
SEPARATORS = str.maketrans("", "", " _-.:|")
UNIT_SIDES = ("Left", "Right")
MARKED_SIDE = re.compile(r"(?<=[._ -])[LRlr](?=[._ -]|$)")
# MetaHuman's: of the upper or the lower lip too
LAST_SIDE = re.compile(r"(?<=[a-z])(?P<lip>[UD]?)(?P<side>[LR])$")
# An eye that looks aside has a direction beside its own side
LOOKS_ASIDE = re.compile(
    r"(?P<look>look[._ -]?)(?P<side>left|right)(?=[._ -]?(?:[lr]|left|right)$)", re.IGNORECASE
)
PAIRS = (("L", "R"), ("l", "r"), ("Left", "Right"), ("left", "right"), ("LEFT", "RIGHT"))
SIDE_TWINS = dict(PAIRS) | {right: left for left, right in PAIRS}
# Of bones that Blender mirrors: axes x of the two sides are each other's mirror image turned over,
# and what turns about an axis of the mirror turns the other way
TURNED_OVER = re.compile(r".+ (?:along x|turn [yz])")


@dataclass(frozen=True)
class KnownName:
    """What a control's name says."""

    convention: str  # that has it
    plain: str  # the control's plain name there
    units: Mapping[str, float]  # share of each face unit; none for a state, or a bone

    @property
    def place(self) -> tuple[str, str]:
        """The same for all spellings of one control."""
        return self.convention, self.plain


@dataclass(frozen=True)
class Convention:
    name: str
    controls: Mapping[str, KnownName]  # by the plain name
    is_bones: bool = False

    @property
    def letters(self) -> set[str]:
        """Names of one letter."""
        return {plain for plain in self.controls if len(plain) == 1}


def known_names(names: Iterable[str]) -> dict[str, KnownName]:
    """What each of a character's names says; those that no convention has are left out.

    Where conventions share a name, the one that has most of the character's names decides.
    """
    names = list(names)
    spellings = {name: _spellings(name) for name in names}
    # A letter means something only among the others of its convention
    all_plain = {plain for spelled in spellings.values() for plain in spelled}
    uses = {
        convention.name: sum(
            convention.is_bones == is_bone_channel(name)
            and any(plain in convention.controls for plain in spellings[name])
            for name in names
        )
        for convention in conventions()
    }
    # Bones are called jaw in any rig: it is of a rig that half of its bones are of
    least = 0.5 * sum(map(is_bone_channel, names))
    by_use = [
        convention
        for convention in sorted(conventions(), key=lambda convention: -uses[convention.name])
        if not convention.is_bones or uses[convention.name] >= least
    ]
    known = {}
    for name in names:
        for convention in by_use:
            if convention.is_bones != is_bone_channel(name):
                continue
            plain = next((s for s in spellings[name] if s in convention.controls), None)
            if plain is not None and (len(plain) > 1 or convention.letters <= all_plain):
                known[name] = convention.controls[plain]
                break
    return known


def is_bone_channel(name: str) -> bool:
    return CHANNEL.fullmatch(name) is not None


def unit_shares(names: Iterable[str], known: Mapping[str, KnownName]) -> NDArray[np.float64]:
    """K x 52: share of each face unit in each control, in the template's order."""
    names, units = list(names), load_template().unit_names
    shares = np.zeros((len(names), len(units)))
    for row, name in zip(shares, names, strict=True):
        for unit, share in known[name].units.items() if name in known else ():
            row[units.index(unit)] = share
    return shares


def units_of(names: Iterable[str]) -> dict[str, str]:
    """ARKit's shapes among a character's controls: each by ARKit's spelling, with its name there.

    Any convention's control counts that is one unit and nothing else; ARKit's own spelling goes
    first, then the character's order.
    """
    names, own = list(names), load_template().unit_names
    known = known_names(names)
    found: dict[str, str] = {}
    for name in sorted(names, key=lambda name: name not in own):
        units = dict(known[name].units) if name in known else {}
        if len(units) == 1:
            ((unit, share),) = units.items()
            if share == 1.0:
                found.setdefault(unit, name)
    return found


def mirrored_name(name: str) -> str:
    """The same control of the other side; the name itself if it says no side."""
    first, last = _side_span(name)
    twin = name[:first] + SIDE_TWINS.get(name[first:last], "") + name[last:]
    return LOOKS_ASIDE.sub(_turned_look, twin) if first < last else name


def side_of(name: str) -> str:
    """L or R; nothing if a control's name says no side."""
    first, last = _side_span(name)
    return name[first:last][:1].upper()


def is_turned_over(name: str) -> bool:
    """Whether a bone's channel does on the other side with -1 what it does here with 1."""
    return TURNED_OVER.fullmatch(name) is not None


def _side_span(name: str) -> tuple[int, int]:
    """Where a name says its side, from and to."""
    for side in (word for pair in PAIRS for word in pair if len(word) > 1):
        if name.endswith(side):
            return len(name) - len(side), len(name)
        if name.startswith(side):
            return 0, len(side)
    if marked := MARKED_SIDE.search(name):
        return marked.span()
    if last := LAST_SIDE.search(name):
        return last.span("side")
    return 0, 0


def _turned_look(look: re.Match[str]) -> str:
    return look["look"] + SIDE_TWINS.get(look["side"], look["side"])


@cache
def conventions() -> tuple[Convention, ...]:
    """In the table's order."""
    return tuple(map(_convention, load_table("control_names.toml")["convention"]))


def _convention(entry: Mapping) -> Convention:
    rows = {name: dict(units) for name, units in entry["controls"].items()}
    rows |= {name: {} for name in entry["known"]}
    if entry.get("is_units"):
        rows |= {unit: {unit: 1.0} for unit in load_template().unit_names}
    controls = {}
    for name, units in rows.items():
        for side, unit_side in zip(entry["sides"], UNIT_SIDES, strict=True):
            own = {unit.replace("*", unit_side): float(share) for unit, share in units.items()}
            plain = _plain(name.replace("*", side))
            controls[plain] = KnownName(entry["name"], plain, own)
    return Convention(entry["name"], controls, bool(entry.get("is_bones")))


def _plain(name: str) -> str:
    return name.translate(SEPARATORS).lower()


def _spellings(name: str) -> list[str]:
    """The plain name; without what stands before its last dot; with its side in full. Of a bone's
    channel the bone's plain name."""
    if channel := CHANNEL.fullmatch(name):
        return [_plain(channel.group(1))]
    last = name.rsplit(".", 1)[-1] if len(name.rsplit(".", 1)[-1]) > 1 else name
    prefixed = PREFIXED.search(name)
    spellings = []
    for text in (name, last, *([prefixed.group()] if prefixed else [])):
        spellings.append(_plain(text))
        for mark in "_.- ":
            for side, full in (("L", "Left"), ("R", "Right"), ("l", "Left"), ("r", "Right")):
                if text.endswith(mark + side):
                    spellings.append(_plain(text[: -len(side) - 1] + full))
    return spellings
