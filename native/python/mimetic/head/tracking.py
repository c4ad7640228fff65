# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage to head motion alone: the paper's section 4."""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.fitting import FaceFit
from mimetic.head.smoothing import check_strength, smoothed_scenes
from mimetic.media.backward import frames_backward
from mimetic.media.cuts import CutWatch
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import attach
from mimetic.performance.document import Performance
from mimetic.performance.rows import Rows
from mimetic.shared.progress import ATTACHED, SEARCHED, Progress, stages
from mimetic.solve.clip_capture import CaptureSummary, FrameRange, check_range, fit_for
from mimetic.solve.tracking import ACTIVATION_STD
from mimetic.solve.walk import (
    SEARCH_AGAIN,
    check_any_done,
    find_again,
    notes_on,
    notes_on_strangers,
    proved,
)
from mimetic.template.face_template import FaceTemplate, load_template

Seen = tuple[int, _core.HeadEstimate | None]  # None: a head was seen, but is not surely this one
MODELS = ("ellipsoid", "plane", "surface")
# The regions of skin that each model leaves out. The patch is the face's; hair hides the scalp,
# but the skull is what makes a head an ellipsoid.
LEFT_OUT = {
    "ellipsoid": ("neck", "ear", "mouth_cavity", "eye_socket"),
    "plane": ("neck", "ear", "mouth_cavity", "eye_socket", "scalp"),
    "surface": ("neck", "ear", "mouth_cavity", "eye_socket", "scalp"),
}
# Between which landmarks parts lie that move on their own, their radius in metres, and their share
MOVING_PARTS = (
    (("mouth_corner.L", "mouth_corner.R"), 0.035, 0.9),
    (("eye_inner.L", "eye_outer.L"), 0.025, 0.8),
    (("eye_inner.R", "eye_outer.R"), 0.025, 0.8),
)
SMOOTHING = 1.0  # standard deviations as they are
PASS_COST = 0.3  # of a frame, beside following the face in it (`mimetic.shared.progress`)
NUM_PASSES = 2  # over the clip: the second with the shape that the first one found
UNSEEN_COV = np.diag([1e-3] * 3 + [1e-4] * 3)  # rad^2, m^2: of a head that is not seen for a frame
NECK_BELOW, NECK_RADIUS = 0.05, 0.04  # metres


def head_shape(
    model: str, neutral_vertices: NDArray[np.float64], template: FaceTemplate
) -> _core.HeadShape:
    """The `model` (one of MODELS) of a person's head; neutral_vertices: V x 3, metres."""
    if model not in MODELS:
        raise InvalidInput(f"head model {model!r}; there are {', '.join(MODELS)}")
    skin = np.ascontiguousarray(neutral_vertices[: template.num_skin_vertices])
    faces = np.asarray(template.skin_faces)
    left_out = template.in_region(*LEFT_OUT[model])
    faces = np.ascontiguousarray(faces[~left_out[faces].any(axis=1)], dtype=np.int32)
    # The limit surface, where the face is, lies inside of the control mesh.
    limit = _core.SubdividedMesh(np.ascontiguousarray(template.skin_faces), len(skin), 0)
    vertices = np.ascontiguousarray(limit.positions(skin)[: len(skin)])
    shape = _core.make_head_shape(getattr(_core.HeadModel, model), vertices, faces)
    shape.moving_parts = [
        _core.MovingPart(
            skin[[template.landmark(n) for n in names], :2].mean(axis=0), radius, share
        )
        for names, radius, share in MOVING_PARTS
    ]
    # What the model covers under the chin is neck and clothes.
    below = skin[template.landmark("menton"), :2] - [0, NECK_BELOW]
    shape.moving_parts = [*shape.moving_parts, _core.MovingPart(below, NECK_RADIUS, 1.0)]
    return shape


