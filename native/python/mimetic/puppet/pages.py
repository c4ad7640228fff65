# SPDX-License-Identifier: GPL-3.0-or-later
"""What teaching and driving write beside their numbers: pages, figures, the video."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.analyse import drawing
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import expression_of
from mimetic.puppet.figures import NUM_PICTURES, live_figure, template_figure
from mimetic.puppet.running import RunOptions, Trace
from mimetic.puppet.separability import HARD, advice, separability
from mimetic.puppet.side_by_side import SideBySide, driven_face, resized
from mimetic.puppet.templates import TaughtSet
from mimetic.report.overlay import write_overlay
from mimetic.shared.counted import counted
from mimetic.shared.progress import Progress
from mimetic.shared.whole_file import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NUM_HARDEST = 12  # pairs of looks that the page lists
PICTURE_HEIGHT = 240  # pixels


def write_taught_page(taught: TaughtSet, path: Path, name: str) -> list[str]:
    """The page of a taught set; returns its advice. Raises OSError."""
    pairs = separability(taught)
    lines = advice(pairs)
    stream = _png(template_figure(taught))
    parts = [
        drawing.section(
            "Templates",
            drawing.picture(stream, "the templates"),
            drawing.paragraph("At the resolution that they are matched with or finer.", "caption"),
        ),
        drawing.section(
            "What to teach next",
            *(drawing.paragraph(line, "note") for line in lines),
            *([] if lines else [drawing.paragraph("All looks are told apart.")]),
        ),
    ]
    if pairs:
        rows = [[p.part, p.first, p.second, f"{p.d_prime:.1f}"] for p in pairs[:NUM_HARDEST]]
        parts.append(
            drawing.section(
                "The pairs that are most alike",
                drawing.table(["part", "look", "look", "d'"], rows),
                drawing.paragraph(
                    "d': how far apart the scores of the two looks are in the taught examples, in "
                    f"standard deviations; below {HARD:g} about one frame in six is mistaken.",
                    "caption",
                ),
            )
        )
    lead = (
        f"{counted(len(taught.looks), 'look')}, {counted(len(taught.template_parts), 'template')}, "
        f"{counted(len(taught.example_scores), 'example')}"
    )
    with whole_file(path) as file:
        file.write(drawing.page(f"{name}: taught looks", lead, parts).encode())
    return lines


def write_run(
    taught: TaughtSet,
    performance: Performance,
    trace: Trace,
    footage: Footage,
    options: RunOptions,
    folder: Path,
    progress: Progress,
    is_interrupted: Callable[[], bool],
) -> None:
    """puppet.mp4, the paper's Figs. 11 to 14 and report.html; raises OSError."""
    side_by_side = SideBySide(taught, performance, trace, options.mode)
    if not is_interrupted():
        write_overlay(performance, footage, folder / "puppet.mp4", progress, side_by_side)
    moments = _moments(performance)
    pictures: list[tuple[int, NDArray[np.uint8], NDArray[np.uint8]]] = []
    live: NDArray[np.uint8] | None = None
    frames = {int(performance.frame[i]): i for i in moments}
    for frame, image in footage.frames(min(frames), max(frames)):
        if frame in frames:
            i = frames[frame]
            width = round(PICTURE_HEIGHT * image.shape[1] / image.shape[0])
            camera = resized(np.ascontiguousarray(image), width, PICTURE_HEIGHT)
            pictures.append((frame, camera, driven_face(performance, i)))
            if i == moments[-1]:
                live = side_by_side.paint(image, i)
    figures = {
        "templates": drawing.write_figure(template_figure(taught), folder, "templates"),
        "mapping": drawing.write_figure(
            live_figure(taught, performance, trace, options.mode, pictures), folder, "mapping"
        ),
    }
    if live is not None:
        figures["live"] = drawing.write_figure(_picture_figure(live), folder, "live")
    parts = [
        *(drawing.paragraph(note, "note") for note in performance.notes or ()),
        drawing.section("Templates", drawing.picture(figures["templates"], "templates")),
        drawing.section(
            "From scores to muscles",
            drawing.picture(figures["mapping"], "camera, scores, muscle controls, driven face"),
            drawing.paragraph(
                "Above: the camera; scores: peaks of the normalised correlation of each template; "
                "muscle controls: means of the groups; below: the driven face.",
                "caption",
            ),
        ),
        _table(performance, trace, options),
    ]
    lead = f"{performance.num_frames} frames, {performance.fps:.6g} frames/s: a taught face"
    with whole_file(folder / "report.html") as stream:
        stream.write(drawing.page(f"{footage.path.name}: puppet", lead, parts).encode())


def _table(performance: Performance, trace: Trace, options: RunOptions) -> str:
    milliseconds = 1e3 * np.array(trace.seconds)
    lags = 1e3 * np.array(trace.lag)
    rows = [
        ["a frame, without decoding", f"{np.median(milliseconds):.1f} ms"],
        ["the slowest of a hundred", f"{np.quantile(milliseconds, 0.99):.1f} ms"],
        ["lag of the filter at rest", f"{1e3 * options.lag:.0f} ms"],
        ["in the fastest motion of the median frame", f"{np.median(lags):.0f} ms"],
        ["the least of all frames", f"{lags.min():.0f} ms"],
        ["frames held", str(int((performance.quality < HELD_QUALITY).sum()))],
    ]
    return drawing.section("Time", drawing.table(["", ""], rows))


def _moments(performance: Performance) -> list[int]:
    """Indices of frames that differ most, in order of time."""
    state = np.hstack([performance.activations, expression_of(performance)])
    usable = performance.quality >= HELD_QUALITY
    if not usable.any():
        usable[:] = True
    best = int(np.where(usable, performance.quality, -1).argmax())
    count = min(NUM_PICTURES, int(usable.sum()))
    return sorted(_core.distinct_rows(state, usable.tolist(), best, count))


def _picture_figure(picture: NDArray[np.uint8]) -> Figure:
    figure, axes = drawing.new_figure(1, 1, (8, 8 * picture.shape[0] / picture.shape[1]))
    axes[0, 0].imshow(picture)
    axes[0, 0].axis("off")
    return figure


def _png(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=drawing.DPI)
    return stream.getvalue()
