# SPDX-License-Identifier: GPL-3.0-or-later
"""A clip played to the puppet, frame after frame as by a camera: a performance and its trace."""

from __future__ import annotations

import os
import time
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.media.cuts import CutWatch
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy, factored_skin, modes_of
from mimetic.muscles.extras import with_lip_shapes
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, modes_with_gaze
from mimetic.performance.rows import Rows
from mimetic.puppet.driver import Puppet, PuppetFrame
from mimetic.puppet.live_face import live_names
from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.mapping import UNTAUGHT_STD, Mapping
from mimetic.puppet.seeing import MODEL, PersonView
from mimetic.puppet.sending import PacedSending
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.progress import ATTACHED, SEARCHED, Progress, stages
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import FrameRange, check_range, fit_for
from mimetic.solve.clip_performance import clip_performance
from mimetic.solve.face_place import FacePlace
from mimetic.solve.walk import SEARCH_AGAIN, ClipWalk, find_again
from mimetic.template.face_template import FaceTemplate, load_template


@dataclass
class RunOptions:
    """How a clip is played to the puppet."""

    mode: str = "parts"  # of mapping.MODES
    basis: str = "linear"  # of mapping.BASES
    head: str = MODEL  # of driver.HEADS
    lag: float = 0.05  # s, of the filter at rest
    neutral: int | None = None  # frame in which the face is at rest, to calibrate by
    receivers: tuple[str, ...] = ()  # addresses that each frame is sent to, at the clip's speed


@dataclass
class Trace:
    """What was measured on the way: N frames, T templates."""

    scores: list[NDArray[np.float64]] = field(default_factory=list)  # T each
    lag: list[float] = field(
        default_factory=list
    )  # s, the filter's, of the value that moves fastest
    seconds: list[float] = field(default_factory=list)  # that a frame took, without decoding


def drive(
    path: str | os.PathLike[str],
    taught: TaughtSet,
    options: RunOptions,
    frames: FrameRange | None = None,
    fit: FaceFit | None = None,
    progress: Progress | None = None,
    summary: CaptureSummary | None = None,
) -> tuple[Performance, Trace]:
    """Drives a face through `frames`, forward in time, each frame by those before it alone.

    progress: called with (fraction, text) every frame; when it returns False the frames done so
    far are returned, and `notes` say so. Raises NoFace, UnreadableMedia, InvalidInput.
    """
    summary = summary if summary is not None else CaptureSummary()
    footage = Footage(path)
    first, last = check_range(frames, footage)
    if options.neutral is not None and not first <= options.neutral <= last:
        raise InvalidInput(f"--neutral {options.neutral} is not in frames {first} to {last}")
    finding, attaching, following = stages(
        progress, 0.0 if fit else SEARCHED, ATTACHED, 1 + last - first
    )
    fit = fit_for(footage, (first, last), fit, finding, summary)
    with closing(PacedSending(options.receivers, live_names(), float(footage.fps))) as sending:
        run = _Run(footage, fit, taught, options, summary, attaching, sending)
        return run.run((first, last), following)


