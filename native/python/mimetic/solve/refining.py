# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections honoured: frames of a performance are solved again with what a person measured.

What the pictures said of each frame is in the performance (`evidence`), so no picture is read. What
a frame was without any correction is kept in it too (`uncorrected`): every refinement begins there,
so that its result depends on the corrections it is given, not on those that were there before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.muscles.anatomy import muscle_names
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.extras import LIP_SHAPES
from mimetic.performance.confounding import with_confounding
from mimetic.performance.corrections import (
    Corrections,
    FrameCorrection,
    check_corrections,
    from_texts,
    texts_of,
)
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.evidence import evidence_factors
from mimetic.performance.gaze import GAZE, has_gaze, own_articulators, seen_articulators
from mimetic.performance.pinned_places import PinnedPlaces
from mimetic.shared.pinhole import camera_of
from mimetic.shared.progress import Progress
from mimetic.solve.full_range import (
    assumed_anatomy,
    assumed_modes,
    refining_options,
)
from mimetic.solve.refined_spans import (
    FrameSpan,
    check_measured_within,
    limits_of_change,
    spans_of,
    with_neighbours,
)
from mimetic.solve.stated import gap_places
from mimetic.solve.tracking import face_motion
from mimetic.template.face_template import load_template

Show = Callable[[float], bool]  # fraction -> go on?


def refined(
    performance: Performance,
    corrections: Corrections,
    frames: tuple[int | None, int | None] | None = None,
    direction: str = "both",
    progress: Progress | None = None,
) -> Performance:
    """The performance with all `corrections` and no others, as measurements beside the pictures'.

    frames: those that may change, the last included; without them all that corrections reach, old
    and new ones, and whatever an earlier refinement had to leave: `forward` none before the first
    of them, `backward` none after the last. Nothing goes over a cut. progress may stop it: the
    performance is given back as it was. Raises InvalidInput.
    """
    check_refinable(performance)
    template = load_template()
    first, last = int(performance.frame[0]), int(performance.frame[-1])
    names = [*performance.muscles, *performance.articulators]
    if not has_gaze(performance):
        names = [name for name in names if name not in GAZE]
    check_corrections(corrections, (first, last), template.num_skin_faces, names)
    before = from_texts(performance.corrections or [])
    all_corrections = (*before, *corrections)
    limits = limits_of_change(performance, all_corrections, frames, direction)
    check_measured_within(performance, limits, before, corrections)
    refinement = Refinement(performance, spans_of(performance, corrections, limits))
    spans = spans_of(performance, all_corrections, limits, refinement.corrected_rows())
    for number, span in enumerate(spans):

        def show(fraction: float, number: int = number, span: FrameSpan = span) -> bool:
            text = f"refining frames {performance.frame[span[0]]} to {performance.frame[span[1]]}"
            return progress is None or progress((number + fraction) / len(spans), text)

        if not refinement.refine(span, corrections, show):
            return performance
    return refinement.result(corrections)


def check_of_capture(corrections: Corrections, frames: FrameSpan) -> None:
    """Before a capture of these frames; raises InvalidInput."""
    names = [*muscle_names(), *ARTICULATORS, *LIP_SHAPES, *GAZE]
    check_corrections(corrections, frames, load_template().num_skin_faces, names)


def within(corrections: Corrections, performance: Performance) -> Corrections:
    """Those of its frames: a capture that was stopped has fewer."""
    frames = set(performance.frame.tolist())
    return tuple(entry for entry in corrections if entry.frame in frames)


def check_refinable(performance: Performance) -> None:
    """Raises InvalidInput for a performance that cannot be solved again."""
    if performance.evidence is None:
        raise InvalidInput(
            "this performance keeps no evidence of its pictures (an earlier version made it, or it "
            "is no capture): capture the footage again"
        )
    template = load_template()
    if not np.array_equal(performance.faces, template.faces):
        raise InvalidInput("this performance is not of Mimetic's own head: it cannot be refined")


