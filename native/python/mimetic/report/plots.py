# SPDX-License-Identifier: GPL-3.0-or-later
"""The curves of a performance as pictures, for its report."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimetic.performance.corrections import corrected_frames
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.take_facts import facts_of, runs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GROUPS = {
    1: "Lip corner pullers",
    2: "Upper lip and nose",
    3: "Lip depressors",
    4: "Chin and orbicularis oris",
    5: "Brow raisers",
    6: "Brow lowerers",
    7: "Orbicularis oculi",
}
COLOURS = ("#1b7f79", "#d1495b", "#edae49", "#5b5f97", "#66a182", "#8d5524")


@dataclass(frozen=True)
class Plots:
    """A performance's curves as pictures, which take longer than all the rest of its report."""

    head: str
    muscles: str
    articulators: str  # empty where there are none


def plots_of(performance: Performance) -> Plots:
    """The report's plots, as elements of HTML."""
    muscles = f"activations of the {len(performance.muscles)} muscles"
    has_articulators = bool(performance.articulators)
    return Plots(
        _plot(_head_figure(performance), "head motion"),
        _plot(_muscle_figure(performance), muscles),
        _plot(_articulator_figure(performance), "articulators") if has_articulators else "",
    )


def _muscle_figure(performance: Performance) -> Figure:
    figure, axes = _figure(4, 2, 10.5)
    for group, panel in zip(GROUPS, axes.flat, strict=False):
        members = np.flatnonzero(performance.groups == group)
        stems = list(dict.fromkeys(performance.muscles[i].rpartition(".")[0] for i in members))
        for i in members:
            stem, _, side = performance.muscles[i].rpartition(".")
            colour = COLOURS[stems.index(stem) % len(COLOURS)]
            label = stem.replace("_", " ") if side == "L" else None
            std = performance.activations_std[:, i]
            curve = performance.activations[:, i]
            _draw(panel, performance.frame, curve, std, colour, label, "-" if side == "L" else "--")
            _hatch_confounded(panel, performance, i, colour)
        _set_activation_axes(panel, f"{group}  {GROUPS[group]}")
        shade_held(panel, performance)
        _mark_corrected(panel, performance)
    mean = [
        performance.activations[:, performance.groups == group].mean(axis=1) for group in GROUPS
    ]
    last = axes.flat[7]
    for group, curve in zip(GROUPS, mean, strict=True):
        colour = (*COLOURS, "#222222")[group - 1]
        _draw(last, performance.frame, curve, None, colour, GROUPS[group])
    _set_activation_axes(last, "Mean of each group", room=0.55)
    for panel in axes[-1]:
        panel.set_xlabel("frame")
    return figure


def _hatch_confounded(axes: Axes, performance: Performance, i: int, colour: str) -> None:
    """Frames in which the pictures cannot tell the muscle of a column from another at work."""
    if performance.confounded_with is None:
        return
    from matplotlib.colors import to_rgb

    frame = performance.frame
    values, std = performance.activations[:, i], performance.activations_std[:, i]
    for first, last in runs(performance.confounded_with[:, i] >= 0):
        # To half a frame beside, so that a single frame is seen, too
        x = np.array([frame[first] - 0.5, *frame[first : last + 1], frame[last] + 0.5])
        axes.fill_between(
            *(x, np.interp(x, frame, values - std), np.interp(x, frame, values + std)),
            facecolor="none",
            edgecolor=(*to_rgb(colour), 0.45),
            hatch="////",
            linewidth=0,
        )


def _set_activation_axes(axes: Axes, title: str, room: float = 0.3) -> None:
    """From 0 to 1, with room above for the names of the curves."""
    axes.set_title(title, fontweight="bold")
    axes.set(ylim=(-0.03, 1 + room), yticks=np.linspace(0, 1, 6), xmargin=0.01)
    axes.axhline(1, color="#8a8f93", linewidth=0.5)
    axes.legend(loc="upper right", fontsize=7.5, frameon=False, ncols=2)


def _articulator_figure(performance: Performance) -> Figure:
    pairs: dict[str, list[int]] = {}
    for i, name in enumerate(performance.articulators):
        pairs.setdefault(name.partition(".")[0], []).append(i)
    rows = (len(pairs) + 1) // 2
    figure, axes = _figure(rows, 2, 2.1 * rows + 0.4)
    for (stem, members), panel in zip(pairs.items(), axes.flat, strict=False):
        for i in members:
            std = performance.articulator_values_std
            side = performance.articulators[i].partition(".")[2]
            values = performance.articulator_values[:, i]
            _draw(
                *(panel, performance.frame, values, None if std is None else std[:, i]),
                *(COLOURS[0], {"L": "left", "R": "right"}.get(side), "--" if side == "R" else "-"),
            )
        unit = ", degrees" if stem.startswith("gaze") else ""
        panel.set_title(stem.replace("_", " ") + unit, fontweight="bold")
        panel.set(xmargin=0.01)
        if len(members) > 1:
            panel.legend(loc="upper right", fontsize=7.5, frameon=False)
        shade_held(panel, performance)
        _mark_corrected(panel, performance)
    for panel in list(axes.flat)[len(pairs) :]:
        panel.remove()
    for panel in axes[-1]:
        panel.set_xlabel("frame")
    return figure


