# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores as text: tables for people, JSON for programs."""

from __future__ import annotations

import math
import statistics
from dataclasses import asdict

from mimetic.score.json_text import json_text
from mimetic.score.score import Score
from mimetic.score.text_table import number_text, text_table

IMAGE_COLUMNS = {
    "r2": ("R2 all", ".3f"),
    "nonrigid_r2": ("R2 non-rigid", ".3f"),
    "median_px": ("median px", ".2f"),
    "p95_px": ("95 % px", ".2f"),
    "moving_median_px": ("moving px", ".2f"),
}
CURVE_COLUMNS = {
    "correlation": ("correlation", ".3f"),
    "rmse": ("RMSE", ".3f"),
    "true_peak": ("true peak", ".2f"),
    "peak": ("peak", ".2f"),
    "lag_frames": ("lag frames", ".1f"),
}


def as_text(score: Score) -> str:
    """The report of one clip."""
    surface, head = score.surface, score.head
    parts = [
        f"{score.name}: {score.num_frames} frames, {100 * score.on_face:.0f} % of the points on "
        f"the fitted face, true non-rigid motion "
        f"{score.image['mimetic']['nonrigid_rms_px']:.2f} px rms",
        text_table("image motion of held-out points", IMAGE_COLUMNS, score.image),
        f"surface motion: R2 {number_text(surface['r2'], '.3f')}, median error "
        f"{number_text(surface['median_mm'], '.2f')} mm, of moving points "
        f"{number_text(surface['moving_median_mm'], '.2f')} mm; neutral shape "
        f"{number_text(surface['neutral_shape_median_mm'], '.2f')} mm",
        f"head motion, mean error: pitch {head['pitch_deg']:.2f}, yaw {head['yaw_deg']:.2f}, roll "
        f"{head['roll_deg']:.2f} degrees (largest {head['largest_deg']:.2f}); sideways "
        f"{head['sideways_mm']:.1f}, depth {head['depth_mm']:.1f} mm",
    ]
    if score.groups:
        parts.append(text_table("muscle groups", CURVE_COLUMNS, score.groups))
    if score.controls:
        parts.append(text_table("controls that truth moves", CURVE_COLUMNS, score.controls))
    if score.overall:
        o = {key: number_text(value, ".3f") for key, value in score.overall.items()}
        parts.append(
            f"activations: median correlation {o['median_correlation']}, RMSE {o['rmse']} "
            f"(active {o['rmse_active']}), largest false {o['largest_false']}, 90 % intervals hold "
            f"{o['coverage_90']} of the values that truth moves ({o['coverage_90_silent']} of the "
            f"silent ones)"
        )
    parts.append(f"largest activation anywhere: {score.largest_activation:.3f}")
    return "\n".join(parts)


def summary(scores: list[Score]) -> str:
    """One line a clip: the figures to quote."""
    columns = {
        "nonrigid": ("R2 non-rigid", ".3f"),
        "muscles": ("muscles alone", ".3f"),
        "peer": ("best flow", ".3f"),
        "surface": ("R2 surface", ".3f"),
        "groups": ("group corr.", ".3f"),
        "turn": ("turn deg", ".2f"),
        "false": ("largest false", ".3f"),
        "coverage": ("in 90 % int.", ".3f"),
        "silent": ("silent in it", ".3f"),
    }
    return text_table("summary", columns, {score.name: _summary_row(score) for score in scores})


def _summary_row(score: Score) -> dict[str, float]:
    r2_by_method = {who: figures["nonrigid_r2"] for who, figures in score.image.items()}
    peers = [value for who, value in r2_by_method.items() if who.startswith("DIS")]
    groups = [figures["correlation"] for figures in score.groups.values()]
    still = not score.groups and not score.controls
    return {
        "nonrigid": r2_by_method["mimetic"],
        "muscles": r2_by_method.get("its muscles alone", r2_by_method["mimetic"]),
        "peer": max(peers, default=math.nan),
        "surface": score.surface["r2"],
        "groups": statistics.median(groups) if groups else math.nan,
        "turn": statistics.mean(score.head[f"{axis}_deg"] for axis in ("pitch", "yaw", "roll")),
        "false": score.largest_activation
        if still
        else score.overall.get("largest_false", math.nan),
        "coverage": score.overall.get("coverage_90", math.nan),
        "silent": score.overall.get("coverage_90_silent", math.nan),
    }


def as_json(scores: list[Score]) -> str:
    """A list of clips with every figure; what is undefined is null."""
    return json_text([asdict(score) for score in scores])
