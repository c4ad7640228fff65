# SPDX-License-Identifier: GPL-3.0-or-later
"""A taught set at work beside the live filter: it drives the face, or sharpens what the filter
measures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.gaze import GAZE
from mimetic.puppet.driver import GOOD_SCORE, LEAST_SCORE
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.mapping import Mapping, State
from mimetic.puppet.matching import still_matcher
from mimetic.puppet.parts import PARTS
from mimetic.puppet.seeing import Image, PersonView
from mimetic.puppet.templates import TaughtSet
from mimetic.solve.gaze import SIDES

DRIVE, SHARPEN = "drive", "sharpen"
USES = (SHARPEN, DRIVE)
LEAST_STD = 1e-3
LEAST_TRUST = 0.02  # in a part that looks like no template
MOVES = 0.01  # least standard deviation of a value among the examples that teaches anything of it

Floats = NDArray[np.float64]


class TaughtFollower:
    """Scores of a taught set's templates in the pictures of a live face, and what they mean.

    names: of the live values; use: of USES. The gaze is the live filter's, which measures it by
    itself, and so is what no example moves. Raises InvalidInput where nothing is left.
    """

    def __init__(self, taught: TaughtSet, names: Sequence[str], use: str = SHARPEN) -> None:
        if use not in USES:
            raise InvalidInput(f"a taught set can {' or '.join(USES)}, not {use!r}")
        self.taught, self.use = taught, use
        self.mapping = Mapping(taught)
        live = {name: i for i, name in enumerate(names) if name not in GAZE}
        moves = taught.example_values.std(axis=0) >= MOVES
        part_of = {i: part for part in PARTS for i in taught.channels_of(part)}
        self._own = [
            i
            for i, name in enumerate(taught.channels)
            if name in live and moves[i] and i in part_of and taught.of_part(part_of[i])
        ]
        if not self._own:
            raise InvalidInput(
                "the looks of the taught set move no muscle that is followed live: teach it again"
            )
        self._live = [live[taught.channels[i]] for i in self._own]
        self._parts = [part_of[i] for i in self._own]
        lids = ((eye, live[f"lid_upper.{side}"]) for eye, side in enumerate(SIDES))
        self._lids = [(eye, lid) for eye, lid in lids if lid in self._live]
        self._sharpening = _core.Sharpening(len(self._own))
        self._face: LiveFace | None = None
        self._view: PersonView | None = None
        self._matcher: _core.TemplateMatcher | None = None
        self._is_neutral_due = False
        self.scores: Floats = np.zeros(len(taught.template_parts))  # of the newest picture
        self.said: Floats = np.full(len(names), np.nan)  # what they mean; nan: of what is untaught

    def set_neutral(self) -> None:
        """The next picture shows the face at rest: scores of another day's light are shifted."""
        self._is_neutral_due = True

    def advance(
        self, image: Image, face: LiveFace, pose: Floats, live: State, pitches: Floats, since: float
    ) -> State:
        """The live values and deviations with what the set says of them.

        image: H x W x 3; pose: 4 x 4, of the head, camera from head; pitches: of both eyes,
        degrees, with which the upper lids go along; since: seconds since the picture before.
        """
        if face is not self._face:
            self._begin(face)
        assert self._view is not None and self._matcher is not None
        self.scores = self._matcher.match(self._view.picture(image, pose))[0]
        if self._is_neutral_due:
            self._is_neutral_due = False
            self.mapping.set_neutral(self.scores)
        seen = self.mapping.state(self.scores)
        self.said[self._live] = seen.values[self._own]
        taught = self.said[: len(live.values)].copy()
        for eye, lid in self._lids:
            taught[lid] = face.lids[eye].seen(taught[lid : lid + 1], pitches[eye : eye + 1])[0]
        own_std = np.maximum(seen.std[self._own] / self._trust(), LEAST_STD)
        values, std = live.values.copy(), live.std.copy()
        if self.use == DRIVE:
            values[self._live], std[self._live] = taught[self._live], own_std
        else:
            live_std = np.maximum(live.std[self._live], LEAST_STD)
            values[self._live], std[self._live] = self._sharpening.advance(
                *(live.values[self._live], live_std, taught[self._live], own_std, max(since, 0.0))
            )
        return State(values, std)

    def _begin(self, face: LiveFace) -> None:
        taught = self.taught
        neutral = face.fit.neutral_vertices(face.template)
        self._view = PersonView(face.camera, neutral, taught.sides, taught.pixel)
        self._matcher = still_matcher(taught.pictures, taught.template_boxes, taught.template_parts)
        self._face = face
        self._sharpening.restart()

    def _trust(self) -> Floats:
        """Of each value that the set has, 0 to 1: how well the best template of its part fits."""
        best = {part: self.scores[self.taught.of_part(part)].max() for part in set(self._parts)}
        scores = np.array([best[part] for part in self._parts])
        return np.clip((scores - LEAST_SCORE) / (GOOD_SCORE - LEAST_SCORE), LEAST_TRUST, 1.0)
