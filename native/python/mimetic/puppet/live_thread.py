# SPDX-License-Identifier: GPL-3.0-or-later
"""A live session in a thread of its own, for a host that shows it: Blender's window."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path
from time import monotonic

from mimetic.fit.face_fit import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.puppet.camera_source import CameraSource
from mimetic.puppet.channels import Freezer
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.live_plots import LiveTrace
from mimetic.puppet.live_session import LiveSession
from mimetic.puppet.look_keeper import LookKeeper
from mimetic.puppet.pictures import Picture
from mimetic.puppet.sound import Microphone, clip_sound
from mimetic.puppet.take import Take
from mimetic.puppet.taught_follower import SHARPEN
from mimetic.puppet.templates import TaughtSet
from mimetic.puppet.warm_up import warm_up


class LiveThread:
    """Follows a source until it is stopped; the host asks for the newest state.

    stop: set from outside, it ends the session. is_blocking: nothing runs in a thread: `start`
    works through the whole clip and records it. taught, use, lens, person: as of a `LiveFilter`.
    keeper: of looks that are taught meanwhile.
    """

    def __init__(
        self,
        source: CameraSource | ClipSource,
        stillness: float,
        stop: threading.Event | None = None,
        is_blocking: bool = False,
        taught: TaughtSet | None = None,
        use: str = SHARPEN,
        lens: KnownLens | None = None,
        person: FaceFit | None = None,
        keeper: LookKeeper | None = None,
    ) -> None:
        self.source = source
        self.line = "starting"
        self.error: BaseException | None = None
        self._filter: LiveFilter | None = None
        self._stillness, self._is_blocking = stillness, is_blocking
        self._taught, self._use = taught, use
        self.lens, self.person, self.keeper = lens, person, keeper
        self.told: list[str] = []  # lines for the user; who shows them takes them out
        self._is_neutral_due = False
        self._freezer: Freezer | None = None
        self._frozen: frozenset[str] = frozenset()
        self._lock = threading.Lock()
        self._stop = stop or threading.Event()
        self._newest: tuple[LiveState, LiveFace] | None = None
        self._take: Take | None = None
        self._time_zero = 0.0  # of the pictures' times, by `monotonic`'s clock
        self._microphone: Microphone | None = None
        self.thread = threading.Thread(target=self._run, name="live", daemon=True)
        self.session: LiveSession | None = None
        self.trace: LiveTrace | None = None  # of what is shown, as soon as there is a filter
        self.picture: Picture | None = None  # the newest that was worked on

    def start(self) -> None:
        if self._is_blocking:
            self.begin_take()
            self._run()
        else:
            self.thread.start()

    def stop(self) -> None:
        """Waits until the session has ended."""
        self._stop.set()
        self.join()

    def join(self, timeout: float | None = None) -> None:
        if self.thread.is_alive():
            self.thread.join(timeout)

    @property
    def is_running(self) -> bool:
        return self.thread.is_alive()

    @property
    def names(self) -> list[str]:
        """Of the states' values; known as soon as there is a state."""
        return self._filter.names if self._filter else []

    def set_stillness(self, stillness: float) -> None:
        self._stillness = stillness

    def set_frozen(self, channels: frozenset[str]) -> None:
        """Channels that stay as they are from now on."""
        self._frozen = channels

    def set_neutral(self) -> None:
        """The next picture shows the face at rest."""
        self._is_neutral_due = True

    def newest(self) -> tuple[LiveState, LiveFace] | None:
        """The newest state and the face that it is of; None before the first, or if it was taken.

        The state's pose and values have what is frozen.
        """
        with self._lock:
            newest, self._newest = self._newest, None
        return newest

    def begin_take(self, microphone: str = "", sound: Path | None = None) -> None:
        """Records from the next picture on. sound: where a microphone's goes."""
        if microphone and sound is not None:
            self._microphone = Microphone(microphone, sound)
            self._microphone.start()
        with self._lock:
            self._take = Take(self.source.fps)

    @property
    def is_recording(self) -> bool:
        return self._take is not None

    def end_take(self) -> tuple[Take | None, float | None]:
        """What was recorded; and where the microphone's first sample is, seconds from the take's
        first picture, if it was heard."""
        with self._lock:
            take, self._take = self._take, None
        microphone, self._microphone = self._microphone, None
        offset = None
        if microphone is not None:
            microphone.stop()
            if microphone.failure:
                self._tell(microphone.failure)
            if microphone.is_recorded and take and take.states:
                offset = microphone.first_sample - (self._time_zero + take.states[0].time)
        return take if take and take.states else None, offset

    def keep_clip_sound(self, take: Take, path: Path) -> bool:
        """Writes what the clip's sound is during a take; false where there is none."""
        if not isinstance(self.source, ClipSource):
            return False
        return clip_sound(self.source.footage, take.states[0].time, take.seconds, path)

    def _run(self) -> None:
        try:
            warm_up()
            self._filter = LiveFilter(
                *(self._stillness, not self._is_blocking, self._taught, self._use),
                *(self.lens, self.person),
            )
            self._filter.prepare()
            if self.keeper is not None:
                self.keeper.begin(self._filter, self._tell)
            self._freezer = Freezer(self._filter.names)
            self.trace = LiveTrace(self._filter.names, self._filter.follower)
            self.session = LiveSession(self.source, self._filter, self._see, self._tell)
            self.line = "looking for a face"
            self.session.run(self._stop.is_set)
            if self.keeper is not None:
                self.keeper.end()
        except BaseException as error:
            self.error = error
        finally:
            self.picture = self.trace = None

    def _see(self, picture: Picture, state: LiveState | None) -> bool:
        live, freezer = self._filter, self._freezer
        assert live is not None and freezer is not None and self.session is not None
        self.picture = picture
        live.stillness = self._stillness
        if self._is_neutral_due:
            self._is_neutral_due = False
            live.set_neutral()
        if self.keeper is not None:
            self.keeper.see(picture, state, self.source.time_of)
        if state is None or live.face is None:
            return True
        freezer.frozen = self._frozen
        pose, values = freezer.apply(state.head_pose, state.values)
        state = replace(state, head_pose=pose, values=values, frozen=tuple(freezer.frozen))
        with self._lock:
            self._newest = state, live.face
            if self.trace is not None:
                self.trace.add(state.time, state.values)
            if self._take is not None:
                self._time_zero = picture.arrival - picture.time
                self._take.add(state, live.face)
        age = 1000 * (monotonic() - picture.arrival)
        self.line = f"{self.session.figures.rate:.0f} pictures a second, {age:.0f} ms behind"
        return True

    def _tell(self, line: str) -> None:
        self.line = line
        self.told.append(line)
