# SPDX-License-Identifier: GPL-3.0-or-later
"""Following a face or a head through a clip: cuts, searches, and the notes at the end."""

from __future__ import annotations

import contextlib
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mimetic import UnreadableMedia, _core
from mimetic.fit import fitting
from mimetic.fit.fitting import FaceFit, NoFace
from mimetic.media.backward import frames_away
from mimetic.media.cuts import CutWatch
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.performance.rows import Rows
from mimetic.shared.counted import counted
from mimetic.shared.progress import Progress, frame_text
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.face_place import FacePlace

Image = NDArray[np.uint8]
Pose = NDArray[np.float64]
SEARCH_AGAIN = 6  # frames between looks for a face that was lost: twice in half a second
PROOF = 3  # frames on end in which a face that was lost must be found, to be this one
MOST_NAMED = 5  # cuts in a note


class Followed(Protocol):
    """What a tracker says of a frame."""

    @property
    def held(self) -> bool: ...  # nothing was seen there

    @property
    def found_again(self) -> bool: ...  # it was searched for: it may be another face

    @property
    def camera_from_head(self) -> Pose: ...


Estimate = TypeVar("Estimate", bound=Followed)
# Takes a tracker to the next frame; the last: where the detector sees the head, if it ran
Advance = Callable[[int, Image, Pose | None], Estimate]
Forget = Callable[[int], None]  # what was learnt in so many of the last frames


