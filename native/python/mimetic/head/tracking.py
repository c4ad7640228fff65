# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage to head motion alone: the paper's section 4."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.fitting import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.head.smoothing import check_strength, smoothed
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import attach
from mimetic.performance.document import Performance
from mimetic.performance.rows import Rows
from mimetic.shared.note_beginnings import HEAD_ALONE
from mimetic.shared.progress import ATTACHED, SEARCHED, Progress, stages
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import FrameRange, check_range, fit_for
from mimetic.solve.clip_performance import clip_performance
from mimetic.solve.tracking import ACTIVATION_STD
from mimetic.solve.walk import ClipWalk, Image, Pose, proved
from mimetic.template.face_template import FaceTemplate, load_template

Seen = tuple[int, _core.HeadEstimate | None]  # None: a head was seen, but not certainly this one
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
# rad^2, m^2: what a head may turn and move by in a second in which it is not seen; as the tracker's
UNSEEN_COV = np.diag([0.03] * 3 + [3e-3] * 3)
NECK_BELOW, NECK_RADIUS = 0.05, 0.04  # metres


def head_shape(
    model: str, neutral_vertices: NDArray[np.float64], template: FaceTemplate
) -> _core.HeadShape:
    """The `model` (one of MODELS) of a person's head; neutral_vertices: V x 3, metres."""
    if model not in MODELS:
        raise InvalidInput(f"head model {model!r}; there are {', '.join(MODELS)}")
    skin = np.ascontiguousarray(neutral_vertices[: template.num_skin_vertices])
    faces = np.asarray(template.skin_faces)
    is_left_out = template.in_region(*LEFT_OUT[model])
    faces = np.ascontiguousarray(faces[~is_left_out[faces].any(axis=1)], dtype=np.int32)
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
    lens: KnownLens | None = None,
) -> Performance:
    """Follows the head in `frames` (both ends included); muscles are at rest and not measured.

    model: one of MODELS. fast: registers samples of the skin, and asks the flow only where they
    leave doubt. smoothing: strength of `mimetic.head.smoothing`, scene by scene; 0 leaves each
    frame as it was measured. Covariances are those of single frames either way: most of an error
    is the model's, which neighbours share. flow_alone: the paper's own form, one pass by the flow
    from frame to frame, without reference textures. lens: that a face without a fit is found
    with, if it is known. progress: called with (fraction, text) every frame; when it returns False
    the frames done so far are returned, and `notes` say so. Raises NoFace,
    UnreadableMedia, InvalidInput.
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
    fit = fit_for(footage, (first, last), fit, finding, summary, lens)
    options = follow_options(fast, flow_alone)
    options.frame_rate = float(footage.fps)
    motion = _HeadMotion(footage, fit, model, (first, last), following, summary, options).run()
    return replace(motion, head_pose=smoothed(motion, smoothing).head_pose)


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
        self.options, self.model = options, model
        num_passes = NUM_PASSES if options.max_key_views else 1
        self.walk = ClipWalk(footage, fit, frames, progress, summary, "head", num_passes)
        self.template = load_template()
        self.neutral = fit.neutral_vertices(self.template)

    def run(self) -> Performance:
        fit, summary = self.walk.fit, self.walk.summary
        reference = np.ascontiguousarray(self.walk.footage.read(fit.frame))
        shape = head_shape(self.model, self.neutral, self.template)
        pose = np.asarray(fit.head_pose, dtype=np.float64)
        tracker = _core.HeadTracker(fit.camera, shape, reference, pose, self.options)
        rows = self._both_ways(tracker, reference)
        # Later frames inform the head's shape and the reference poses for earlier ones.
        if not summary.stopped and tracker.relax():
            again = self._both_ways(tracker, reference)
            rows = rows if summary.stopped else again
            rows = self._placed(tracker, rows)
        summary.head_shape = tracker.shape
        return self._performance(rows)

    def _placed(self, tracker: _core.HeadTracker, rows: Rows) -> Rows:
        """The ellipsoid's motion as the person's skin has it."""
        if self.model != "ellipsoid" or self.walk.summary.stopped:
            return rows
        views = tracker.place_on(head_shape("surface", self.neutral, self.template))
        if not views:
            return rows
        tracker.move_views(list(_core.place_poses(np.array([v.on_model for v in views]), views)))
        return replace(rows, pose=list(_core.place_poses(np.array(rows.pose), views)))

    def _both_ways(self, tracker: _core.HeadTracker, reference: NDArray[np.uint8]) -> Rows:
        """All frames, backward and forward from the reference frame."""
        fit, (first, last) = self.walk.fit, self.walk.frames
        at_reference = tracker.advance(reference, fit.head_pose)
        backward, forward = Rows(), Rows()
        if fit.frame > first:
            behind = proved(self._follow(tracker, first, reference))
            self._append(backward, behind, at_reference)
            tracker.restart(reference, at_reference)
        ahead: Iterable[Seen] = ()
        if last > fit.frame:
            ahead = proved(self._follow(tracker, last, reference))
        self._append(forward, itertools.chain([(fit.frame, at_reference)], ahead), at_reference)
        return (backward.reversed() + forward).within(first, last)

    def _append(self, rows: Rows, estimates: Iterable[Seen], good: _core.HeadEstimate) -> None:
        """Rows of the frames; good: that of the fit's frame.

        A held frame has the last good one's pose, and a covariance that grows with the time since.
        """
        time_of, seen_in = self.walk.footage.time_of, self.walk.fit.frame
        for frame, estimate in estimates:
            is_held = estimate is None or estimate.held
            if estimate is not None and not estimate.held:
                good, seen_in = estimate, frame
            unseen = abs(time_of(frame) - time_of(seen_in))
            rows.frame.append(frame)
            rows.pose.append(np.asarray(good.camera_from_head))
            rows.pose_cov.append(np.asarray(good.covariance) + unseen * UNSEEN_COV)
            rows.quality.append(0.0 if is_held else good.quality)

    def _follow(self, tracker: _core.HeadTracker, end: int, reference: Image) -> Iterator[Seen]:
        """Frame by frame, until the images end or the user stops."""

        def advance(_frame: int, image: Image, guess: Pose | None) -> _core.HeadEstimate:
            return tracker.advance(image, guess)

        return self.walk.follow(end, advance, reference, across_scenes=True, forget=tracker.forget)

    def _performance(self, rows: Rows) -> Performance:
        self.walk.check_any_done(rows)
        anatomy = attach(self.neutral, self.template)
        shape = (len(rows.frame), len(anatomy.muscle_names))
        return clip_performance(
            *(rows, self.walk.footage, self.walk.fit, self.template, anatomy),
            scene_starts=self.walk.scene_starts,
            activations=np.zeros(shape),
            activations_std=np.full(shape, ACTIVATION_STD),
            articulator_values=np.zeros((shape[0], len(anatomy.articulator_names))),
            notes=self.walk.notes(
                rows, [f"{HEAD_ALONE}, by the {self.model}: muscles were not measured"]
            ),
        )
