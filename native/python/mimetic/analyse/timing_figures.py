# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 10, delays and smiles, drawn for print."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimetic import _core
from mimetic.analyse.drawing import GROUP_COLOURS, INK, SOFT, new_figure
from mimetic.analyse.smiles import PUBLISHED, Smile
from mimetic.analyse.timing import Event, Timing
from mimetic.score.groups import GROUP_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PHASE_SHADES = (("application", 0.30), ("hold", 0.14), ("release", 0.07))


def group_figure(timing: Timing) -> Figure:
    """Seven groups over time with their fitted phases."""
    curves = {curve.group: curve for curve in timing.curves if curve.kind == "group"}
    figure, axes = new_figure(len(curves), 1, (7.2, 1.0 + 1.15 * len(curves)))
    frames = timing.performance.frame.astype(np.float64)
    top = max(0.3, 1.12 * max(float(curve.values.max()) for curve in curves.values()))
    for panel, (group, curve) in zip(axes[:, 0], curves.items(), strict=True):
        colour = GROUP_COLOURS[group]
        low = np.clip(curve.values - curve.stds, 0, None)
        panel.fill_between(frames, low, curve.values + curve.stds, color=colour, alpha=0.15, lw=0)
        panel.plot(frames, curve.values, color=colour, lw=1.1)
        for event in timing.of_group(group):
            if event.fit.is_certain:
                _draw_event(panel, event, frames)
        panel.set(ylim=(0, top), xlim=(frames[0], frames[-1]))
        panel.set_title(f"{group}  {GROUP_NAMES[group]}", loc="left", fontsize=8, color=INK, pad=2)
        panel.tick_params(labelsize=7)
    axes[-1, 0].set_xlabel("frame", fontsize=8)
    figure.supylabel("activation (mean of the group's muscles)", fontsize=8)
    return figure


def _draw_event(panel: Axes, event: Event, frames: np.ndarray) -> None:
    fit, shape = event.fit, event.fit.shape
    start, end = frames[fit.first], frames[fit.last]
    fine = np.linspace(start, end, 20 * (fit.last - fit.first) + 1)
    colour = GROUP_COLOURS[event.curve.group]
    bounds = (shape.onset, shape.apex, shape.release, end)
    for (_, alpha), low, high in zip(PHASE_SHADES, bounds, bounds[1:], strict=False):
        low, high = np.clip((low, high), start, end)
        if high > low:
            panel.axvspan(low, high, color=colour, alpha=0.5 * alpha, lw=0)
    panel.plot(fine, shape.values(fine), "--", color=INK, lw=0.9, dashes=(3, 2))
    if not fit.begins_before:
        _mark(panel, fit.onset)


def _mark(panel: Axes, interval: _core.Interval) -> None:
    """A time with its interval at the foot of a panel."""
    if math.isfinite(interval.lower):
        low, high = interval.value - interval.lower, interval.upper - interval.value
        panel.errorbar(
            *(interval.value, 0.02 * panel.get_ylim()[1]),
            xerr=[[max(0.0, low)], [max(0.0, high)]],
            fmt="|",
            color=INK,
            markersize=5,
            lw=0.8,
            clip_on=False,
            zorder=5,
        )


def delay_figure(timing: Timing) -> Figure:
    """Delays between groups with their intervals; filled where there is one."""
    pairs = timing.delays
    figure, axes = new_figure(1, 1, (7.2, 1.3 + 0.24 * max(2, len(pairs))))
    panel = axes[0, 0]
    panel.axvline(0, color=SOFT, lw=0.8)
    labels = []
    for row, pair in enumerate(pairs):
        lag, is_delayed = pair.delay.lag, pair.delay.is_delayed
        colour = GROUP_COLOURS[pair.follower.curve.group]
        panel.errorbar(
            *(lag.value, row),
            xerr=[[lag.value - lag.lower], [lag.upper - lag.value]],
            fmt="o",
            color=colour,
            markersize=5,
            mfc=colour if is_delayed else "white",
            lw=1,
        )
        leader, follower = pair.leader, pair.follower
        labels.append(
            f"{follower.curve.name} {follower.number} after {leader.curve.name} {leader.number}"
        )
    panel.set_yticks(range(len(pairs)), labels, fontsize=7)
    panel.set_ylim(max(1, len(pairs)) - 0.5, -0.5)
    panel.set_xlabel("frames later (95 % interval); hollow: no significant delay", fontsize=8)
    panel.tick_params(axis="x", labelsize=7)
    return figure


def smile_figure(smiles: list[Smile]) -> Figure:
    """Rise, length, evenness and eyes of each smile beside published bands."""
    fields = (
        ("rise_seconds", "rise, s"),
        ("total_seconds", "length, s"),
        ("asymmetry", "left minus right"),
        ("eye_ratio", "eyes over mouth"),
    )
    figure, axes = new_figure(1, len(fields), (7.2, 1.6 + 0.25 * len(smiles)), sharex=False)
    for panel, (field, label) in zip(axes[0], fields, strict=True):
        for number, band in enumerate(b for b in PUBLISHED if b.field == field):
            shade = ("#cfd8dc", "#ffe0b2")[number % 2]
            panel.axvspan(band.lower, band.upper, color=shade, alpha=0.7, lw=0)
        for row, smile in enumerate(smiles):
            estimate = getattr(smile, field)
            if math.isfinite(estimate.value):
                low, high = estimate.value - estimate.lower, estimate.upper - estimate.value
                panel.errorbar(estimate.value, row, xerr=[[low], [high]], fmt="o", color=INK, ms=4)
        panel.set_yticks(range(len(smiles)), [f"{s.event.number}" for s in smiles], fontsize=7)
        panel.set_ylim(max(1, len(smiles)) - 0.5, -0.5)
        panel.set_xlabel(label, fontsize=8)
        panel.tick_params(labelsize=7)
        panel.axvline(0, color=SOFT, lw=0.6)
    axes[0, 0].set_ylabel("event", fontsize=8)
    return figure
