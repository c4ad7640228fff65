# SPDX-License-Identifier: GPL-3.0-or-later
"""What a camera shows of a person: pictures of looks while they are held, and others between."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimetic import InvalidInput
from mimetic.puppet.lesson import Lesson, Pair, has_looks_alone
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.live_session import Tell
from mimetic.puppet.pictures import Picture
from mimetic.puppet.seeing import MODEL, HeadStiller, PersonView, PoseShaker
from mimetic.puppet.set_making import REST, Channels, Sample
from mimetic.puppet.taught_look import Look
from mimetic.puppet.teaching import MOST_EXAMPLES
from mimetic.puppet.templates import TaughtSet

HELD_FOR = 0.5  # seconds that a look is kept of: the picture nearest to their median is it
LEAST_HELD, MOST_HELD = 3, 15  # pictures of a look
HELD_AT_MOST = 2.0  # seconds that pictures are waited for where few come, or show the face badly
SEEN = 0.3  # quality from which on a picture teaches


def is_over(passed: float, num_held: int) -> bool:
    """Whether a look that was held for some seconds, and is seen in some pictures, need be no
    longer."""
    return passed >= HELD_FOR and (num_held >= LEAST_HELD or passed >= HELD_AT_MOST)


class ShownLooks:
    """Looks of one person at one camera; another head begins them anew.

    old: a set of the same person, whose other looks stay; num_examples: of pictures between the
    looks, that are kept beside them; model: that the head is followed by.
    """

    def __init__(
        self,
        live: LiveFilter,
        tell: Tell,
        old: TaughtSet | None = None,
        num_examples: int = MOST_EXAMPLES,
        model: str = MODEL,
    ) -> None:
        self._live, self._tell, self._old = live, tell, old
        self._num_examples, self._model = num_examples, model
        self._face: LiveFace | None = None
        self._is_told = False  # that the head is being fitted
        self.num_heads = 0
        self._begin()

    def _begin(self) -> None:
        self.kept: dict[str, tuple[Look, list[Pair]]] = {}  # by name, in order
        self._between = _EvenSamples(self._num_examples)

    @property
    def is_ready(self) -> bool:
        """Whether the person's head is known."""
        return self._live.face is not None and self._live.is_settled

    def see(self, picture: Picture, state: LiveState | None) -> Pair | None:
        """The picture as it is seen, and as it might have been; None where it teaches nothing."""
        face = self._live.face
        if state is None or face is None or not self.is_ready:
            if state is not None and not self._is_told:
                self._tell("the face is seen; look into the camera at rest until its head is known")
                self._is_told = True
            return None
        # A person who is known has one head, wherever it was placed anew
        if self._face is None or face.anatomy is not self._face.anatomy:
            self._meet(face, picture, state)
        sample = self._sample(picture, state)
        if sample is not None:
            self._between.offer(sample)
        return sample

    def keep(self, look: Look, held: list[Pair]) -> bool:
        """Whether the pictures of a look suffice; they are kept in place of earlier ones."""
        if len(held) < LEAST_HELD:
            self._tell(f"{look.name}: the face was not seen well; once more")
            return False
        self.kept[look.name] = look, held
        self._tell(f"{look.name}: kept")
        return True

    def taught(self) -> TaughtSet:
        """Of the looks that were kept; raises InvalidInput if there are too few."""
        kept = list(self.kept.values())
        if not kept:
            raise InvalidInput("no look was kept, and nothing is written")
        if self._old is None and len(kept) < 2:
            raise InvalidInput("only one look was kept, and nothing is written: two are needed")
        if self._old is None and REST not in self.kept:
            raise InvalidInput(f"the look {REST}, the face at rest, was not kept: a set needs it")
        lesson = Lesson(self._view, self._channels, self._old)
        return lesson.make(kept, self._others(kept))

    def _others(self, kept: Sequence[tuple[Look, list[Pair]]]) -> list[Pair]:
        """Those between looks would contradict a look that drives something else."""
        has_own = any(look.values is not None for look, _ in kept)
        is_alone = has_own or (self._old is not None and has_looks_alone(self._old))
        return [] if is_alone else list(self._between.samples)

    def _meet(self, face: LiveFace, picture: Picture, state: LiveState) -> None:
        """A head is known, or another one: what was kept of the last does not belong to it."""
        if self.kept:
            self._tell("another head: teaching begins anew with the first look")
        self._begin()
        self.num_heads += 1
        self._face = face
        neutral = face.fit.neutral_vertices(face.template)
        again = (self._old.sides, self._old.pixel) if self._old else ()
        self._view = PersonView(face.camera, neutral, *again)
        muscles = list(face.anatomy.muscle_names)
        articulators = self._live.names[len(muscles) :]
        self._channels = Channels(muscles, face.anatomy.groups.tolist(), articulators)
        self._stiller = HeadStiller(self._view, picture.image, state.head_pose, self._model)
        self._shaker = PoseShaker()

    def _sample(self, picture: Picture, state: LiveState) -> Pair | None:
        guess = None if state.is_held else state.head_pose
        still, head = self._stiller.still(picture.image, guess)
        if still is None or state.is_held or state.quality < SEEN:
            return None
        pose = self._shaker.shaken(np.asarray(head.camera_from_head))
        shaken = self._view.picture(picture.image, pose)
        return Pair(picture.time, Sample(still, state.values), Sample(shaken, state.values))


class _EvenSamples:
    """Up to about `number` samples, evenly in time, of who knows how many."""

    def __init__(self, number: int) -> None:
        self._number, self._step, self._count = number, 1, 0
        self.samples: list[Pair] = []

    def offer(self, sample: Pair) -> None:
        if self._number and self._count % self._step == 0:
            self.samples.append(sample)
            if len(self.samples) > self._number:
                self.samples = self.samples[::2]
                self._step *= 2
        self._count += 1