class _Run:
    """One clip at work."""

    def __init__(
        self,
        footage: Footage,
        fit: FaceFit,
        taught: TaughtSet,
        options: RunOptions,
        summary: CaptureSummary,
        attaching: Progress,
        sending: PacedSending,
    ) -> None:
        self.footage, self.fit, self.taught, self.summary = footage, fit, taught, summary
        self.options, self.sending = options, sending
        self.template: FaceTemplate = load_template()
        self.neutral = fit.neutral_vertices(self.template)
        self.anatomy = self._anatomy(attaching)
        self.view = PersonView(fit.camera, self.neutral, taught.sides, taught.pixel)
        filtering = _core.FilterOptions()
        filtering.lag = options.lag
        self.puppet = Puppet(
            *(taught, self.view, footage.read(fit.frame), np.asarray(fit.head_pose)),
            Mapping(taught, options.mode, options.basis),
            options.head,
            filtering,
        )
        self.rows, self.trace = Rows(), Trace()

    def run(self, frames: tuple[int, int], progress: Progress) -> tuple[Performance, Trace]:
        first, last = frames
        cuts, place = CutWatch(), FacePlace(self.fit)
        num_lost = 1  # a head is not known in the first frame
        seconds = 1 / float(self.footage.fps)
        for frame, image in self.footage.frames(first, last):
            if not progress(
                (frame - first) / (1 + last - first), f"driving the face: frame {frame}"
            ):
                self.summary.stopped = True
                break
            image = np.ascontiguousarray(image)
            before = self.puppet.last
            if cuts.starts_scene(image, None if before.held else place.at(before.pose)):
                num_lost = 1
            guess = find_again(image, frame, self.fit) if num_lost % SEARCH_AGAIN == 1 else None
            start = time.perf_counter()
            seen = self.puppet.advance(image, seconds, guess)
            self.trace.seconds.append(time.perf_counter() - start)
            num_lost = num_lost + 1 if seen.held else 0
            if frame == self.options.neutral and not seen.held:
                self.puppet.set_neutral()
            self.rows.frame.append(frame)
            self.rows.pose.append(seen.pose)
            self.rows.pose_cov.append(seen.pose_cov)
            self.rows.quality.append(seen.quality if not seen.held else 0.0)
            self.rows.values.append(seen.values)
            self.rows.values_std.append(seen.std)
            self.trace.scores.append(seen.scores)
            self.trace.lag.append(float(np.min(self.puppet.filter.lags)))
            if self.sending.has_receivers:
                self.sending.send(self._state((frame - first) * seconds, seen))
        self.summary.add("drive the face", sum(self.trace.seconds))
        if not self.rows.frame:
            raise self.footage.failure or UnreadableMedia(
                f"{self.footage.path.name}: no frame of {first} to {last} is done"
            )
        return self._performance(frames), self.trace

    def _state(self, at: float, seen: PuppetFrame) -> LiveState:
        """The face's state at `at`, seconds, as a live session has it."""
        values, std = self._columns(live_names(), seen.values[None], seen.std[None])
        return LiveState(
            *(at, seen.pose, values[0], std[0], seen.quality, seen.held, True),
            *(1e3 * self.trace.seconds[-1], seen.pose_cov),
        )

    def _anatomy(self, attaching: Progress) -> Anatomy:
        skin = factored_skin(self.neutral, self.template, self.fit.calibration, attaching)
        if skin is None:
            raise UnreadableMedia(f"{self.footage.path.name}: stopped too early, no frame is done")
        anatomy = modes_of(skin).extended_by(self.fit.calibration)
        has_lips = any(name.startswith(("oris_", "lip_")) for name in self.taught.articulators)
        return with_lip_shapes(anatomy, skin) if has_lips else anatomy

    def _performance(self, frames: tuple[int, int]) -> Performance:
        anatomy = self.anatomy
        values, std = np.array(self.rows.values), np.array(self.rows.values_std)
        muscles, articulators = list(anatomy.muscle_names), list(anatomy.articulator_names)
        fields: dict[str, Any] = {}
        if set(GAZE) <= set(self.taught.channels):
            eyes = eye_geometry(self.neutral, self.template)
            fields = eyes.fields((per_degree, 0.0) for per_degree in eyes.lid_per_degree)
            fields["articulator_modes"] = modes_with_gaze(anatomy.articulator_modes)
            articulators += GAZE
        own, own_std = self._columns(muscles, values, std)
        other, other_std = self._columns(articulators, values, std)
        return clip_performance(
            *(self.rows, self.footage, self.fit, self.template, anatomy),
            **fields,
            activations=np.clip(own, 0, 1),
            activations_std=own_std,
            articulators=articulators,
            articulator_values=other,
            articulator_values_std=other_std,
            notes=self._notes(frames),
        )

    def _columns(
        self, names: list[str], values: NDArray[np.float64], std: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Values and s.d. (N x len(names)) of muscles or articulators, 0 of what was not taught."""
        own = np.zeros((len(values), len(names)))
        own_std = np.full_like(own, UNTAUGHT_STD)
        for column, name in enumerate(names):
            if name in self.taught.channels:
                taught_column = self.taught.channels.index(name)
                own[:, column] = values[:, taught_column]
                own_std[:, column] = std[:, taught_column]
        return own, own_std

    def _notes(self, frames: tuple[int, int]) -> list[str]:
        options = self.options
        lag = 1e3 * float(np.median(self.trace.lag))
        about = (
            f"driven by {len(self.taught.template_parts)} templates of {len(self.taught.looks)} "
            f"looks ({options.mode}, {options.basis}, head: {options.head}); the filter lags by "
            f"{1e3 * options.lag:.0f} ms at rest, {lag:.0f} ms in the fastest motion of the median "
            "frame"
        )
        walk = ClipWalk(self.footage, self.fit, frames, None, self.summary, "face")
        return walk.notes(self.rows, [about, *self.sending.unsent()])
