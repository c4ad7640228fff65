# SPDX-License-Identifier: GPL-3.0-or-later
"""From looks that were shown to a camera to a taught set, or an old one with these taught again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.puppet.parts import KINDS
from mimetic.puppet.seeing import PersonView
from mimetic.puppet.set_making import (
    Channels,
    Sample,
    TaughtLook,
    Template,
    cut,
    make_set,
    templates_of,
)
from mimetic.puppet.taught_look import Look
from mimetic.puppet.templates import TaughtSet


class Pair(NamedTuple):
    """A picture of a camera as it is seen, and as it might have been; time: seconds."""

    time: float
    seen: Sample
    shaken: Sample


def check_teachable(old: TaughtSet, channels: Sequence[str]) -> None:
    """Raises InvalidInput unless a camera can teach looks of an old set again."""
    if old.example_pictures is None or old.example_looks is None:
        raise InvalidInput(
            "the set was taught from a clip, whose pictures it does not keep: teach it from the "
            "clip again"
        )
    if old.channels != list(channels):
        raise InvalidInput("the set has other muscles than there are now: teach all of it again")


def has_looks_alone(old: TaughtSet) -> bool:
    """Whether a set has no example but its looks."""
    return old.example_looks is not None and bool((old.example_looks >= 0).all())


class Lesson:
    """One person at one camera; old: a set of the same person, whose other looks stay."""

    def __init__(self, view: PersonView, channels: Channels, old: TaughtSet | None) -> None:
        self.view, self.channels, self.old = view, channels, old
        self.boxes = {part: view.boxes(part) for part in KINDS}
        if old is not None:
            self.boxes |= dict(zip(old.template_parts, old.template_boxes, strict=True))

    def make(
        self, shown: Sequence[tuple[Look, Sequence[Pair]]], between: Sequence[Pair]
    ) -> TaughtSet:
        """shown: looks with pictures of each; between: of which the looks are a part."""
        names = list(self.old.looks) if self.old else []
        names += [look.name for look, _ in shown if look.name not in names]
        places = {names.index(look.name): (look, pairs) for look, pairs in shown}
        best = {
            i: _nearest_to_median(pairs, self.channels.units) for i, (_, pairs) in places.items()
        }
        looks, taught = list[Look](), list[TaughtLook]()
        for i, name in enumerate(names):
            if i in places:
                look = places[i][0]
                values = best[i].values if look.values is None else self.channels.state(look)
                frame = 0
            else:
                assert self.old is not None
                look, values = Look(name, 0), self.old.look_values[i]
                frame = int(self.old.look_frames[i])
            looks.append(look)
            taught.append(TaughtLook(name, frame, values))
        samples = self._old_samples(places) + self._samples(places, taught, between)
        templates = self._templates(looks, [one.values for one in taught], best)
        return make_set(self.view, self.channels, taught, templates, samples, keeps_pictures=True)

    def _templates(
        self, looks: Sequence[Look], states: Sequence[NDArray[np.float64]], best: dict[int, Sample]
    ) -> list[Template]:
        old = {
            (int(look), part): picture
            for look, part, picture in (
                zip(
                    self.old.template_looks, self.old.template_parts, self.old.pictures, strict=True
                )
                if self.old
                else ()
            )
            if int(look) not in best
        }
        return [
            Template(i, part, self.boxes[part], old[i, part])
            if (i, part) in old
            else cut(self.boxes[part], part, i, best[i].picture)
            for i, part in templates_of(looks, states, self.channels, list(old))
            if i in best or (i, part) in old  # old looks get no new templates
        ]

    def _old_samples(self, replaced: dict[int, tuple[Look, Sequence[Pair]]]) -> list[Sample]:
        old = self.old
        if old is None or old.example_pictures is None or old.example_looks is None:
            return []
        dropped = set(replaced)
        if any(look.values is not None for look, _ in replaced.values()):
            dropped.add(-1)  # between looks, where such a look did what was seen
        rows = zip(old.example_pictures, old.example_values, old.example_looks, strict=True)
        return [
            Sample(picture, values, look=int(look))
            for picture, values, look in rows
            if int(look) not in dropped
        ]

    def _samples(
        self,
        places: dict[int, tuple[Look, Sequence[Pair]]],
        taught: Sequence[TaughtLook],
        between: Sequence[Pair],
    ) -> list[Sample]:
        """In order of time: neighbours are left out together when others are predicted."""
        timed = [(pair.time, one) for pair in between for one in pair[1:]]
        for i, (look, pairs) in places.items():
            for pair in pairs:
                for one in pair[1:]:
                    values = one.values if look.values is None else taught[i].values
                    timed.append((pair.time, Sample(one.picture, values, look=i)))
        return [one for _, one in sorted(timed, key=lambda row: row[0])]


def _nearest_to_median(pairs: Sequence[Pair], units: NDArray[np.float64]) -> Sample:
    """No blink, and nothing that was there for a moment alone."""
    rows = np.array([pair.seen.values for pair in pairs]) / units
    distance = np.abs(rows - np.median(rows, axis=0)).sum(axis=1)
    return pairs[int(distance.argmin())].seen
