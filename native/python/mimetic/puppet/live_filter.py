# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimator live: picture in, state of the face out, no look ahead and no second pass.

The face is shown from the first picture that it is found in, on the canonical head's muscles;
its own head follows some seconds later (`PersonSearch`), without a break. Who is known is shown on
their own head from the first picture on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.puppet.live_face import LiveFace, live_names
from mimetic.puppet.live_heads import STRANGER, LiveHeads
from mimetic.puppet.mapping import State
from mimetic.puppet.person_search import PersonSearch
from mimetic.puppet.taught_follower import SHARPEN, TaughtFollower
from mimetic.puppet.templates import TaughtSet
from mimetic.solve.gaze import SIDES, gaze_in
from mimetic.solve.walk import PROOF, find_again

DEFAULT_STILLNESS = 0.5
FIRST_SEARCH, LONGEST_SEARCH = 8, 64  # frames between looks for a face that is lost: ever fewer
LONG_AWAY = 3.0  # seconds after which a face that is not the lost one is taken for another person
TAKEN_OVER = 0.5  # quality from which on the person's own head replaces the first one

Image = NDArray[np.uint8]


@dataclass(frozen=True)
class LiveState:
    """What the face does in one picture.

    time: seconds; head_pose: 4 x 4, camera from head, metres; values: as `live_names` has them,
    activations 0 to 1, gaze in degrees; std: of them, gaze 0; is_held: nothing was measured, and
    the state is the last one's; is_proved: enough pictures on end showed it to be a face, and no
    chance likeness; milliseconds: that it took; pose_cov: 6 x 6, of the measured pose;
    search_milliseconds: of those, for finding the face and the person's head, which a session looks
    for in a thread; frozen: channels that a `Freezer` held, and that are not of this picture.
    """

    time: float
    head_pose: NDArray[np.float64]
    values: NDArray[np.float64]
    std: NDArray[np.float64]
    quality: float
    is_held: bool
    is_proved: bool
    milliseconds: float
    pose_cov: NDArray[np.float64]
    search_milliseconds: float = 0.0
    frozen: tuple[str, ...] = ()