class ClipWalk:
    """The frames of a clip, away from the fit's, past cuts and losses, until the user stops.

    subject: the face, the head; num_passes: how often all frames are gone through.
    """

    def __init__(
        self,
        footage: Footage,
        fit: FaceFit,
        frames: tuple[int, int],
        progress: Progress | None,
        summary: CaptureSummary,
        subject: str,
        num_passes: int = 1,
    ) -> None:
        self.footage, self.fit, self.frames = footage, fit, frames
        self.progress, self.summary, self.subject = progress, summary, subject
        self._cuts: set[int] = set()
        self.mixed_frames: set[int] = set()  # frames in which two scenes dissolve into each other
        self.strangers: list[int] = []  # frames in which a face was seen that is not this one
        first, last = frames
        self.num_needed = num_passes * (1 + max(fit.frame, last) - min(fit.frame, first))
        self.num_done = 0

    @property
    def scene_starts(self) -> set[int]:
        """Frames after a cut or a dissolve."""
        return self._cuts | {
            1 + frame for frame in self.mixed_frames if 1 + frame not in self.mixed_frames
        }

    def is_cut_between(self, frame: int, neighbour: int) -> bool:
        """Whether another scene starts with the later of two frames beside each other."""
        return max(frame, neighbour) in self._cuts

    def images(self, end: int) -> Iterator[tuple[int, Image]]:
        """From the fit's frame, which is left out, to `end`; fewer when the user stops, or when the
        footage fails: it then says why (`Footage.failure`), and what was followed is kept."""
        start = time.perf_counter()
        for frame, image in self._read(end):
            self.summary.add("decode", time.perf_counter() - start)
            fraction = min(1.0, self.num_done / self.num_needed)
            text = f"following the {self.subject}{self._at(frame)}"
            if self.summary.stopped or (self.progress and not self.progress(fraction, text)):
                self.summary.stopped = True
                return
            yield frame, np.ascontiguousarray(image)
            self.num_done += 1
            start = time.perf_counter()

    def _read(self, end: int) -> Iterator[tuple[int, Image]]:
        try:
            yield from frames_away(self.footage, self.fit.frame, end)
        except OSError:
            if self.footage.failure is None:
                raise

    def _at(self, frame: int) -> str:
        """Says so of a frame outside the range, which is gone through to get there."""
        first, last = self.frames
        if first <= frame <= last:
            return f": {frame_text(frame, first, last)}"
        begin, reference = first if frame < first else last, self.fit.frame
        return f" from the reference frame {reference} to {begin}: frame {frame}"

    def follow(
        self,
        end: int,
        advance: Advance[Estimate],
        reference: Image,
        across_scenes: bool = False,
        forget: Forget | None = None,
    ) -> Iterator[tuple[int, Estimate | None]]:
        """Estimates frame by frame to `end`; advance: of a frame, and where a lost head may be;
        reference: the fit's frame, which comes before them.

        After a cut nothing is read into another scene, and its frames are None, until the detector
        sees a head; across_scenes: whoever advances recognises by itself what it sees there. Frames
        in which two scenes dissolve into each other are None too; forget: told how many frames
        back that began, as soon as it is known.
        """
        waiting: deque[tuple[int, Estimate | None]] = deque()
        for pair in self._advance_through(end, advance, reference, across_scenes, forget):
            waiting.append(pair)
            if len(waiting) > _core.DissolveWatch.longest:
                yield self._unless_mixed(*waiting.popleft())
        for pair in waiting:
            yield self._unless_mixed(*pair)

    def _unless_mixed(self, frame: int, estimate: Estimate | None) -> tuple[int, Estimate | None]:
        return frame, None if frame in self.mixed_frames else estimate

    def _advance_through(
        self,
        end: int,
        advance: Advance[Estimate],
        reference: Image,
        across_scenes: bool,
        forget: Forget | None,
    ) -> Iterator[tuple[int, Estimate | None]]:
        num_lost = num_away = 0
        last = self.fit.frame
        cuts, dissolves = CutWatch(reference), _core.DissolveWatch()
        place = FacePlace(self.fit)
        face = place.at(self.fit.head_pose)  # in the frame before; None where it was lost
        frames: list[int] = []
        for frame, image in self.images(end):
            frames.append(frame)
            if cuts.starts_scene(image, face):
                self._cuts.add(max(frame, last))
                num_away = 1
            if frames_back := dissolves.add(image):
                earlier, later = (frames[-1 - back] for back in frames_back)
                self.mixed_frames |= set(range(min(earlier, later), 1 + max(earlier, later)))
                num_away = 1
                if forget:
                    forget(frames_back[0])
            last = frame
            guess = None
            if num_away % SEARCH_AGAIN == 1 or (num_lost and num_lost % SEARCH_AGAIN == 0):
                with self._timed("look for the face again"):
                    guess = find_again(image, frame, self.fit)
                num_away = 0 if guess is not None or across_scenes else num_away
            if num_away:
                num_away += 1
                face = None
                yield frame, None
                continue
            with self._timed(f"follow the {self.subject}"):
                estimate = advance(frame, image, guess)
            num_lost = num_lost + 1 if estimate.held else 0
            face = None if estimate.held else place.at(estimate.camera_from_head)
            if guess is not None and estimate.held:
                self.strangers.append(frame)
            yield frame, estimate

    @contextlib.contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.summary.add(stage, time.perf_counter() - start)

    def check_any_done(self, rows: Rows) -> None:
        """Raises UnreadableMedia, or what ffmpeg failed by, if no frame was done, or one of many.

        One of many is the reference frame alone, which is the fit and no result.
        """
        footage, is_stopped, (first, last) = self.footage, self.summary.stopped, self.frames
        is_fit_alone = len(rows.frame) == 1 and first != last
        if footage.failure and (not rows.frame or is_fit_alone):
            raise footage.failure
        if not rows.frame or (is_fit_alone and is_stopped):
            why = "stopped too early" if is_stopped else "the file ends before"
            raise UnreadableMedia(
                f"{footage.path.name}: {why}, no frame of {first} to {last} is done"
            )
        if is_fit_alone:
            raise UnreadableMedia(
                f"{footage.path.name} is damaged: of frames {first} to {last} only "
                f"{rows.frame[0]} can be read, which shows no motion; copy or record it again"
            )

    def notes(self, rows: Rows, about: Iterable[str] = ()) -> list[str]:
        """Notes on the clip, the fit, the capture (`about`), and how it went.

        The last: an early stop, cuts, held frames, where another face was seen. The summary has all
        of it too.
        """
        notes = [*self.footage.warnings, *self.fit.warnings, *about]
        if self.summary.stopped:
            notes.append(
                f"stopped by the user: frames {rows.frame[0]} to {rows.frame[-1]} "
                f"of {self.frames[0]} to {self.frames[1]}"
            )
        notes += notes_on_cuts([cut for cut in self._cuts if rows.frame[0] < cut <= rows.frame[-1]])
        num_held = int(np.sum(np.array(rows.quality) < HELD_QUALITY))
        if num_held:
            notes.append(
                f"the {self.subject} was lost in {counted(num_held, 'frame')} and is held there "
                "(quality under 0.2)"
            )
        notes += [
            f"frames {first} to {last} dissolve from one scene into another: held, not captured"
            for first, last in runs_of(self.mixed_frames, 1)
        ]
        notes += notes_on_strangers(self.strangers)
        self.summary.warnings = notes
        return notes


