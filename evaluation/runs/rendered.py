# SPDX-License-Identifier: GPL-3.0-or-later
"""The clips that a checkout renders: found, captured and scored."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.score.score import Score, score, shared_images
from mimetic.score.truth import Truth

CHECKOUT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Clip:
    name: str
    footage: Path
    truth: Path


def render(options: list[str], failure: str, report=None) -> str:
    """What scripts/render_truth prints, its progress line by line to `report`.

    Raises InvalidInput, `failure` and the last words of the script.
    """
    command = [sys.executable, str(CHECKOUT / "scripts" / "render_truth"), *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    lines = []
    for line in process.stderr:
        lines.append(line.rstrip())
        if report:
            report(lines[-1])
    output = process.stdout.read()
    if process.wait() != 0:
        raise InvalidInput(f"{failure}: {' '.join(lines[-3:])}")
    return output


def clips(which: str, report=None) -> list[Clip]:
    """The clips of a set, rendered now if the cache lacks them."""
    output = render(["--set", which], "the clips could not be rendered", report)
    rows = (line.split("\t") for line in output.splitlines())
    return [Clip(name, Path(footage), Path(truth)) for name, footage, truth in rows]


def scored(which: str, report=None) -> Iterator[Score]:
    """Captures and scores every clip of a set."""
    from mimetic.solve.clip_capture import capture

    for clip in clips(which, report):
        if report:
            report(f"{clip.name}: capturing")
        yield score_clip(clip, capture(clip.footage))


def score_clip(clip: Clip, performance: Performance) -> Score:
    truth = Truth.load(clip.truth)
    return score(truth, performance, clip.name, shared_images(clip.footage, truth, performance))