def _head_figure(performance: Performance) -> Figure:
    figure, axes = _figure(3, 1, 6.5)
    frame = performance.frame
    std = np.sqrt(np.clip(np.diagonal(performance.head_pose_cov, axis1=1, axis2=2), 0, None))
    quality, turn, place = axes[:, 0]
    quality.fill_between(frame, performance.quality, color="#1b7f79", alpha=0.35, linewidth=0)
    quality.axhline(HELD_QUALITY, color="#d1495b", linewidth=0.8, linestyle=":")
    quality.set(ylabel="quality", ylim=(0, 1.03))
    angles, angle_stds = head_angles(performance), head_angle_stds(performance)
    for k, name in enumerate(("pitch", "yaw", "roll")):
        _draw(turn, frame, angles[:, k], angle_stds[:, k], COLOURS[k], name)
    turn.set_ylabel("rotation, degrees")
    where = 1000 * (performance.head_pose[:, :3, 3] - performance.head_pose[:1, :3, 3])
    for k, name in enumerate(("x, right", "y, down", "z, away")):
        _draw(place, frame, where[:, k], 1000 * std[:, 3 + k], COLOURS[k], name)
    place.set(ylabel="translation, mm", xlabel="frame")
    for panel in (turn, place):
        panel.set(xmargin=0.01)
        bottom, top = panel.get_ylim()
        panel.set_ylim(bottom, top + 0.15 * (top - bottom))  # room for the names
        panel.legend(loc="upper right", fontsize=7.5, frameon=False, ncols=3)
        shade_held(panel, performance)
        _mark_corrected(panel, performance)
    return figure


def head_angles(performance: Performance) -> NDArray[np.float64]:
    """N x 3: pitch, yaw, roll of the head in degrees, 0 when it faces the camera."""
    facing = np.diag([1.0, -1.0, -1.0])  # head axes (y up, z to the camera) -> camera axes
    r = performance.head_pose[:, :3, :3] @ facing
    yaw = np.arcsin(np.clip(r[:, 2, 0], -1, 1))
    pitch = np.arctan2(r[:, 2, 1], r[:, 2, 2])
    roll = np.arctan2(r[:, 1, 0], r[:, 0, 0])
    return np.degrees(np.stack([pitch, yaw, roll], axis=1))


def head_angle_stds(performance: Performance) -> NDArray[np.float64]:
    """N x 3: standard deviations of `head_angles`, degrees, 180 at most.

    The pose's covariance C is of a rotation vector about the camera's axes, about which these
    angles are not: J C J', with J the derivatives of the angles by that vector.
    """
    _, yaw, roll = np.radians(head_angles(performance)).T
    c, s = np.cos(roll), np.sin(roll)
    cosine = np.maximum(1e-6, np.cos(yaw))  # 0 where pitch and roll are about one axis
    none, one = np.zeros_like(yaw), np.ones_like(yaw)
    rows = (
        [c / cosine, s / cosine, none],
        [s, -c, none],
        [-c * np.sin(yaw) / cosine, -s * np.sin(yaw) / cosine, one],
    )
    jacobian = np.array(rows).transpose(2, 0, 1)
    variances = (jacobian @ performance.head_pose_cov[:, :3, :3] * jacobian).sum(axis=2)
    return np.minimum(180, np.degrees(np.sqrt(np.clip(variances, 0, None))))


def _figure(rows: int, cols: int, height: float) -> tuple[Figure, np.ndarray]:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    # Margins in inches: to have them measured takes as long as all of the drawing.
    width, left, right, bottom, top, between = 11.0, 0.6, 0.12, 0.45, 0.3, 0.45
    each_wide = (width - left - right - (cols - 1) * between) / cols
    each_high = (height - bottom - top - (rows - 1) * between) / rows
    margins = {
        "left": left / width,
        "right": 1 - right / width,
        "bottom": bottom / height,
        "top": 1 - top / height,
        "wspace": between / each_wide,
        "hspace": between / each_high,
    }
    with rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(width, height))
        panels = figure.subplots(rows, cols, sharex=True, squeeze=False, gridspec_kw=margins)
        return figure, panels


def _draw(
    axes: Axes,
    frame: NDArray[np.int64],
    values: NDArray,
    std: NDArray | None,
    colour: str,
    label: str | None,
    style: str = "-",
) -> None:
    axes.plot(frame, values, style, color=colour, linewidth=1.2, label=label)
    if std is not None:
        axes.fill_between(frame, values - std, values + std, color=colour, alpha=0.13, linewidth=0)


def shade_held(axes: Axes, performance: Performance) -> None:
    """Held frames, each from half a frame before it to half a frame after it."""
    for first, last in facts_of(performance).held:
        begin, end = performance.frame[first] - 0.5, performance.frame[last] + 0.5
        axes.axvspan(begin, end, color="#8a8f93", alpha=0.25, linewidth=0)


def _mark_corrected(axes: Axes, performance: Performance) -> None:
    for frame in corrected_frames(performance):
        axes.axvline(frame, color="#2f6fde", linewidth=0.8, alpha=0.7)


def _plot(figure: Figure, label: str) -> str:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=150)
    return f"<img class='plot' alt='{label}' src='{picture_uri('png', stream.getvalue())}'>"


def picture_uri(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