class LiveFilter:
    """Follows one face through pictures as they come.

    stillness: 0 least lag to 1 least jitter (`StillnessFilter`). in_background: whether the
    person's head is searched for in a thread, as a live session needs it; otherwise `advance` takes
    as long as that does, and the same pictures always give the same states. taught: looks of the
    person, which drive the face or sharpen what is measured, by `use`, of taught_follower.USES.
    lens: that the pictures are taken with, if it is known; person: a fit of the one expected, in
    whatever footage, whose head, muscles and calibration are taken; a face that does not look like
    it is followed as a stranger's, which `remarks` says. Raises InvalidInput.
    """

    def __init__(
        self,
        stillness: float = DEFAULT_STILLNESS,
        in_background: bool = True,
        taught: TaughtSet | None = None,
        use: str = SHARPEN,
        lens: KnownLens | None = None,
        person: FaceFit | None = None,
    ) -> None:
        self._heads = LiveHeads(lens, person)
        self.remarks: list[str] = []  # for the user; who tells them takes them out
        self._stillness = _core.StillnessFilter(stillness)
        self._in_background = in_background
        self.names = live_names()
        self.follower = None if taught is None else TaughtFollower(taught, self.names, use)
        self.face: LiveFace | None = None
        self._search: PersonSearch | None = None
        self._is_neutral_due = False
        self._num_seen, self._num_lost, self._next_search = 0, 0, FIRST_SEARCH
        self._seen_at = 0.0
        self._time: float | None = None

    @property
    def stillness(self) -> float:
        return self._stillness.stillness

    @stillness.setter
    def stillness(self, stillness: float) -> None:
        self._stillness.stillness = stillness

    @property
    def is_settled(self) -> bool:
        """Whether the person's head is known as well as it will be."""
        return self.face is not None and self._search is None and not self._is_neutral_due

    def prepare(self) -> None:
        """What takes seconds before the first picture, and would otherwise be done at it."""
        self._heads.prepare()

    def set_neutral(self) -> None:
        """The next picture shows the face at rest: the head is fitted to it, in the background.

        That of a person who is known is placed in it.
        """
        self._is_neutral_due = True
        if self.follower is not None:
            self.follower.set_neutral()

    def start_over(self) -> None:
        """Nothing that is known of the face holds any more: another camera, another person."""
        self.stop()
        self._stillness = _core.StillnessFilter(self.stillness)
        self.face = self._time = None
        self._num_seen, self._num_lost, self._next_search = 0, 0, FIRST_SEARCH

    def stop(self) -> None:
        """Ends the work in the background."""
        if self._search is not None:
            self._search.stop()
            self._search = None

    def advance(self, image: Image, time: float) -> LiveState | None:
        """The next picture (H x W x 3 uint8) at `time`, seconds; None before a face is found."""
        start = perf_counter()
        image = np.ascontiguousarray(image)
        since = 0.0 if self._time is None else time - self._time
        self._time = time
        if self.face is None and not self._find(image):
            return None
        self._improve(image, time)
        assert self.face is not None
        guess = self._guess(image)
        searched = perf_counter() - start
        estimate = self.face.tracker.advance(image, guess)
        if not estimate.held:
            self._num_seen += 1
            self._num_lost, self._next_search, self._seen_at = 0, FIRST_SEARCH, time
        elif self._num_seen < PROOF:
            self.start_over()  # no face
            return None
        else:
            self._num_lost += 1
            if guess is not None and time - self._seen_at > LONG_AWAY:
                self.start_over()
                return self.advance(image, time)
        state = self._state(image, estimate, time, since)
        took = perf_counter() - start
        return replace(state, milliseconds=1000 * took, search_milliseconds=1000 * searched)

    def _find(self, image: Image) -> bool:
        try:
            face = self._heads.first(image)
        except InvalidInput:  # no face among others
            return False
        # Before the face: another thread that asks must not take a stranger's head for settled
        self._search = PersonSearch(self._heads, self._in_background)
        self.face = face
        return True

    def _improve(self, image: Image, time: float) -> None:
        """Offers the picture to the search, and takes over what it came to."""
        if self._is_neutral_due:
            self._is_neutral_due = False
            self.stop()
            self._search = PersonSearch(self._heads, self._in_background, num_judged=1)
        search = self._search
        if search is None:
            return
        if not self._num_lost:
            search.offer(image, time)
        if not search.is_over:
            return
        self._take_over(search, image)
        self._search = None

    def _take_over(self, search: PersonSearch, image: Image) -> None:
        own, old = search.result, self.face
        search.stop()
        if self._heads.is_stranger and STRANGER not in self.remarks:
            self.remarks.append(STRANGER)
        if own is None or old is None:
            return
        there = old.tracker.advance(image, None)
        estimate = own.tracker.advance(image, there.camera_from_head)
        if not estimate.held and estimate.quality >= min(TAKEN_OVER, there.quality):
            self.face = own

    def _guess(self, image: Image) -> NDArray[np.float64] | None:
        """Where a lost face is, if the finder sees one."""
        if self._num_lost < self._next_search or self.face is None:
            return None
        self._next_search += min(LONGEST_SEARCH, self._next_search)
        return find_again(image, 1, self.face.fit)

    def _state(
        self, image: Image, estimate: _core.FrameEstimate, time: float, since: float
    ) -> LiveState:
        face = self.face
        assert face is not None
        gaze = gaze_in(face.gaze, face.camera, estimate, since)
        seen = State(np.asarray(estimate.values), np.asarray(estimate.values_std))
        if self.follower is not None and not estimate.held:
            pose = np.asarray(estimate.camera_from_head)
            seen = self.follower.advance(image, face, pose, seen, gaze[1::2], since)
        pose, values = self._stillness.advance(estimate.camera_from_head, seen.values, since)
        values = np.concatenate([values, gaze])
        for eye, side in enumerate(SIDES):
            lid = self.names.index(f"lid_upper.{side}")
            pitch = gaze[2 * eye + 1 : 2 * eye + 2]
            values[lid] = face.lids[eye].own(values[lid : lid + 1], pitch)[0]
        std = np.concatenate([seen.std, np.zeros(len(gaze))])
        return LiveState(
            *(time, np.array(pose), values, std),
            quality=0.0 if estimate.held else float(estimate.quality),
            is_held=bool(estimate.held),
            is_proved=self._num_seen >= PROOF,
            milliseconds=0.0,
            pose_cov=np.array(estimate.pose_cov),
        )
