# SPDX-License-Identifier: GPL-3.0-or-later
"""From looks and samples of a person's face, held still, to a taught set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic.library.expression import limits_of
from mimetic.performance.gaze import value_units
from mimetic.puppet.matching import still_matcher
from mimetic.puppet.parts import FACE, KINDS, channels_of
from mimetic.puppet.seeing import Image, PersonView
from mimetic.puppet.taught_look import Look
from mimetic.puppet.templates import TaughtSet

DISTINCT = 0.15  # a part's largest difference in a value below which two looks show the same
REST = "neutral"


@dataclass(frozen=True)
class Channels:
    """What a state has: muscles with their groups, then articulators."""

    muscles: list[str]
    groups: list[int]
    articulators: list[str]

    @cached_property
    def names(self) -> list[str]:
        return [*self.muscles, *self.articulators]

    @cached_property
    def units(self) -> NDArray[np.float64]:
        """C, as `value_units`."""
        return value_units(self.names)

    @cached_property
    def of_parts(self) -> dict[str, list[int]]:
        """Indices by part."""
        return {
            part: channels_of(part, self.muscles, self.groups, self.articulators) for part in KINDS
        }

    def state(self, look: Look) -> NDArray[np.float64]:
        """C, of a look with values of its own."""
        values = look.values or {}
        return np.array([values.get(name, 0.0) for name in self.names])


class TaughtLook(NamedTuple):
    """frame: of the footage, 0: not of a solved frame; values: C."""

    name: str
    frame: int
    values: NDArray[np.float64]


class Template(NamedTuple):
    """look: its index; box: x, y, width, height in the view, pixels; picture: of the box."""

    look: int
    part: str
    box: NDArray[np.int64]
    picture: Image


class Sample(NamedTuple):
    """A picture of the view and what the face does in it; look: -1 where it was taken for none."""

    picture: Image
    values: NDArray[np.float64]
    frame: int = 0
    look: int = -1


def templates_of(
    looks: Sequence[Look],
    states: Sequence[NDArray[np.float64]],
    channels: Channels,
    kept: Sequence[tuple[int, str]] = (),
) -> list[tuple[int, str]]:
    """(index of the look, part): of each look the whole face, and parts that look otherwise.

    Of a look with parts of its own these alone. The whole face of a look that is like another is
    kept too: without a template nothing would tell that the two are alike. kept: templates that
    are there already; looks that have any get no others.
    """
    templates: list[tuple[int, str]] = []
    rows = np.array(states) / channels.units
    has_any = {look for look, _ in kept}
    for part in KINDS:
        own = rows[:, channels.of_parts[part]]
        taken = [look for look, kind in kept if kind == part]
        for i, look in enumerate(looks):
            if i in has_any:
                continue
            differs = part == FACE or all(np.abs(own[i] - own[j]).max() > DISTINCT for j in taken)
            if part in look.parts or (not look.parts and differs) or look.name == REST:
                taken.append(i)
        templates += [(i, part) for i in sorted(taken)]
    return templates


def cut(box: NDArray[np.int64], part: str, look: int, picture: Image) -> Template:
    """The template of a part, which is in the box of a picture of the view."""
    x, y, width, height = box
    return Template(look, part, box, np.ascontiguousarray(picture[y : y + height, x : x + width]))


def make_set(
    view: PersonView,
    channels: Channels,
    looks: Sequence[TaughtLook],
    templates: Sequence[Template],
    samples: Sequence[Sample],
    footage: list[str] | None = None,
    keeps_pictures: bool = False,
) -> TaughtSet:
    """samples: in order of time; keeps_pictures: so that single looks can be taught again."""
    boxes = np.array([template.box for template in templates])
    parts = [template.part for template in templates]
    pictures = [template.picture for template in templates]
    matcher = still_matcher(pictures, boxes, parts)
    values = np.array([sample.values for sample in samples])
    limits = limits_of(channels.names, channels.muscles)
    limits[0] = np.minimum(limits[0], values.min(axis=0))
    limits[1] = np.maximum(limits[1], values.max(axis=0))
    names = [look.name for look in looks]
    return TaughtSet(
        pixel=view.pixel,
        sides=view.sides,
        looks=names,
        look_frames=np.array([look.frame for look in looks]),
        look_values=np.array([look.values for look in looks]),
        neutral=names.index(REST),
        channels=channels.names,
        channel_groups=np.array([*channels.groups, *(0 for _ in channels.articulators)]),
        limits=limits,
        template_parts=parts,
        template_looks=np.array([template.look for template in templates]),
        template_boxes=boxes,
        template_pixels=np.concatenate([picture.ravel() for picture in pictures]),
        example_scores=np.array([matcher.match(sample.picture)[0] for sample in samples]),
        example_values=values,
        footage=footage,
        example_frames=np.array([sample.frame for sample in samples]),
        example_pictures=np.array([s.picture for s in samples]) if keeps_pictures else None,
        example_looks=np.array([s.look for s in samples]) if keeps_pictures else None,
    )
