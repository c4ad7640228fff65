# SPDX-License-Identifier: GPL-3.0-or-later
"""A captured face as lines over its footage, a frame in a millisecond: what an editor draws.

The same surface as in `overlay.mp4`; hidden parts are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.feature_lines import feature_lines
from mimetic.performance.corrections import FrameCorrection
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import turned_irises
from mimetic.report.overlay import shown_faces, shown_landmarks
from mimetic.shared.pinhole import camera_of
from mimetic.solve.frames_so_far import FramesSoFar
from mimetic.solve.stated import captured_state, stated_state
from mimetic.template.face_template import load_template

CORRECTED = (0.2, 0.5, 1.0, 1.0)  # colour of a corrected frame's box


class PerformanceLines:
    """The lines of a performance's frames. Raises InvalidInput."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        self._rows = {int(frame): i for i, frame in enumerate(performance.frame)}
        self.landmarks, self._lines = _lines_of(
            camera_of(performance.intrinsics, performance.image_size),
            performance.neutral_vertices,
            _modes_of(performance),
            performance.faces,
        )

    def row_of(self, frame: int) -> int | None:
        """The index of a frame number; None for one that was not captured."""
        return self._rows.get(frame)

    def draw(self, i: int, entry: FrameCorrection | None = None) -> _core.DrawnLines:
        """What is seen at frame index `i`; with an entry, the face as its values and pose are."""
        performance = self.performance
        state = (
            captured_state(performance, i) if entry is None else stated_state(performance, i, entry)
        )
        values = [state.activations]
        if performance.articulator_modes is not None:
            values.append(state.articulators)
        if performance.detail_coefficients is not None:
            values.append(performance.detail_coefficients[i])
        rims = []
        if state.gaze is not None:
            centers, irises = np.asarray(performance.eye_centers), performance.iris_centers
            circles = turned_irises(centers, np.asarray(irises), state.gaze)
            rims = [ring[1:] for ring in circles]
        return self._lines.draw(np.concatenate(values), state.head_pose, rims)


class LinesSoFar:
    """The same of a capture at work, whose frames are added meanwhile; rows are their numbers."""

    def __init__(self, so_far: FramesSoFar) -> None:
        self.so_far = so_far
        self._lines: _core.FaceLines | None = None

    def row_of(self, frame: int) -> int | None:
        """None for a frame that was not followed yet."""
        return None if self.so_far.at(frame) is None else frame

    def draw(self, frame: int) -> _core.DrawnLines:
        """What is seen in a frame that `row_of` knows."""
        person, entry = self.so_far.person, self.so_far.at(frame)
        assert person is not None and entry is not None
        if self._lines is None:
            _, self._lines = _lines_of(
                person.camera, person.neutral_vertices, person.modes, load_template().faces
            )
        return self._lines.draw(entry.values, entry.head_pose, list(entry.rims))


def _lines_of(
    camera: _core.Camera,
    neutral: NDArray[np.float64],
    modes: Sequence[NDArray[np.floating[Any]]],
    faces: NDArray[np.integer[Any]],
) -> tuple[list[str], _core.FaceLines]:
    """Names of the marks, and the lines; a mesh that is not the canonical one has no marks."""
    template = load_template()
    landmarks: list[str] = []
    if np.array_equal(faces, template.faces):
        num_skin = template.num_skin_vertices
        landmarks = shown_landmarks(template)
        used, quads = np.arange(num_skin), np.ascontiguousarray(template.skin_faces)
        is_shown, features = shown_faces(template), list(feature_lines(template).values())
        marks = [template.landmark(name) for name in landmarks]
    else:
        used, inverse = np.unique(faces, return_inverse=True)
        quads = np.ascontiguousarray(inverse.reshape(-1, 4), dtype=np.int32)
        is_shown, features, marks = np.ones(len(quads), dtype=bool), [], []
    return landmarks, _core.FaceLines(
        camera,
        np.ascontiguousarray(neutral[used]),
        np.ascontiguousarray(np.concatenate([part[:, used] for part in modes]), dtype=np.float64),
        quads,
        is_shown.tolist(),
        features,
        marks,
    )


def _modes_of(performance: Performance) -> list[NDArray[np.float32]]:
    """Modes by which values of a frame move the surface, M x V x 3 in all."""
    modes = [performance.muscle_modes, performance.articulator_modes, performance.detail_modes]
    return [part for part in modes if part is not None]


def quality_strip(
    frames: NDArray[np.int64],
    quality: NDArray[np.float64],
    left: float,
    per_frame: float,
    bottom: float,
    height: float,
    corrected: Sequence[int] = (),
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Triangles of a strip with a box for each captured frame, and above it for each corrected one.

    frames, quality: K each. Points 6K x 2, colours 6K x 4. left: of frame 1; per_frame: width of a
    frame; all in the picture's unit. From red, lost, by yellow to green, well explained; corrected
    frames are blue.
    """
    marked = np.concatenate([frames, np.array(corrected, dtype=np.int64)])
    starts = left + per_frame * (marked - 1.0)
    corners = np.empty((len(starts), 6, 2), dtype=np.float32)
    corners[:, :, 0] = starts[:, None] + per_frame * np.array([0, 1, 1, 0, 1, 0])
    corners[:, :, 1] = bottom + height * np.array([0, 0, 1, 0, 1, 1])
    corners[len(frames) :, :, 1] += height
    shown_quality = np.where(quality < HELD_QUALITY, 0.0, quality)
    colours = np.empty((len(starts), 6, 4), dtype=np.float32)
    colours[: len(frames), :, 0] = np.clip(2 - 2 * shown_quality, 0, 0.9)[:, None]
    colours[: len(frames), :, 1] = np.clip(1.6 * shown_quality, 0, 0.8)[:, None]
    colours[..., 2:] = 0.1, 0.9
    colours[len(frames) :] = CORRECTED
    return corners.reshape(-1, 2), colours.reshape(-1, 4)
