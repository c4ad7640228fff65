# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera's picture, scores, muscle controls and the driven face in one picture: Fig. 14."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.library.preview import head_picture
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.head_turn import head_turn
from mimetic.puppet.figures import draw_controls, draw_scores, shown_templates
from mimetic.puppet.running import Trace
from mimetic.puppet.templates import TaughtSet

HEIGHT = 320  # pixels of the pictures above
GROUND = (251, 250, 248)
CURSOR = (209, 73, 91)
PLOT_DPI = 100


def driven_face(performance: Performance, i: int) -> NDArray[np.uint8]:
    """256 x 256 x 3: the head at frame index i as it faces the camera, on light ground."""
    turn = head_turn(performance.head_pose[i])
    surface = performance.surface(i) @ turn.T
    neutral = performance.neutral_vertices
    picture = head_picture(neutral, surface - neutral, performance.faces).astype(np.float64)
    opacity = picture[:, :, 3:] / 255
    return (picture[:, :, :3] * opacity + np.array(GROUND) * (1 - opacity)).astype(np.uint8)


class SideBySide:
    """Paints frames of a run; `paint(image, i)` gives a picture of one size for all."""

    def __init__(
        self, taught: TaughtSet, performance: Performance, trace: Trace, mode: str
    ) -> None:
        self.performance = performance
        width, height = performance.image_size
        self.camera_width = max(2, round(HEIGHT * width / height))
        self.width = self.camera_width + HEIGHT
        self.plots, self.axis = self._plots(taught, trace, mode)

    def _plots(
        self, taught: TaughtSet, trace: Trace, mode: str
    ) -> tuple[NDArray[np.uint8], tuple[float, float]]:
        """Scores and controls over the whole run, and the columns of its first and last frame."""
        from matplotlib import rc_context
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        groups = shown_templates(taught, mode)
        frame = self.performance.frame
        with rc_context({"font.size": 7, "axes.spines.top": False, "axes.spines.right": False}):
            size = (self.width / PLOT_DPI, 0.75 * (len(groups) + 2))
            figure = Figure(figsize=size, dpi=PLOT_DPI)
            panels = figure.subplots(
                len(groups) + 1,
                1,
                sharex=True,
                squeeze=False,
                height_ratios=[*[1] * len(groups), 1.8],
            )[:, 0]
            figure.subplots_adjust(left=0.08, right=0.76, top=0.97, bottom=0.06, hspace=0.35)
            for panel, (title, templates) in zip(panels, groups.items(), strict=False):
                draw_scores(panel, taught, trace, templates, frame)
                panel.set_title(f"scores, {title}", loc="left", fontsize=6, pad=1)
                panel.legend_.remove()
            draw_controls(panels[-1], self.performance)
            panels[-1].set_title("muscle controls", loc="left", fontsize=6, pad=1)
            canvas = FigureCanvasAgg(figure)
            canvas.draw()
            picture = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
            ends = panels[-1].transData.transform([(frame[0], 0), (frame[-1], 0)])[:, 0]
        return picture, (float(ends[0]), float(ends[1]))

    def paint(self, image: NDArray[np.uint8], i: int) -> NDArray[np.uint8]:
        """height x width x 3 of the frame index i."""
        top = np.hstack(
            [
                resized(image, self.camera_width, HEIGHT),
                resized(driven_face(self.performance, i), HEIGHT, HEIGHT),
            ]
        )
        if self.performance.quality[i] < HELD_QUALITY:
            top[:6] = CURSOR
        plots = self.plots.copy()
        start, end = self.axis
        column = round(start + (end - start) * i / max(1, self.performance.num_frames - 1))
        plots[:, max(0, column - 1) : column + 1] = CURSOR
        padded = np.full((plots.shape[0], top.shape[1], 3), 255, np.uint8)
        padded[:, : min(plots.shape[1], top.shape[1])] = plots[:, : top.shape[1]]
        return np.ascontiguousarray(np.vstack([top, padded]))


def resized(picture: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    from PIL import Image  # comes with matplotlib

    return np.asarray(Image.fromarray(picture).resize((width, height), Image.Resampling.BILINEAR))
