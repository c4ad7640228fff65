# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake makes of a performance's curves before it keys them: smoother, from rest, larger,
mirrored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.curve_keys import check_factor, check_width
from mimetic.character.shapes import GROUPS, listed
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.extras import lip_rows
from mimetic.muscles.sides import EYE_TURNS, LEFT, RIGHT, mirrored_name, mirrored_sign
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE

Floats = NDArray[np.float64]
Row = tuple[str, str, float, float]
ALL_GROUPS = ""
LIDS = ("lid_upper", "lid_lower")
# Each side does what the other did; both do what the subject's left, or right, did; or the mean.
# Eyes look one way together, so that they are exchanged with the rest and else stay
MIRRORS = ("swap", "left", "right", "both")
FOLLOWING = {"swap": "", "left": RIGHT, "right": LEFT}  # by how names end that do what others did


@dataclass(frozen=True)
class CurveSettings:
    """Edits of the curves of muscles, jaw, lids and lips; the head and detail stay, and the gaze
    unless the sides are exchanged."""

    # Seconds, of `_core.smooth_curve`; 0 leaves curves as captured
    smoothing: float = 0.0
    # Of the footage, in which the actor's face is what the character's is at rest; 0: none
    neutral_frame: int = 0
    # By group, ALL_GROUPS for those that are not named
    factors: Mapping[str, float] = field(default_factory=dict)
    # Lids too: blinks lose height, as they are short (evaluation.runs.curve_smoothing)
    smooths_lids: bool = False
    mirror: str = ""  # one of MIRRORS, or nothing

    def changes_nothing(self) -> bool:
        is_as_large = all(factor == 1 for factor in self.factors.values())
        return not (self.smoothing or self.neutral_frame or self.mirror) and is_as_large


def is_lid(name: str) -> bool:
    """Of an articulator or shape: what blinks."""
    return name.startswith(LIDS)


def group_names() -> list[str]:
    """What factors may name."""
    names = [*ARTICULATORS, *(row["name"] for row in lip_rows())]
    return [*GROUPS.values(), *dict.fromkeys(listed(name)[1] for name in names)]


def settings_of(
    smoothing: float = 0.0,
    neutral_frame: int = 0,
    exaggeration: float = 1.0,
    of_groups: str = "",
    mirror: str = "",
) -> CurveSettings:
    """Settings as a form has them; of_groups: GROUP=FACTOR, ... Raises InvalidInput."""
    texts = [text.strip() for text in of_groups.split(",") if text.strip()]
    if bare := [text for text in texts if "=" not in text]:
        raise InvalidInput(f"exaggeration {bare[0]}: give GROUP=FACTOR")
    factors = {ALL_GROUPS: exaggeration, **parse_factors(texts)}
    return CurveSettings(smoothing, neutral_frame, factors, mirror=mirror)


def parse_factors(texts: Sequence[str]) -> dict[str, float]:
    """Factors by group of texts FACTOR or GROUP=FACTOR; raises InvalidInput."""
    factors = {}
    for text in texts:
        group, _, number = text.rpartition("=")
        names = {_plain(name): name for name in group_names()}
        if group and _plain(group) not in names:
            raise InvalidInput(f"exaggeration {text}: groups are {', '.join(names)}")
        try:
            factor = float(number)
        except ValueError:
            raise InvalidInput(f"exaggeration {text}: give FACTOR or GROUP=FACTOR") from None
        check_factor(factor)
        factors[names[_plain(group)] if group else ALL_GROUPS] = factor
    return factors


def _plain(group: str) -> str:
    return group.strip().lower().replace(" ", "-")


def edited(performance: Performance, settings: CurveSettings) -> Performance:
    """The performance with its curves edited.

    They are smoothed over seconds, whatever the rate, but not over cuts; then what they are in the
    neutral frame is taken off; then they are multiplied by their group's factor, within what each
    can do; then sides are mirrored. Raises InvalidInput.
    """
    check_width(settings.smoothing)
    if settings.mirror not in ("", *MIRRORS):
        raise InvalidInput(f"mirror {settings.mirror}: it is one of {', '.join(MIRRORS)}")
    for factor in settings.factors.values():
        check_factor(factor)
    if settings.changes_nothing():
        return performance
    muscles = [
        (name, GROUPS[int(group)], 0.0, 1.0)
        for name, group in zip(performance.muscles, performance.groups, strict=True)
    ]
    articulators = [listed(name) for name in performance.articulators]
    activations = _edited(performance, performance.activations, muscles, settings)
    values = _edited(performance, performance.articulator_values, articulators, settings)
    if settings.mirror:
        activations = _mirrored(performance.muscles, activations, settings.mirror)
        values = _mirrored(performance.articulators, values, settings.mirror)
    return replace(performance, activations=activations, articulator_values=values)


def _edited(
    performance: Performance, values: Floats, rows: Sequence[Row], settings: CurveSettings
) -> Floats:
    """N x C values with a row for each column: name, group, lowest, highest."""
    width = settings.smoothing * performance.fps
    neutral = _index(performance, settings.neutral_frame)
    result = values.copy()
    for i, (name, group, lowest, highest) in enumerate(rows):
        if name in GAZE:
            continue
        column = np.ascontiguousarray(values[:, i])
        if width > 0 and (settings.smooths_lids or not is_lid(name)):
            column = _smoothed(performance, column, width)
        rest = 0.0 if neutral is None else column[neutral]
        factor = settings.factors.get(group, settings.factors.get(ALL_GROUPS, 1.0))
        result[:, i] = np.clip((column - rest) * factor, lowest, highest)
    return result


def _smoothed(performance: Performance, column: Floats, width: float) -> Floats:
    """N values over so many frames, each scene for itself."""
    frames = performance.frame.astype(np.float64)
    parts = [(frames[scene], column[scene]) for scene in performance.scenes]
    return np.concatenate([_core.smooth_curve(at, part, at, width)[0] for at, part in parts])


def mirrored_share(name: str, how: str) -> float:
    """How much of a muscle, articulator or shape comes from its twin, by one of MIRRORS."""
    if name.startswith(EYE_TURNS) and how != "swap":
        return 0.0
    return 0.5 if how == "both" else float(name.endswith(FOLLOWING[how]))


def _mirrored(names: Sequence[str], values: Floats, how: str) -> Floats:
    """N x C values with a name for each column; what has no twin among them stays."""
    columns = {name: i for i, name in enumerate(names)}
    result = values.copy()
    for name, i in columns.items():
        twin = columns.get(mirrored_name(name))
        share = mirrored_share(name, how)
        if twin is not None and share:
            other = mirrored_sign(name) * values[:, twin]
            result[:, i] = (1 - share) * values[:, i] + share * other
    return result


def _index(performance: Performance, frame: int) -> int | None:
    if not frame:
        return None
    rows = np.flatnonzero(performance.frame == frame)
    if not len(rows):
        raise InvalidInput(
            f"neutral frame {frame} is not in the performance, which has {performance.frame[0]} to "
            f"{performance.frame[-1]}"
        )
    return int(rows[0])
