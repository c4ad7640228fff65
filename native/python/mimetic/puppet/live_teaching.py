# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks taught while they are shown to a camera, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mimetic.puppet.lesson import Pair, check_teachable
from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.live_session import Tell
from mimetic.puppet.pictures import Picture
from mimetic.puppet.seeing import MODEL
from mimetic.puppet.set_making import REST
from mimetic.puppet.shown_looks import MOST_HELD, ShownLooks, is_over
from mimetic.puppet.taught_look import Look
from mimetic.puppet.teaching import MOST_EXAMPLES
from mimetic.puppet.templates import TaughtSet


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
        self._tell, self._is_asked, self._bell = tell, is_asked, bell
        self._shown = ShownLooks(
            live, tell, old, self.options.num_examples, model=self.options.model
        )
        self._begin()

    def see(self, picture: Picture, state: LiveState | None) -> bool:
        """A picture and what the filter says; false when all looks are kept."""
        sample = self._shown.see(picture, state)
        if state is None or not self._shown.is_ready:
            return True
        if self._shown.num_heads != self._num_heads:
            self._begin()
        self._advance(picture.time, sample)
        return len(self._shown.kept) < len(self.looks)

    @property
    def left(self) -> list[str]:
        """Names of the looks that were not kept."""
        return [look.name for look in self.looks[len(self._shown.kept) :]]

    def taught(self) -> TaughtSet:
        """Of the looks that were kept; raises InvalidInput if there are too few."""
        return self._shown.taught()

    def _begin(self) -> None:
        self._num_heads = self._shown.num_heads
        self._held: list[Pair] = []
        self._announced: float | None = None
        self._counted: int | None = None

    def _advance(self, time: float, sample: Pair | None) -> None:
        look = self.looks[len(self._shown.kept)]
        if self._announced is None:
            self._announced = time
            self._counted = None if self._is_asked else 1 + self.options.countdown
            if self._is_asked:
                self._is_asked()  # what was pressed before was not meant for this look
            wish = f"look {1 + len(self._shown.kept)} of {len(self.looks)}: {look.name}"
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
        if is_over(passed, len(self._held)):
            self._keep(look)

    def _keep(self, look: Look) -> None:
        self._announced = None
        held, self._held = self._held, []
        self._bell()
        self._shown.keep(look, held)
