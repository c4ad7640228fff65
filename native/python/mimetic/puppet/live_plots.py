# SPDX-License-Identifier: GPL-3.0-or-later
"""What a live face did in the last seconds as lines to draw, as in the paper's Fig. 13."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic.analyse.drawing import GROUP_COLOURS
from mimetic.muscles.anatomy import muscle_groups, muscle_names
from mimetic.puppet.figures import shown_templates
from mimetic.puppet.taught_follower import TaughtFollower
from mimetic.report.plots import COLOURS, GROUPS

HISTORY = 8.0  # seconds
MOST_MOMENTS = 1000  # in them
VALUES, SCORES = (-0.1, 1.05), (0.4, 1.02)  # at the bottom and the top of a row
TEXT_SHARE = 0.45  # of a row's height, above its curve
LIGHTENED = 0.5  # towards white: the colours are made for paper
SAID_OPACITY = 0.45  # of what a taught set says
OTHERS = {"Jaw": "#b0b8bd", "Upper lids": "#9fb8d9"}

Colour = tuple[float, float, float, float]  # red, green, blue, opacity, 0 to 1
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Label:
    """Words at a place, their left bottom."""

    text: str
    place: tuple[float, float]
    colour: Colour


@dataclass(frozen=True)
class Plots:
    """Lines between each two points (2L x 2 float32), colours of these (2L x 4), and words."""

    points: NDArray[np.float32]
    colours: NDArray[np.float32]
    labels: list[Label]


class _Moment(NamedTuple):
    time: float  # seconds
    values: Floats
    scores: Floats  # of templates; empty without a taught set
    said: Floats  # what these mean for the values, nan of what is untaught


class LiveTrace:
    """The last seconds of a live face; names: of its values; follower: where a taught set is used.

    One thread may add while another draws.
    """

    def __init__(self, names: Sequence[str], follower: TaughtFollower | None = None) -> None:
        self._controls = _control_rows(names)
        self._follower = follower
        self._parts: dict[str, list[int]] = {}  # templates of each part, by its title
        if follower is not None:
            self._parts = shown_templates(follower.taught, follower.mapping.mode)
        self._moments: deque[_Moment] = deque(maxlen=MOST_MOMENTS)
        self._lock = threading.Lock()

    @property
    def num_rows(self) -> int:
        return len(self._parts) + len(self._controls)

    def add(self, time: float, values: Floats) -> None:
        """A state's values at `time`, seconds, and what the follower saw in the same picture."""
        none = np.zeros(0)
        follower = self._follower
        scores, said = (none, none) if follower is None else (follower.scores, follower.said.copy())
        with self._lock:
            if self._moments and time < self._moments[-1].time:
                self._moments.clear()  # another source, from its beginning
            self._moments.append(_Moment(time, values, scores, said))
            while self._moments[0].time < time - HISTORY:
                self._moments.popleft()

    def draw(self, left: float, bottom: float, width: float, height: float) -> Plots:
        """Rows from the top, the newest at the right: scores of each part's templates, then each
        group of muscles, jaw and lids, and fainter what the taught set says of them."""
        with self._lock:
            moments = list(self._moments)
        drawing = _Drawing(moments, left, width, height / self.num_rows)
        tops = iter(bottom + height - drawing.row_height * np.arange(self.num_rows))
        for title, templates in self._parts.items():
            drawing.row(float(next(tops)), *self._score_text(title, templates, moments))
            for k, template in enumerate(templates):
                fits = np.array([moment.scores[template] for moment in moments])
                drawing.curve(fits, SCORES, _light(COLOURS[k % len(COLOURS)]))
        for title, colour, members in self._controls:
            curve = np.array([moment.values[members].mean() for moment in moments])
            text = f"{title}  {curve[-1]:.2f}" if len(curve) else title
            drawing.row(float(next(tops)), text, colour)
            if self._follower is not None and len(curve):
                said = np.array([moment.said[members] for moment in moments])
                taught = ~np.isnan(said[-1])
                if taught.any():
                    faint = (*colour[:3], SAID_OPACITY)
                    drawing.curve(said[:, taught].mean(axis=1), VALUES, faint)
            drawing.curve(curve, VALUES, colour)
        return drawing.plots()

    def _score_text(
        self, title: str, templates: list[int], moments: list[_Moment]
    ) -> tuple[str, Colour]:
        """The look that fits best now, in its colour."""
        assert self._follower is not None
        taught = self._follower.taught
        if not moments:
            return title, (1.0, 1.0, 1.0, 1.0)
        scores = moments[-1].scores[templates]
        best = int(np.argmax(scores))
        look = taught.looks[taught.template_looks[templates[best]]]
        return f"{title}: {look}  {scores[best]:.2f}", _light(COLOURS[best % len(COLOURS)])


class _Drawing:
    """Collects rows."""

    def __init__(
        self, moments: list[_Moment], left: float, width: float, row_height: float
    ) -> None:
        times = np.array([moment.time for moment in moments])
        self._left, self.row_height = left, row_height
        self._across = left + width * (1 + (times - times[-1:]) / HISTORY)
        self._base = 0.0
        self._points: list[NDArray[np.float32]] = [np.zeros((0, 2), np.float32)]
        self._colours: list[NDArray[np.float32]] = [np.zeros((0, 4), np.float32)]
        self._labels: list[Label] = []

    def row(self, top: float, text: str, colour: Colour) -> None:
        self._base = top - self.row_height
        place = (self._left, self._base + (1 - TEXT_SHARE) * self.row_height)
        self._labels.append(Label(text, place, colour))

    def curve(self, values: Floats, limits: tuple[float, float], colour: Colour) -> None:
        if len(values) < 2:
            return
        share = (np.clip(values, *limits) - limits[0]) / (limits[1] - limits[0])
        up = self._base + (1 - TEXT_SHARE) * self.row_height * share
        line = np.column_stack([self._across, up]).astype(np.float32)
        self._points.append(np.repeat(line, 2, axis=0)[1:-1])
        self._colours.append(np.tile(np.array(colour, np.float32), (len(self._points[-1]), 1)))

    def plots(self) -> Plots:
        return Plots(np.concatenate(self._points), np.concatenate(self._colours), self._labels)


def _control_rows(names: Sequence[str]) -> list[tuple[str, Colour, list[int]]]:
    """Title, colour and members of each row."""
    group_of = dict(zip(muscle_names(), muscle_groups().tolist(), strict=True))
    rows = []
    for group, title in GROUPS.items():
        members = [i for i, name in enumerate(names) if group_of.get(name) == group]
        rows.append((title, _light(GROUP_COLOURS[group]), members))
    jaw = [i for i, name in enumerate(names) if name == "jaw_open"]
    lids = [i for i, name in enumerate(names) if name.startswith("lid_upper.")]
    for (title, colour), members in zip(OTHERS.items(), (jaw, lids), strict=True):
        rows.append((title, _light(colour, 0.0), members))
    return [row for row in rows if row[2]]


def _light(colour: str, share: float = LIGHTENED) -> Colour:
    red, green, blue = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return (red + share * (1 - red), green + share * (1 - green), blue + share * (1 - blue), 1.0)
