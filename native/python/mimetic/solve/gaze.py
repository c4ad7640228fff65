# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of a clip, from the irises that the networks saw in its frames.

It comes after head and muscles and has no part in them: an iris that moves turns no head. What it
says of the lids is how much of their closure is the gaze's.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.muscles.eyeballs import SIDES, eye_geometry
from mimetic.performance.gaze import GAZE, modes_with_gaze
from mimetic.performance.rows import Rows
from mimetic.solve.features import EYE_FACES
from mimetic.template.face_template import FaceTemplate

LONGEST_GAP = 2.0  # s without an iris, after which the eyes may look anywhere
FACING = np.array([[EYE_FACES, 0.0, 1.0], [-EYE_FACES, 0.0, 1.0]])


class ClipGaze:
    """Fields of the performance for eyes that turn; made from what was followed of a clip.

    at_fit: of the fitted frame, which need not be among the rows. scene_starts: frames after a cut.
    """

    def __init__(
        self,
        fit: FaceFit,
        template: FaceTemplate,
        rows: Rows,
        at_fit: _core.FrameEstimate,
        fps: float,
        scene_starts: Collection[int] = (),
    ) -> None:
        neutral = fit.neutral_vertices(template)
        self.eyes = eye_geometry(neutral, template)
        seen, is_clip = _with_fitted_frame(rows, fit.frame, at_fit, fps)
        first = int(np.argmax(is_clip))  # of the clip's rows among what is followed
        starts = [start for start in scene_starts if rows.frame[0] < start <= rows.frame[-1]]
        track = _core.follow_gaze(
            fit.camera,
            _core.Eyeballs(self.eyes.centers, self.eyes.radii, FACING),
            seen.rigid_poses(),
            seen.pose_covariances(),
            np.array(seen.irises),
            fps,
            (first + np.searchsorted(rows.frame, starts)).tolist(),
        )
        self.angles, self.std = track.angles[is_clip], track.std[is_clip]
        self.rest_std = track.rest_std
        # At gaze 0 an eye stands as this person's does
        rest = np.array(track.rest)
        self.neutral, self.iris_centers = (
            _core.turned_eyeballs(points, of_eye, self.eyes.centers, rest)
            for points, of_eye in (
                (neutral, self.eyes.eye_of_vertex),
                (self.eyes.fronts(), np.array([1, 2], dtype=np.int32)),
            )
        )
        # The fitted head has its lids as they are at the gaze of the fitted frame
        pitches = track.angles[seen.frame.index(fit.frame), 1::2].tolist()
        self.following = [
            _core.LidFollowing(per_degree, pitch)
            for per_degree, pitch in zip(self.eyes.lid_per_degree, pitches, strict=True)
        ]

    def fields(
        self,
        names: list[str],
        values: NDArray[np.float64],
        std: NDArray[np.float64],
        modes: NDArray[np.float32],
    ) -> dict[str, Any]:
        """Keys of the performance. names: A articulators; values, std: N x A; modes: A x V x 3."""
        own, own_std = values.copy(), std.copy()
        # How the eyes rest is the same in the fitted frame, and so no error of a lid
        of_frame = np.sqrt(np.maximum(self.std**2 - np.square(self.rest_std), 0))
        for eye, (side, follow) in enumerate(zip(SIDES, self.following, strict=True)):
            lid, pitch = names.index(f"lid_upper.{side}"), 2 * eye + 1
            own[:, lid] = follow.own(values[:, lid], self.angles[:, pitch])
            own_std[:, lid] = np.hypot(std[:, lid], follow.per_degree * of_frame[:, pitch])
        return {
            "articulators": [*names, *GAZE],
            "articulator_values": np.hstack([own, self.angles]),
            "articulator_values_std": np.hstack([own_std, self.std]),
            "articulator_modes": modes_with_gaze(modes),
            "neutral_vertices": self.neutral,
            **self.eyes.fields((f.per_degree, f.rest_pitch) for f in self.following),
            "iris_centers": self.iris_centers,
        }


def _with_fitted_frame(
    rows: Rows, fitted: int, at_fit: _core.FrameEstimate, fps: float
) -> tuple[Rows, NDArray[np.bool_]]:
    """What gaze is followed by in the rows and, if it is not among them, in the fitted frame, with
    frames between in which no iris is seen; and which of all these are the clip's."""
    clip = Rows(frame=rows.frame, pose=rows.pose, pose_cov=rows.pose_cov, irises=rows.irises)
    if fitted in clip.frame:
        return clip, np.ones(len(clip.frame), bool)
    is_before = fitted < clip.frame[0]
    apart = clip.frame[0] - fitted if is_before else fitted - clip.frame[-1]
    num_silent = min(apart - 1, round(LONGEST_GAP * fps))
    irises = np.array(at_fit.irises)
    beyond = Rows(
        frame=[0] * num_silent + [fitted],
        pose=[np.array(at_fit.camera_from_head)] * (num_silent + 1),
        pose_cov=[np.array(at_fit.pose_cov)] * (num_silent + 1),
        irises=[np.zeros_like(irises)] * num_silent + [irises],
    )
    found = beyond.reversed() + clip if is_before else clip + beyond
    return found, np.isin(found.frame, clip.frame)


def gaze_in(
    gaze: _core.GazeFilter, camera: _core.Camera, estimate: _core.FrameEstimate, seconds: float
) -> NDArray[np.float64]:
    """4 degrees, as GAZE; seconds: since the picture before."""
    irises = estimate.irises * (not estimate.held)
    return gaze.advance(camera, estimate.camera_from_head, estimate.pose_cov, irises, seconds)
