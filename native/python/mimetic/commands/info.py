# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic info`: what is in a performance."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from mimetic.performance.confounding import confounding_text
from mimetic.performance.corrections import corrected_frames
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import gaze_range, has_gaze
from mimetic.shared.counted import counted


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")


def run_info(arguments: argparse.Namespace) -> int:
    print(describe(Performance.load(arguments.performance)))
    return 0


def describe(performance: Performance) -> str:
    """Several lines of text on a performance."""
    width, height = performance.image_size
    stored_text = ""
    if performance.stored_size is not None and performance.pixel_aspect != 1:
        stored_text = " ({} x {} in the file)".format(*performance.stored_size)
    num_vertices = len(performance.neutral_vertices)
    num_held = int((performance.quality < HELD_QUALITY).sum())
    peak = performance.activations.max(axis=0)
    strongest = np.argsort(-peak)[:5]
    lines = [] if performance.footage is None else [f"footage      {performance.footage[0]}"]
    lines += [
        f"frames       {performance.frame[0]} to {performance.frame[-1]}, "
        f"{performance.num_frames} in all, {performance.fps:.6g} a second",
        f"picture      {width} x {height}{stored_text}, "
        f"focal length {performance.intrinsics[0, 0]:.0f} pixels",
        f"mesh         {num_vertices} vertices, {len(performance.faces)} quads",
        f"muscles      {len(performance.muscles)} in {len(np.unique(performance.groups))} groups",
        "strongest    " + ", ".join(f"{performance.muscles[i]} {peak[i]:.2f}" for i in strongest),
        f"articulators {', '.join(performance.articulators) or 'none'}",
        f"quality      median {np.median(performance.quality):.2f}, "
        f"lowest {performance.quality.min():.2f}, {counted(num_held, 'frame')} held",
    ]
    if has_gaze(performance):
        yaw, pitch = gaze_range(performance)
        lines.append(
            f"gaze         {yaw[0]:.0f} to {yaw[1]:.0f} degrees to the left, "
            f"{pitch[0]:.0f} to {pitch[1]:.0f} up"
        )
    if performance.detail_modes is not None:
        lines.append(f"detail       {len(performance.detail_modes)} modes")
    if corrected := corrected_frames(performance):
        lines.append(f"corrected    {', '.join(map(str, corrected))}")
    if text := confounding_text(performance):
        lines.append(f"confounded   {text}")
    lines += [f"note         {note}" for note in performance.notes or ()]
    return "\n".join(lines)