def track_head(
    path: str | os.PathLike[str],
    model: str = "ellipsoid",
    frames: FrameRange | None = None,
    fit: FaceFit | None = None,
    progress: Progress | None = None,
    summary: CaptureSummary | None = None,
    fast: bool = False,
    smoothing: float = SMOOTHING,
    flow_alone: bool = False,
) -> Performance:
    """Follows the head in `frames` (both ends included); muscles are at rest and not measured.

    model: one of MODELS. fast: registers samples of the skin, and asks the flow only where they
    leave doubt. smoothing: strength of `mimetic.head.smoothing`, scene by scene; 0 leaves each
    frame as it was measured. Covariances are those of single frames either way: most of an error
    is the model's, which neighbours share. flow_alone: the paper's own form, one pass by the flow
    from frame to frame, without reference textures. progress: called with (fraction, text) every
    frame; when it returns False the frames done so far are returned, and `notes` say so. Raises
    NoFace, UnreadableMedia, InvalidInput.
    """
    if model not in MODELS:
        raise InvalidInput(f"head model {model!r}; there are {', '.join(MODELS)}")
    check_strength(smoothing)
    summary = summary if summary is not None else CaptureSummary()
    footage = Footage(path)
    first, last = check_range(frames, footage)
    finding, following, _ = stages(
        progress,
        0.0 if fit else SEARCHED,
        NUM_PASSES * PASS_COST * (1 + last - first),
        ATTACHED,
    )
    fit = fit_for(footage, (first, last), fit, finding, summary)
    options = follow_options(fast, flow_alone)
    motion = _HeadMotion(footage, fit, model, (first, last), following, summary, options)
    return smoothed_scenes(motion.run(), motion.scene_starts, smoothing)


def follow_options(fast: bool = False, flow_alone: bool = False) -> _core.HeadOptions:
    """As `track_head` takes them."""
    options = _core.HeadOptions()
    options.fast = fast
    if flow_alone:
        options.max_key_views = 0
    return options


