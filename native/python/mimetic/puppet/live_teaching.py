# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks taught while they are shown to a camera, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mimetic import InvalidInput
from mimetic.puppet.lesson import Lesson, Pair, check_teachable, has_looks_alone
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
SEEN = 0.3  # quality from which on a picture teaches


@dataclass(frozen=True)
class LiveTeachingOptions:
    """countdown: seconds before a look is kept; num_examples: of pictures between the looks, that
    are kept beside them; model: that the head is followed by.
    """

    countdown: int = 3
    num_examples: int = MOST_EXAMPLES
    model: str = MODEL


class LiveTeaching:
    """The listener of a live session that asks for look after look.

    looks: without `neutral` it is asked for first, unless `old` has it; old: a set of the same
    person, of which these looks are taught again, and whose others stay; is_asked: whether the user
    wants the next look to be kept, such as by a key; without it each follows by itself; bell: a
    look is kept, and the eyes may be opened. Raises InvalidInput.
    """

    def __init__(
        self,
        live: LiveFilter,
        looks: Sequence[Look],
        tell: Tell,
        options: LiveTeachingOptions | None = None,
        old: TaughtSet | None = None,
        is_asked: Callable[[], bool] | None = None,
        bell: Callable[[], None] = lambda: None,
    ) -> None:
        if old is not None:
            check_teachable(old, live.names)
        elif all(look.name != REST for look in looks):
            looks = [Look(REST, 0), *looks]
        self.looks = list(looks)
        self.options = options or LiveTeachingOptions()
        self._live, self._tell, self._old = live, tell, old
        self._is_asked, self._bell = is_asked, bell
        self._face: LiveFace | None = None
        self._is_told = False  # that the head is being fitted
        self._begin()

    def see(self, picture: Picture, state: LiveState | None) -> bool:
        """A picture and what the filter says; false when all looks are kept."""
        face = self._live.face
        if state is None or face is None or not self._live.is_settled:
            if state is not None and not self._is_told:
                self._tell("the face is seen; look into the camera at rest until its head is known")
                self._is_told = True
            return True
        if face is not self._face:
            self._meet(face, picture, state)
        sample = self._sample(picture, state)
        if sample is not None and not self._is_alone:
            self._between.offer(sample)
        self._advance(picture.time, sample)
        return len(self._kept) < len(self.looks)

    @property
    def left(self) -> list[str]:
        """Names of the looks that were not kept."""
        return [look.name for look in self.looks[len(self._kept) :]]

    def taught(self) -> TaughtSet:
        """Of the looks that were kept; raises InvalidInput if there are too few."""
        if not self._kept:
            raise InvalidInput("no look was kept, and nothing is written")
        if self._old is None and len(self._kept) < 2:
            raise InvalidInput("only one look was kept, and nothing is written: two are needed")
        lesson = Lesson(self._view, self._channels, self._old)
        return lesson.make(list(zip(self.looks, self._kept, strict=False)), self._between.samples)

    def _begin(self) -> None:
        self._kept: list[list[Pair]] = []  # of each look, as seen and shaken
        self._held: list[Pair] = []
        self._announced: float | None = None
        self._counted: int | None = None
        self._between = _EvenSamples(self.options.num_examples)
        # Pictures between the looks would contradict a look that drives something else
        has_own = any(look.values is not None for look in self.looks)
        self._is_alone = has_own or (self._old is not None and has_looks_alone(self._old))

    def _meet(self, face: LiveFace, picture: Picture, state: LiveState) -> None:
        """A head is known, or another one: what was kept of the last does not belong to it."""
        if self._kept:
            self._tell("another head: teaching begins anew with the first look")
        self._begin()
        self._face = face
        neutral = face.fit.neutral_vertices(face.template)
        again = (self._old.sides, self._old.pixel) if self._old else ()
        self._view = PersonView(face.camera, neutral, *again)
        muscles = list(face.anatomy.muscle_names)
        articulators = self._live.names[len(muscles) :]
        self._channels = Channels(muscles, face.anatomy.groups.tolist(), articulators)
        self._stiller = HeadStiller(self._view, picture.image, state.head_pose, self.options.model)
        self._shaker = PoseShaker()

    def _sample(self, picture: Picture, state: LiveState) -> Pair | None:
        """The picture as it is seen, and as it might have been; None where it teaches nothing."""
        guess = None if state.is_held else state.head_pose
        still, head = self._stiller.still(picture.image, guess)
        if still is None or state.is_held or state.quality < SEEN:
            return None
        pose = self._shaker.shaken(np.asarray(head.camera_from_head))
        shaken = self._view.picture(picture.image, pose)
        return Pair(picture.time, Sample(still, state.values), Sample(shaken, state.values))

    def _advance(self, time: float, sample: Pair | None) -> None:
        look = self.looks[len(self._kept)]
        if self._announced is None:
            self._announced = time
            self._counted = None if self._is_asked else 1 + self.options.countdown
            if self._is_asked:
                self._is_asked()  # what was pressed before was not meant for this look
            wish = f"look {1 + len(self._kept)} of {len(self.looks)}: {look.name}"
            rest = ", the face at rest" if look.name == REST else ""
            self._tell(wish + rest + ("; press Enter" if self._is_asked else ""))
        if self._counted is None:
            if not self._is_asked or not self._is_asked():
                return
            self._announced, self._counted = time, 1 + self.options.countdown
        passed = time - self._announced - self.options.countdown
        if passed < 0:
            left = int(np.ceil(-passed))
            if left < self._counted:
                self._counted = left
                self._tell(f"{look.name} in {left} ...")
            return
        if sample is not None and len(self._held) < MOST_HELD:
            self._held.append(sample)
        if passed >= HELD_FOR:
            self._keep(look)

    def _keep(self, look: Look) -> None:
        self._announced = None
        held, self._held = self._held, []
        self._bell()
        if len(held) < LEAST_HELD:
            self._tell(f"{look.name}: the face was not seen well; once more")
            return
        self._tell(f"{look.name}: kept")
        self._kept.append(held)


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
