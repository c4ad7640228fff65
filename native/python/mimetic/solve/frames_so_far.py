# SPDX-License-Identifier: GPL-3.0-or-later
"""What a capture at work has followed so far, for whoever draws it meanwhile."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.detail import Detail
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.performance.document import HELD_QUALITY
from mimetic.performance.gaze import turned_irises
from mimetic.performance.take_facts import FrameQuality
from mimetic.solve.gaze import FACING, gaze_in
from mimetic.template.face_template import FaceTemplate


@dataclass(frozen=True)
class PersonFollowed:
    """Whose face moves, and how: the canonical mesh, metres, head frame."""

    camera: _core.Camera
    neutral_vertices: NDArray[np.float64]  # V x 3
    modes: tuple[
        NDArray[np.floating[Any]], ...
    ]  # M x V x 3 in all: of muscles, articulators, detail


@dataclass(frozen=True)
class FrameSoFar:
    """A frame as it was followed, not smoothed yet."""

    head_pose: NDArray[np.float64]  # 4 x 4, camera from head
    values: NDArray[np.float64]  # M, by which the person's modes are multiplied
    rims: NDArray[np.float64]  # 2 x K x 3, metres, head frame: of the irises
    quality: float  # 0 lost to 1 well explained


class FramesSoFar:
    """Frames by their numbers. One thread adds to them while another one looks."""

    def __init__(self) -> None:
        self.person: PersonFollowed | None = None  # None until muscles are attached to it
        self.newest: int | None = None  # the frame that was added last
        self._frames: dict[int, FrameSoFar] = {}
        self._lock = threading.Lock()

    def begin(self, fit: FaceFit, template: FaceTemplate, anatomy: Anatomy, detail: Detail) -> None:
        neutral = fit.neutral_vertices(template)
        self._eyes = eye_geometry(neutral, template)
        self._gaze = _core.GazeFilter(_core.Eyeballs(self._eyes.centers, self._eyes.radii, FACING))
        modes = (anatomy.muscle_modes, anatomy.articulator_modes, detail.modes)
        self.person = PersonFollowed(fit.camera, neutral, modes)

    def add(self, frame: int, estimate: _core.FrameEstimate, seconds: float) -> None:
        """After `begin`; seconds: since the frame that was followed before."""
        assert self.person is not None
        turns = gaze_in(self._gaze, self.person.camera, estimate, seconds)
        entry = FrameSoFar(
            np.array(estimate.camera_from_head),
            np.concatenate([estimate.values, estimate.detail]),
            turned_irises(self._eyes.centers, self._eyes.fronts(), turns)[:, 1:],
            0.0 if estimate.held else float(estimate.quality),
        )
        with self._lock:
            self._frames[frame] = entry
            self.newest = frame

    def __len__(self) -> int:
        return len(self._frames)

    def at(self, frame: int) -> FrameSoFar | None:
        """None for a frame that was not followed yet."""
        with self._lock:
            return self._frames.get(frame)

    def quality_of(self, frame: int) -> FrameQuality | None:
        """None for a frame that was not followed yet."""
        entry = self.at(frame)
        if entry is None:
            return None
        return FrameQuality(entry.quality, entry.quality < HELD_QUALITY, False)

    def qualities(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Numbers of the frames that there are, in the order of following; quality of each."""
        with self._lock:
            frames = list(self._frames.items())
        return (
            np.array([frame for frame, _ in frames], dtype=np.int64),
            np.array([entry.quality for _, entry in frames], dtype=np.float64),
        )
