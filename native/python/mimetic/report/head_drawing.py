# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's model drawn over the footage, and its six parameters over time."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.document import Performance
from mimetic.report.overlay import make_painter
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import load_template


class HeadDrawing:
    """Paints the model's meridians over frames, as the paper's Fig. 15 does."""

    def __init__(self, performance: Performance, shape: _core.HeadShape) -> None:
        self.performance = performance
        low, high = _height_of(performance.neutral_vertices)
        self.vertices, faces = _core.mesh_of_model(shape, low, high)
        self.painter = make_painter(performance, len(self.vertices), faces, [])

    def paint(self, image: NDArray[np.uint8], i: int) -> NDArray[np.uint8]:
        """An enlarged H x W x 3 picture of frame index `i`."""
        pose = self.performance.head_pose[i]
        points = np.ascontiguousarray(self.vertices @ pose[:3, :3].T + pose[:3, 3])
        quality, frame = float(self.performance.quality[i]), int(self.performance.frame[i])
        return self.painter.paint(image, points, quality, frame)


def _height_of(neutral_vertices: NDArray[np.float64]) -> tuple[float, float]:
    """Chin and crown (metres, y of the head frame): beyond, the ellipsoid has no skin."""
    template = load_template()
    chin = neutral_vertices[template.landmark("menton"), 1]
    return float(chin), float(neutral_vertices[: template.num_skin_vertices, 1].max())


def write_motion_plot(performance: Performance, path: str | os.PathLike[str]) -> None:
    """The six parameters over the frames with their standard deviations, as the paper's Fig. 16.

    path: .png or .svg, written whole or not at all; raises OSError.
    """
    from matplotlib.figure import Figure

    from mimetic.report.plots import head_angle_stds, head_angles, shade_held

    path = Path(path)
    shift_cov = np.diagonal(performance.head_pose_cov[:, 3:, 3:], axis1=1, axis2=2)
    shift_stds = np.sqrt(np.clip(shift_cov, 0, None))
    values = np.hstack([head_angles(performance), 1000 * performance.head_pose[:, :3, 3]])
    spreads = np.hstack([head_angle_stds(performance), 1000 * shift_stds])
    names = (
        *("pitch, degrees", "yaw, degrees", "roll, degrees"),
        *("x, right, mm", "y, down, mm", "z, away, mm"),
    )
    figure = Figure(figsize=(11, 5.5), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True)
    for k, (panel, name) in enumerate(zip(panels.flat, names, strict=True)):
        value, spread = values[:, k], spreads[:, k]
        panel.plot(performance.frame, value, color="#1b7f79", linewidth=1.2)
        panel.fill_between(
            performance.frame, value - spread, value + spread, color="#1b7f79", alpha=0.15, lw=0
        )
        shade_held(panel, performance)
        panel.set_title(name, fontsize=10)
        panel.spines[["top", "right"]].set_visible(False)
        panel.set(xmargin=0.01)
    for panel in panels[1]:
        panel.set_xlabel("frame")
    with whole_file(path) as stream:
        figure.savefig(stream, format="png", dpi=120)
