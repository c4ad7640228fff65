# SPDX-License-Identifier: GPL-3.0-or-later
"""What is recorded live, and the performance that it becomes: the same that a capture gives."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import UnreadableMedia
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, modes_with_gaze
from mimetic.performance.rows import Rows
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.live_filter import LiveState
from mimetic.shared.counted import counted

LONGEST_BRIDGE = 0.2  # seconds without a picture that are bridged; longer gaps are held


@dataclass
class Take:
    """States as they came, at their times.

    fps: of the performance that it becomes; states between two frames of it are not lost but
    weighted, frames between two states lie on the line between them.
    """

    fps: float
    states: list[LiveState] = field(default_factory=list)
    num_faces: int = 0  # heads that it was followed on: the first, the person's own, another person
    _face: LiveFace | None = None
    _kept: LiveFace | None = None  # the last that was one
    _unproved: list[LiveState] = field(default_factory=list)

    def add(self, state: LiveState, face: LiveFace) -> None:
        """What turns out to be no face is not kept."""
        if face is not self._face:
            self._face = face
            self._unproved.clear()
        if not state.is_proved:
            self._unproved.append(state)
            return
        if self._kept is None or face.anatomy is not self._kept.anatomy:
            self.num_faces += 1
        self._kept = face
        self.states += [*self._unproved, state]
        self._unproved.clear()

    @property
    def seconds(self) -> float:
        return self.states[-1].time - self.states[0].time if self.states else 0.0

    def performance(self, footage: Footage | None = None, num_skipped: int = 0) -> Performance:
        """On the last head it was followed on; frame 1 is the take's first.

        footage: what it was played from, if that was a file: its frames' numbers are kept.
        Raises UnreadableMedia if nothing was recorded.
        """
        face = self._kept
        if face is None or not self.states:
            raise UnreadableMedia("no face was seen, so that nothing was recorded")
        times = np.array([state.time for state in self.states])
        if footage:
            times = footage.counted(times)
        first = round(times[0] * self.fps) if footage else 0
        origin = first / self.fps if footage else times[0]
        num_frames = 1 + max(0, round((times[-1] - origin) * self.fps))
        grid = origin + np.arange(num_frames) / self.fps
        values = _at(grid, times, np.array([state.values for state in self.states]))
        nearest = _nearest(grid, times)
        num_muscles = len(face.anatomy.muscle_names)
        std = np.array([state.std for state in self.states])[nearest]
        rows = Rows(
            pose=self._poses(grid, times),
            pose_cov=[self.states[i].pose_cov for i in nearest],
        )
        fields: dict[str, Any] = dict(
            frame=1 + first + np.arange(num_frames),
            fps=self.fps,
            image_size=np.array(face.fit.image_size),
            intrinsics=face.fit.intrinsics,
            head_pose=rows.rigid_poses(),
            head_pose_cov=rows.pose_covariances(),
            muscles=list(face.anatomy.muscle_names),
            muscle_modes=face.anatomy.muscle_modes,
            groups=face.anatomy.groups,
            activations=np.clip(values[:, :num_muscles], 0, 1),
            activations_std=std[:, :num_muscles],
            articulators=[*face.anatomy.articulator_names, *GAZE],
            articulator_values=values[:, num_muscles:],
            articulator_values_std=std[:, num_muscles:],
            articulator_modes=modes_with_gaze(face.anatomy.articulator_modes),
            neutral_vertices=face.fit.neutral_vertices(face.template),
            faces=face.template.faces,
            quality=self._qualities(grid, times, nearest),
            notes=self._notes(num_skipped) or None,
            **face.eyes.fields((lid.per_degree, lid.rest_pitch) for lid in face.lids),
            **_footage_fields(footage),
        )
        return Performance(**fields)

    def _poses(
        self, grid: NDArray[np.float64], times: NDArray[np.float64]
    ) -> list[NDArray[np.float64]]:
        """Not quite rigid between two states."""
        matrices = np.array([state.head_pose for state in self.states])
        return list(_at(grid, times, matrices.reshape(-1, 16)).reshape(-1, 4, 4))

    def _qualities(
        self, grid: NDArray[np.float64], times: NDArray[np.float64], nearest: NDArray[np.intp]
    ) -> NDArray[np.float64]:
        quality = np.array([state.quality for state in self.states])[nearest]
        quality[_before(grid, times)[1]] = 0.0
        return np.clip(quality, 0, 1)

    def _notes(self, num_skipped: int) -> list[str]:
        notes = ["recorded live: by a filter without a look ahead; a capture of a video is exacter"]
        if num_skipped:
            notes.append(f"{counted(num_skipped, 'picture')} came faster than could be worked on")
        if self.num_faces > 1:
            notes.append("the person's head was fitted anew while the take went on")
        num_held = sum(state.is_held for state in self.states)
        if num_held:
            notes.append(f"the face was lost in, and held for, {counted(num_held, 'picture')}")
        return notes


def _footage_fields(footage: Footage | None) -> dict[str, Any]:
    if footage is None:
        return {}
    return {"footage": footage.identity, "stored_size": np.array(footage.stored_size)}


def _at(
    grid: NDArray[np.float64], times: NDArray[np.float64], rows: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Rows (T x K) at other times (N): N x K, on the lines between them; in long gaps as before."""
    result = np.column_stack([np.interp(grid, times, column) for column in rows.T])
    before, is_held = _before(grid, times)
    result[is_held] = rows[before[is_held]]
    return result


def _nearest(grid: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.intp]:
    """Of the times, by number: the one before in long gaps."""
    after = np.clip(np.searchsorted(times, grid), 1, max(1, len(times) - 1))
    if len(times) == 1:
        return np.zeros(len(grid), dtype=np.intp)
    before, is_held = _before(grid, times)
    return np.where(is_held, before, after - (grid - times[after - 1] < times[after] - grid))


def _before(
    grid: NDArray[np.float64], times: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Number of the last time that is not after each of the grid's; whether the next is so far from
    it that it is held."""
    after = np.clip(np.searchsorted(times, grid - 1e-6), 0, len(times) - 1)
    before = np.clip(np.searchsorted(times, grid + 1e-6, side="right") - 1, 0, None)
    return before, times[after] - times[before] > LONGEST_BRIDGE