class Refinement:
    """A performance whose rows are solved again, run by run.

    Muscles are solved for in units of the assumed strengths, as the capture does, within the
    person's extents; everything here is relative to these.
    """

    def __init__(self, performance: Performance, corrected: list[FrameSpan]) -> None:
        """corrected: the rows that the corrections to be honoured reach."""
        self.performance = performance
        self.corrected = corrected
        self.template = load_template()
        self.camera = camera_of(performance.intrinsics, performance.image_size)
        self.names = [name for name in performance.articulators if name not in GAZE]
        self.columns = [performance.articulators.index(name) for name in self.names]
        extent = performance.muscle_extent
        self.extent = np.ones(len(performance.muscles)) if extent is None else extent
        self.scale = np.append(self.extent, np.ones(len(self.names)))  # of all values
        self.factors = evidence_factors(self.scale)
        anatomy = assumed_anatomy(performance, self.names, self.columns)
        neutral = performance.neutral_vertices
        self.motion = face_motion(neutral, self.template, anatomy, extent=self.extent)
        self.poses = performance.head_pose.copy()
        self.pose_covariances = performance.head_pose_cov.copy()
        self.values = np.hstack(
            [performance.activations, seen_articulators(performance)[:, self.columns]]
        )
        own_std = performance.articulator_values_std
        if own_std is None:
            own_std = np.full(performance.articulator_values.shape, 0.1)
        self.own_std = own_std.copy()
        self.values_std = np.hstack([performance.activations_std, own_std[:, self.columns]])
        assert performance.evidence is not None  # `check_refinable`
        self.evidence = performance.evidence.copy()
        self.gaze_columns = [
            *(performance.articulators.index(name) for name in GAZE if has_gaze(performance))
        ]
        self.gaze = performance.articulator_values[:, self.gaze_columns]  # a copy
        self.moved = np.zeros(performance.num_frames, dtype=bool)
        self.uncorrected = self._uncorrected()

    def _uncorrected(self) -> NDArray[np.float64] | None:
        """N x R; None for corrections of an earlier version, which did not keep it."""
        performance, rows = self.performance, self._rows()
        if performance.uncorrected is None:
            return None if performance.corrections else rows
        if performance.uncorrected.shape[1] == rows.shape[1] - self.gaze.shape[1]:
            # Of an earlier version, which corrected no gaze
            return np.hstack([performance.uncorrected, self.gaze])
        if performance.uncorrected.shape != rows.shape:
            raise InvalidInput(
                f"performance uncorrected has {performance.uncorrected.shape[1]} numbers a frame, "
                f"of {self.values.shape[1]} values there are {rows.shape[1]}; capture the footage "
                "again"
            )
        return performance.uncorrected

    def _rows(self) -> NDArray[np.float64]:
        """N x R: pose (16), its covariance (36), values, their deviations, the evidence's gradient,
        gaze.

        The evidence's information does not depend on corrections.
        """
        parts = (self.poses, self.pose_covariances, self.values, self.values_std, self._gradients())
        return np.hstack([*(part.reshape(len(self.values), -1) for part in parts), self.gaze])

    def _gradients(self) -> NDArray[np.float32]:
        return self.evidence[:, -(6 + self.values.shape[1]) :]

    def refine(
        self, span: FrameSpan, corrections: Corrections, show: Callable[[float], bool]
    ) -> bool:
        """Rows of a span, both ends included, from what they were without corrections.

        False, with nothing to be kept, when stopped.
        """
        if self.uncorrected is None:
            return self._solve(span, corrections, show)
        self._take_back(span)
        if self._joins_corrected(span):
            return self._solve(span, corrections, show)
        # No more of it than they reach: what was corrected before is to leave nothing behind
        inside = [own for own in self.corrected if span[0] <= own[0] and own[1] <= span[1]]
        of_skin = [own for own in inside if any(map(_is_of_skin, self._within(own, corrections)))]
        for number, own in enumerate(of_skin):

            def go_on(fraction: float, number: int = number) -> bool:
                return show((number + fraction) / len(of_skin))

            if not self._solve(own, corrections, go_on):
                return False
        for own in inside:
            if own not in of_skin:
                self._turn_eyes(own, corrections)
        return bool(of_skin) or show(1.0)

    def _within(self, span: FrameSpan, corrections: Corrections) -> list[FrameCorrection]:
        first, last = (int(self.performance.frame[row]) for row in span)
        return [entry for entry in corrections if first <= entry.frame <= last]

    def _turn_eyes(self, span: FrameSpan, corrections: Corrections) -> None:
        """Gaze is solved by itself: it comes after the head and moves no skin but lids."""
        begin, end = span
        pins = [
            (
                *(self.performance.index_of(entry.frame) - begin, GAZE.index(name)),
                *(pinned.value, pinned.std, entry.reach),
            )
            for entry in self._within(span, corrections)
            for name, pinned in entry.values.items()
            if name in GAZE
        ]
        if pins:
            rows = slice(begin, end + 1)
            self.gaze[rows] = _core.corrected_gaze(self.gaze[rows], pins)
            self.moved[rows] = True

    def _take_back(self, span: FrameSpan) -> None:
        assert self.uncorrected is not None  # `refine`
        rows = slice(span[0], span[1] + 1)
        num_values = self.values.shape[1]
        ends = np.cumsum([16, 36, num_values, num_values, 6 + num_values])
        pose, covariance, values, std, gradient, self.gaze[rows] = np.split(
            self.uncorrected[rows], ends, axis=1
        )
        self.poses[rows] = pose.reshape(-1, 4, 4)
        self.pose_covariances[rows] = covariance.reshape(-1, 6, 6)
        self.values[rows], self.values_std[rows] = values, np.abs(std)
        self._gradients()[rows] = gradient
        self.moved[rows] = True

    def _joins_corrected(self, span: FrameSpan) -> bool:
        """Whether a frame that it must join without a jump is corrected and stays so."""
        first, after = with_neighbours(self.performance, span)
        is_corrected = self.corrected_rows(slice(0, -self.gaze.shape[1] or None))
        return bool(is_corrected[first : span[0]].any() or is_corrected[span[1] + 1 : after].any())

    def corrected_rows(self, columns: slice = slice(None)) -> NDArray[np.bool_]:
        """N: which are not as they were without corrections; none where that is not known.

        But for rounding: articulators are stored without what gaze does to lids.
        """
        if self.uncorrected is None:
            return np.zeros(self.performance.num_frames, dtype=bool)
        rows, without = self._rows()[:, columns], self.uncorrected[:, columns]
        is_same: NDArray[np.bool_] = np.isclose(rows, without, rtol=1e-9, atol=1e-9).all(axis=1)
        return ~is_same

    def _solve(
        self, span: FrameSpan, corrections: Corrections, show: Callable[[float], bool]
    ) -> bool:
        begin, end = span
        first, after = with_neighbours(self.performance, span)
        options = refining_options(self.performance.fps)
        options.fixed_first, options.fixed_last = begin - first, after - 1 - end
        measured = [
            self._measured(entry, self.performance.index_of(entry.frame) - first)
            for entry in self._within(span, corrections)
            if _is_of_skin(entry)
        ]
        estimates = [self._estimate(i) for i in range(first, after)]
        is_stopped = False

        def go_on(fraction: float) -> bool:
            nonlocal is_stopped
            is_stopped = is_stopped or not show(fraction)
            return not is_stopped

        solved = _core.smooth_corrected(
            estimates, self.motion, self.camera, measured, options, go_on
        )
        if is_stopped:
            return False
        for i in range(begin, end + 1):
            estimate = solved[i - first]
            self.poses[i], self.pose_covariances[i] = estimate.camera_from_head, estimate.pose_cov
            self.values[i] = estimate.values / self.scale
            self.values_std[i] = estimate.values_std / self.scale
            self.evidence[i] = _core.pack_evidence(estimate) * self.factors
        self.moved[begin : end + 1] = True
        self._turn_eyes(span, corrections)
        return True

    def _estimate(self, i: int) -> _core.FrameEstimate:
        quality = float(self.performance.quality[i])
        values, std = self.values[i] * self.scale, self.values_std[i] * self.scale
        return _core.stored_estimate(
            *(self.poses[i], self.pose_covariances[i], values, std),
            *(self.evidence[i] / self.factors, quality, quality < HELD_QUALITY),
        )

    def _measured(self, entry: FrameCorrection, index: int) -> _core.Correction:
        i = self.performance.index_of(entry.frame)
        pins = []
        if entry.pins:
            places = PinnedPlaces(self.template, entry.pins)
            points = places.positions(self._unmoved(i))
            modes = np.stack([places.positions(mode) for mode in self._modes()])
            pins = [
                _core.SkinPin(points[k], modes[:, k].copy(), np.array(pin.pixel), pin.std)
                for k, pin in enumerate(entry.pins)
            ]
        pose = entry.pose
        poses = (
            []
            if pose is None
            else [_core.PosePin(pose.head_pose, pose.rotation_std, pose.translation_std)]
        )
        return _core.Correction(index, entry.reach, pins, poses, list(self._sums(entry)))

    def _sums(self, entry: FrameCorrection) -> Iterator[_core.ValuePin]:
        names = [*self.performance.muscles, *self.names]
        for name, pinned in entry.values.items():
            if name in GAZE:
                continue
            weights = np.zeros(len(names))
            weights[names.index(name)] = 1.0 / self.scale[names.index(name)]
            yield _core.ValuePin(weights, pinned.value, pinned.std)
        if entry.lip_gap is not None:
            modes = self._modes()
            unmoved = self._unmoved(self.performance.index_of(entry.frame))
            for top, bottom in gap_places(self.template):
                weights = np.array(modes[:, top, 1] - modes[:, bottom, 1], dtype=np.float64)
                at_rest = float(unmoved[top, 1] - unmoved[bottom, 1])
                yield _core.ValuePin(weights, entry.lip_gap.value - at_rest, entry.lip_gap.std)

    def _modes(self) -> NDArray[np.float32]:
        """M x V x 3 of muscles, then of the articulators that are solved for."""
        performance = self.performance
        assert performance.articulator_modes is not None
        return np.concatenate(
            [assumed_modes(performance), performance.articulator_modes[self.columns]]
        )

    def _unmoved(self, i: int) -> NDArray[np.float64]:
        """V x 3: a frame's surface without what muscles and articulators do."""
        performance = self.performance
        if performance.detail_modes is None or performance.detail_coefficients is None:
            return performance.neutral_vertices
        shape = (-1, performance.neutral_vertices.size)
        detail = performance.detail_coefficients[i].astype(np.float32)
        moved = detail @ performance.detail_modes.reshape(shape)
        return performance.neutral_vertices + moved.reshape(-1, 3)

    def result(self, corrections: Corrections) -> Performance:
        performance = self.performance
        num_muscles = len(performance.muscles)
        articulators, std = performance.articulator_values.copy(), self.own_std
        rows, columns = self.moved, np.array(self.columns, dtype=np.intp)
        seen = seen_articulators(performance)
        seen[np.ix_(rows, columns)] = self.values[rows, num_muscles:]
        seen[np.ix_(rows, np.array(self.gaze_columns, dtype=np.intp))] = self.gaze[rows]
        articulators[rows] = own_articulators(performance, seen)[rows]
        std[np.ix_(rows, columns)] = self.values_std[rows, num_muscles:]
        poses = self.poses.copy()
        poses[rows, :3, :3] = _core.nearest_rotations(np.ascontiguousarray(poses[rows, :3, :3]))
        poses[:, 3] = [0, 0, 0, 1]
        refined = replace(
            performance,
            head_pose=poses,
            head_pose_cov=_core.nearest_covariances(self.pose_covariances),
            activations=np.clip(self.values[:, :num_muscles], 0, 1),
            activations_std=self.values_std[:, :num_muscles],
            articulator_values=articulators,
            articulator_values_std=std,
            evidence=self.evidence,
            corrections=texts_of(corrections) or None,
            uncorrected=self.uncorrected if self.corrected_rows().any() else None,
        )
        return with_confounding(refined)


def _is_of_skin(entry: FrameCorrection) -> bool:
    """Whether it says more of its frame than where the eyes look."""
    is_more = entry.pins or entry.pose is not None or entry.lip_gap is not None
    return bool(is_more or any(name not in GAZE for name in entry.values))