class _HeadMotion:
    """One clip at work."""

    def __init__(
        self,
        footage: Footage,
        fit: FaceFit,
        model: str,
        frames: tuple[int, int],
        progress: Progress | None,
        summary: CaptureSummary,
        options: _core.HeadOptions,
    ) -> None:
        self.options = options
        self.footage, self.fit, self.model = footage, fit, model
        self.progress, self.summary = progress, summary
        self.first, self.last = frames
        self.num_done = 0
        self.scene_starts: set[int] = set()
        self.strangers: list[int] = []  # frames in which a face was seen that is not this one
        num_passes = NUM_PASSES if options.max_key_views else 1
        self.num_needed = num_passes * (1 + max(fit.frame, self.last) - min(fit.frame, self.first))
        self.template = load_template()
        self.neutral = fit.neutral_vertices(self.template)

    def run(self) -> Performance:
        reference = np.ascontiguousarray(self.footage.read(self.fit.frame))
        shape = head_shape(self.model, self.neutral, self.template)
        pose = np.asarray(self.fit.head_pose, dtype=np.float64)
        tracker = _core.HeadTracker(self.fit.camera, shape, reference, pose, self.options)
        rows = self._both_ways(tracker, reference)
        # What later frames say about the head's shape and the reference poses serves earlier ones.
        if not self.summary.stopped and tracker.relax():
            again = self._both_ways(tracker, reference)
            rows = rows if self.summary.stopped else again
            rows = self._placed(tracker, rows)
        self.summary.head_shape = tracker.shape
        return self._performance(rows)

    def _placed(self, tracker: _core.HeadTracker, rows: Rows) -> Rows:
        """The ellipsoid's motion as the person's skin has it."""
        if self.model != "ellipsoid" or self.summary.stopped:
            return rows
        views = tracker.place_on(head_shape("surface", self.neutral, self.template))
        if not views:
            return rows
        tracker.move_views(list(_core.place_poses(np.array([v.on_model for v in views]), views)))
        return replace(rows, pose=list(_core.place_poses(np.array(rows.pose), views)))

    def _both_ways(self, tracker: _core.HeadTracker, reference: NDArray[np.uint8]) -> Rows:
        """All frames, backward and forward from the reference frame."""
        at_reference = tracker.advance(reference, self.fit.head_pose)
        backward, forward = Rows(), Rows()
        if self.fit.frame > self.first:
            images = frames_backward(self.footage, self.fit.frame - 1, self.first)
            self._append(backward, proved(self._follow(tracker, images)), at_reference)
            tracker.restart(reference, at_reference)
        ahead: Iterable[Seen] = ()
        if self.last > self.fit.frame and not self.summary.stopped:
            images = self.footage.frames(self.fit.frame + 1, self.last)
            ahead = proved(self._follow(tracker, images))
        estimates = itertools.chain([(self.fit.frame, at_reference)], ahead)
        self._append(forward, estimates, at_reference)
        return backward.reversed() + forward

    def _append(self, rows: Rows, estimates: Iterable[Seen], good: _core.HeadEstimate) -> None:
        """Rows of the frames that were asked for; a held frame has the last good one's pose."""
        for frame, estimate in estimates:
            is_held = estimate is None or estimate.held
            if estimate is not None and not estimate.held:
                good = estimate
            if self.first <= frame <= self.last:
                rows.frame.append(frame)
                rows.pose.append(np.asarray(good.camera_from_head))
                unseen = np.asarray(good.covariance) + UNSEEN_COV
                rows.pose_cov.append(
                    unseen if estimate is None else np.asarray(estimate.covariance)
                )
                rows.quality.append(0.0 if is_held else good.quality)

    def _follow(
        self, tracker: _core.HeadTracker, images: Iterator[tuple[int, NDArray[np.uint8]]]
    ) -> Iterator[Seen]:
        """Frame by frame, until the images end or the user stops."""
        num_lost = 0
        last = 0
        cuts = CutWatch()
        for frame, image in images:
            fraction = self.num_done / self.num_needed
            text = f"following the head: frame {frame}"
            if self.summary.stopped or (self.progress and not self.progress(fraction, text)):
                self.summary.stopped = True
                return
            start = time.perf_counter()
            guess = None
            cut = cuts.starts_scene(image)
            if cut:
                self.scene_starts.add(max(frame, last))
            if cut or (num_lost and num_lost % SEARCH_AGAIN == 0):
                guess = find_again(image, frame, self.fit)
            last = frame
            estimate = tracker.advance(np.ascontiguousarray(image), guess)
            num_lost = num_lost + 1 if estimate.held else 0
            if guess is not None and estimate.held:
                self.strangers.append(frame)
            self.num_done += 1
            self.summary.add("follow the head", time.perf_counter() - start)
            yield frame, estimate

    def _performance(self, rows: Rows) -> Performance:
        check_any_done(rows, self.footage, (self.first, self.last), self.summary.stopped)
        anatomy = attach(self.neutral, self.template)
        shape = (len(rows.frame), len(anatomy.muscle_names))
        return Performance(
            frame=np.array(rows.frame),
            fps=float(self.footage.fps),
            image_size=np.array(self.footage.size),
            stored_size=np.array(self.footage.stored_size),
            intrinsics=self.fit.intrinsics,
            head_pose=rows.rigid_poses(),
            head_pose_cov=rows.pose_covariances(),
            muscles=list(anatomy.muscle_names),
            muscle_modes=anatomy.muscle_modes,
            groups=anatomy.groups,
            activations=np.zeros(shape),
            activations_std=np.full(shape, ACTIVATION_STD),
            articulators=list(anatomy.articulator_names),
            articulator_values=np.zeros((shape[0], len(anatomy.articulator_names))),
            articulator_modes=anatomy.articulator_modes,
            neutral_vertices=self.neutral,
            faces=self.template.faces.astype(np.int64),
            quality=np.clip(rows.quality, 0, 1),
            notes=self._notes(rows),
            footage=self.footage.identity,
        )

    def _notes(self, rows: Rows) -> list[str]:
        notes = [
            *(*self.footage.warnings, *self.fit.warnings),
            f"head motion alone, by the {self.model}: muscles were not measured",
            *notes_on(rows, (self.first, self.last), self.summary.stopped, "head"),
            *notes_on_strangers(self.strangers),
        ]
        self.summary.warnings = notes
        return notes
