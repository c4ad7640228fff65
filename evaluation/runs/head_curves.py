# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 16: a rendered head followed by the ellipsoid, its six parameters beside truth.

    python -m evaluation.runs.head_curves --out CURVES.png [--set small] [--clip NAME] [--plane]

Above, some frames as rendered and with the model over them; below, truth dotted, ours a line.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from mimetic.head.tracking import head_shape, track_head
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.report.head_drawing import HeadDrawing
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.runs.head_clips import HeadClip, fit_with_camera, head_clips
from evaluation.runs.head_score import REST_SECONDS, aligned_places, angles_of, rotations_like

NAMES = (
    *("pitch, degrees", "yaw, degrees", "roll, degrees"),
    *("x, right, mm", "y, down, mm", "z, away, mm"),
)
COLOURS = {"ellipsoid": "#1b7f79", "plane": "#c8553d"}
SHOWN_FRAMES = 6


def six_parameters(
    poses: NDArray[np.float64], truth: NDArray[np.float64], fps: float
) -> NDArray[np.float64]:
    """Angles in degrees and place in millimetres (N,6) of poses (N,4,4), nan where there is none.

    Axes, scale and the head's own point are the truth's, as no camera can tell those.
    """
    has_pose = np.isfinite(poses).all((1, 2))
    rest = has_pose & (np.arange(len(poses)) < max(3, round(REST_SECONDS * fps)))
    if not rest.any():
        return np.full((len(poses), 6), np.nan)
    turned = rotations_like(poses, truth, rest)
    values = np.full((len(poses), 6), np.nan)
    values[has_pose, :3] = angles_of(turned[has_pose])
    places = aligned_places(poses[has_pose], turned[has_pose], truth[has_pose])
    values[has_pose, 3:] = 1000 * places
    return values


def followed(clip: HeadClip, models: list[str]) -> dict[str, Performance]:
    fit = fit_with_camera(clip)
    return {model: track_head(clip.footage, model, fit=fit) for model in models}


def draw(clip: HeadClip, performances: dict[str, Performance], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 8), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(1, 1.5))
    _draw_frames(clip, performances["ellipsoid"], above)
    truth = six_parameters(clip.head_pose, clip.head_pose, clip.fps)
    panels = below.subplots(2, 3, sharex=True)
    frames = np.arange(1, len(truth) + 1)
    for model, performance in performances.items():
        poses = performance.head_pose.copy()
        poses[performance.quality < HELD_QUALITY] = np.nan
        values = six_parameters(poses, clip.head_pose, clip.fps)
        for k, panel in enumerate(panels.flat):
            panel.plot(frames, values[:, k], color=COLOURS[model], lw=1.3, label=model)
        off = np.nanmean(np.abs(values - truth), axis=0)
        print(f"{clip.name}, {model}, mean error:", ", ".join(_figures(off)))
    for k, panel in enumerate(panels.flat):
        panel.plot(frames, truth[:, k], color="black", lw=1.6, ls=":", label="truth")
        panel.set_title(NAMES[k], fontsize=10)
        panel.spines[["top", "right"]].set_visible(False)
    panels[0, 0].legend(fontsize=8)
    for panel in panels[1]:
        panel.set_xlabel("frame")
    with whole_file(path) as stream:
        figure.savefig(stream, format=path.suffix[1:] or "png", dpi=100)


def _figures(off: NDArray[np.float64]) -> list[str]:
    return [f"{name.split(',')[0]} {value:.2f}" for name, value in zip(NAMES, off, strict=True)]


def _draw_frames(clip: HeadClip, performance: Performance, figure) -> None:
    """Some frames, and under each the ellipsoid that follows the head in it."""
    template = load_template()
    shape = head_shape("ellipsoid", performance.neutral_vertices, template)
    drawing = HeadDrawing(performance, shape)
    chosen = np.linspace(0, len(performance.frame) - 1, SHOWN_FRAMES).round().astype(int)
    pictures = dict(Footage(clip.footage))
    for column, i in enumerate(chosen):
        image = np.ascontiguousarray(pictures[int(performance.frame[i])])
        for row, picture in enumerate((image, drawing.paint(image, int(i)))):
            axes = figure.add_subplot(2, SHOWN_FRAMES, row * SHOWN_FRAMES + column + 1)
            axes.imshow(picture)
            axes.axis("off")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.head_curves", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    parser.add_argument("--set", default="small", help="of `scripts/render_truth --heads`")
    parser.add_argument("--clip", help="its name in the set (default: the first)")
    parser.add_argument("--plane", action="store_true", help="the planar patch beside it")
    options = parser.parse_args(arguments)
    clips = {clip.name: clip for clip in head_clips(options.set, print)}
    name = options.clip or next(iter(clips))
    if name not in clips:
        print(f"no clip {name!r}; there are {', '.join(clips)}", file=sys.stderr)
        return 2
    models = ["ellipsoid", "plane"] if options.plane else ["ellipsoid"]
    draw(clips[name], followed(clips[name], models), options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
