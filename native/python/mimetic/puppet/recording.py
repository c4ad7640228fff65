# SPDX-License-Identifier: GPL-3.0-or-later
"""A session that is recorded: performance, sound, and what goes to other programs meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from mimetic.fit.face_fit import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.performance.document import Performance
from mimetic.puppet.camera_source import CameraSource
from mimetic.puppet.channels import Freezer
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_filter import DEFAULT_STILLNESS, LiveFilter, LiveState
from mimetic.puppet.live_session import LiveSession, Tell
from mimetic.puppet.pictures import Picture
from mimetic.puppet.receiver import Receiver
from mimetic.puppet.sound import Microphone, clip_sound
from mimetic.puppet.take import Take
from mimetic.puppet.taught_follower import SHARPEN
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.json_file import write_json

AUDIO, TAKE = "audio.wav", "take.json"


@dataclass(frozen=True)
class RecordingOptions:
    """What is asked of a recording; see `mimetic puppet record --help`."""

    stillness: float = DEFAULT_STILLNESS
    seconds: float | None = None
    frozen: frozenset[str] = frozenset()
    microphone: str | None = None
    receivers: tuple[str, ...] = ()
    in_background: bool = True
    taught: TaughtSet | None = None
    use: str = SHARPEN  # of taught_follower.USES
    lens: KnownLens | None = None
    person: FaceFit | None = None


class Recording:
    """One take of a source, into a folder. Raises InvalidInput, UnreadableMedia."""

    def __init__(
        self,
        source: CameraSource | ClipSource,
        folder: Path,
        options: RecordingOptions,
        tell: Tell,
    ) -> None:
        self._source, self._folder, self._options, self._tell = source, folder, options, tell
        self._filter = LiveFilter(
            *(options.stillness, options.in_background, options.taught, options.use),
            *(options.lens, options.person),
        )
        self._filter.prepare()
        names = self._filter.names
        self._receivers = [Receiver(one, names, source.fps) for one in options.receivers]
        self._freezer = Freezer(names, options.frozen)
        self._take = Take(source.fps)
        self._time_zero = 0.0  # of the pictures' times, by `monotonic`'s clock
        self.session = LiveSession(source, self._filter, self._see, tell)

    def run(self, should_stop: Callable[[], bool] = lambda: False) -> Performance:
        """Until the source ends, the time is over or `should_stop`; the sound is in the folder."""
        microphone = None
        if self._options.microphone:
            microphone = Microphone(self._options.microphone, self._folder / AUDIO)
            microphone.start()
        try:
            self.session.run(should_stop)
        finally:
            if microphone:
                microphone.stop()
            for receiver in self._receivers:
                receiver.close()
                for line in receiver.unsent():
                    self._tell(line)
        footage = self._source.footage if isinstance(self._source, ClipSource) else None
        performance = self._take.performance(footage, self.session.figures.num_skipped)
        self._keep_sound(microphone)
        return performance

    def _see(self, picture: Picture, state: LiveState | None) -> bool:
        self._time_zero = picture.arrival - picture.time
        if state is not None and self._filter.face is not None:
            pose, values = self._freezer.apply(state.head_pose, state.values)
            state = replace(state, head_pose=pose, values=values)
            self._take.add(state, self._filter.face)
            for receiver in self._receivers:
                receiver.send(state)
        seconds = self._options.seconds
        return seconds is None or self._take.seconds < seconds

    def _keep_sound(self, microphone: Microphone | None) -> None:
        """audio.wav, and in take.json where its first sample is in the performance."""
        first, path = self._take.states[0].time, self._folder / AUDIO
        offset: float | None = 0.0
        if isinstance(self._source, ClipSource):
            if self._source.footage.variable_rate:
                offset = None  # frames are counted as stored, and go apart from the sound
            has_sound = clip_sound(self._source.footage, first, self._take.seconds, path)
        else:
            has_sound = bool(microphone and microphone.is_recorded)
            if microphone and microphone.failure:
                self._tell(microphone.failure)
            if microphone and has_sound:
                offset = microphone.first_sample - (self._time_zero + first)
        figures = self.session.figures
        facts = {
            "source": self._source.name,
            "seconds": self._take.seconds,
            "audio": AUDIO if has_sound else None,
            # Seconds from the performance's first frame to the sound's first sample
            "audio_offset": offset if has_sound else None,
            "stillness": self._options.stillness,
            "frozen": sorted(self._options.frozen),
            "pictures": figures.num_pictures,
            "skipped": figures.num_skipped,
        }
        write_json(self._folder / TAKE, facts)