def before_range(fit: FaceFit, frames: tuple[int, int]) -> str:
    """What a walk goes through before it comes to the frames that are asked for, or ""."""
    first, last = frames
    if first <= fit.frame <= last:
        return ""
    begin = first if fit.frame < first else last
    frames_apart = counted(abs(begin - fit.frame), "frame")
    return f"{frames_apart} from the reference frame {fit.frame} to {begin}"


def find_again(image: NDArray[np.uint8], frame: int, fit: FaceFit) -> NDArray[np.float64] | None:
    """Where the detector sees a lost head, camera from head.

    Of several faces the one nearest to where the fit has its own: who was chosen stays chosen.
    """
    try:
        near = fit.head_place()
        return fitting.find_face(image, frame, camera=fit.camera, near=near).head_pose
    except NoFace:
        return None


def proved(
    estimates: Iterable[tuple[int, Estimate | None]],
) -> Iterator[tuple[int, Estimate | None]]:
    """The estimates, None where a lost face was found, but not for PROOF frames on end.

    Chance makes another face look like this one in a frame, not in several. A face may be lost and
    found in one frame, and after a cut it was not lost before: `found_again` says so.
    """
    is_lost = False
    waiting: list[tuple[int, Estimate | None]] = []
    for frame, estimate in estimates:
        if estimate is None or estimate.held:
            yield from ((earlier, None) for earlier, _ in waiting)
            waiting, is_lost = [], True
            yield frame, estimate
        elif is_lost or estimate.found_again:
            is_lost = True
            waiting.append((frame, estimate))
            if len(waiting) == PROOF:
                yield from waiting
                waiting, is_lost = [], False
        else:
            yield frame, estimate
    yield from ((earlier, None) for earlier, _ in waiting)


def notes_on_cuts(frames: Collection[int]) -> list[str]:
    """One note on the frames with which other scenes start, if there are any."""
    if not frames:
        return []
    named = [str(frame) for frame in sorted(frames)]
    shown, num_more = named[:MOST_NAMED], len(named) - MOST_NAMED
    last = f"{num_more} more" if num_more > 0 else shown.pop()
    where = f"frames {', '.join(shown)} and {last}" if shown else f"frame {last}"
    return [f"the clip is cut at {where}: each scene is smoothed by itself"]


def notes_on_strangers(frames: list[int]) -> list[str]:
    """One note a run of frames in which a face was seen, but not followed: it is not this one."""
    return [
        f"frames {first} to {last} show a face that does not look like the fitted one (another "
        "person's, or covered): held, not captured"
        for first, last in runs_of(frames, SEARCH_AGAIN)
    ]


def runs_of(frames: Iterable[int], most_apart: int) -> list[tuple[int, int]]:
    """First and last frame of each run of frames, neighbours in which are at most so far apart."""
    runs: list[tuple[int, int]] = []
    for frame in sorted(set(frames)):
        if runs and frame - runs[-1][1] <= most_apart:
            runs[-1] = runs[-1][0], frame
        else:
            runs.append((frame, frame))
    return runs
