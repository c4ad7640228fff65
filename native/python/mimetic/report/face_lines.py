# SPDX-License-Identifier: GPL-3.0-or-later
"""A captured face as lines over its footage, a frame in a millisecond: what an editor draws.

The same surface as in `overlay.mp4`; hidden parts are left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.feature_lines import feature_lines
from mimetic.performance.corrections import corrected_frames
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import has_gaze, iris_circles, seen_articulators
from mimetic.report.overlay import shown_faces, shown_landmarks
from mimetic.shared.pinhole import camera_of
from mimetic.template.face_template import load_template

CORRECTED = (0.2, 0.5, 1.0, 1.0)  # colour of a corrected frame's box


class PerformanceLines:
    """The lines of a performance's frames. Raises InvalidInput."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        self._rows = {int(frame): i for i, frame in enumerate(performance.frame)}
        template = load_template()
        if np.array_equal(performance.faces, template.faces):
            num_skin = template.num_skin_vertices
            self.landmarks = shown_landmarks(template)
            used, faces = np.arange(num_skin), np.ascontiguousarray(template.skin_faces)
            is_shown, features = shown_faces(template), list(feature_lines(template).values())
            marks = [template.landmark(name) for name in self.landmarks]
        else:
            self.landmarks = []
            used, faces = np.unique(performance.faces, return_inverse=True)
            faces = np.ascontiguousarray(faces.reshape(-1, 4), dtype=np.int32)
            is_shown, features, marks = np.ones(len(faces), dtype=bool), [], []
        self._lines = _core.FaceLines(
            camera_of(performance.intrinsics, performance.image_size),
            np.ascontiguousarray(performance.neutral_vertices[used]),
            np.ascontiguousarray(_modes_of(performance)[:, used], dtype=np.float64),
            faces,
            is_shown.tolist(),
            features,
            marks,
        )

    def row_of(self, frame: int) -> int | None:
        """The index of a frame number; None for one that was not captured."""
        return self._rows.get(frame)

    def draw(self, i: int) -> _core.DrawnLines:
        """What is seen at frame index `i`."""
        performance = self.performance
        values = [performance.activations[i]]
        if performance.articulator_modes is not None:
            values.append(seen_articulators(performance, slice(i, i + 1))[0])
        if performance.detail_coefficients is not None:
            values.append(performance.detail_coefficients[i])
        rims = [ring[1:] for ring in iris_circles(performance, i)] if has_gaze(performance) else []
        return self._lines.draw(np.concatenate(values), performance.head_pose[i], rims)

    def quality_text(self, i: int | None) -> str:
        """What is known of frame index `i`; None: a frame that was not captured."""
        if i is None:
            return "not captured"
        quality = float(self.performance.quality[i])
        text = f"quality {quality:.2f}" + ("" if quality >= HELD_QUALITY else ", lost: held")
        is_corrected = self.performance.frame[i] in corrected_frames(self.performance)
        return text + (", corrected" if is_corrected else "")


def _modes_of(performance: Performance) -> NDArray[np.float32]:
    """Modes by which values of a frame move the surface, M x V x 3."""
    modes = [performance.muscle_modes, performance.articulator_modes, performance.detail_modes]
    return np.concatenate([part for part in modes if part is not None])


def quality_strip(
    performance: Performance,
    left: float,
    per_frame: float,
    bottom: float,
    height: float,
    corrected: Sequence[int] | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Triangles of a strip with a box for each captured frame, and above it for each corrected one.

    Points 6K x 2, colours 6K x 4. left: of frame 1; per_frame: width of a frame; all in the
    picture's unit. From red, lost, by yellow to green, well explained; corrected frames blue, the
    performance's own where none are given.
    """
    corrected = corrected_frames(performance) if corrected is None else corrected
    frames = np.concatenate([performance.frame, np.array(corrected, dtype=np.int64)])
    starts = left + per_frame * (frames - 1.0)
    corners = np.empty((len(starts), 6, 2), dtype=np.float32)
    corners[:, :, 0] = starts[:, None] + per_frame * np.array([0, 1, 1, 0, 1, 0])
    corners[:, :, 1] = bottom + height * np.array([0, 0, 1, 0, 1, 1])
    corners[performance.num_frames :, :, 1] += height
    quality = np.where(performance.quality < HELD_QUALITY, 0.0, performance.quality)
    colours = np.empty((len(starts), 6, 4), dtype=np.float32)
    colours[: performance.num_frames, :, 0] = np.clip(2 - 2 * quality, 0, 0.9)[:, None]
    colours[: performance.num_frames, :, 1] = np.clip(1.6 * quality, 0, 0.8)[:, None]
    colours[..., 2:] = 0.1, 0.9
    colours[performance.num_frames :] = CORRECTED
    return corners.reshape(-1, 2), colours.reshape(-1, 4)
