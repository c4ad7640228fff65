# SPDX-License-Identifier: GPL-3.0-or-later
"""report.html: what a capture found, in one file that needs nothing else."""

from __future__ import annotations

import html
import importlib.util
import io
import os
import platform
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, __version__, _core
from mimetic.media.footage import Footage
from mimetic.performance.confounding import confounding_text
from mimetic.performance.corrections import corrected_frames
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import expression_of, gaze_range, has_gaze
from mimetic.report.overlay import FaceDrawing
from mimetic.report.plots import Plots, picture_uri, plots_of
from mimetic.shared.shown_text import shown
from mimetic.shared.whole_file import whole_file
from mimetic.solve.capture_summary import CaptureSummary

NUM_PICTURES = 6
STYLE = """
:root { color-scheme: light dark;
  --ink: #1d2429; --paper: #fbfaf8; --soft: #6b757c; --line: #dfe3e4; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6eaec; --paper: #161a1d; --soft: #96a1a8; --line: #30373c; }
  img.plot { background: #fbfaf8; border-radius: 6px; }
}
body { margin: 0 auto; padding: 2.5rem 1.5rem 4rem; max-width: 68rem; background: var(--paper);
  color: var(--ink); font: 16px/1.55 system-ui, "Segoe UI", "Noto Sans", sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; } h2 { font-size: 1.15rem; margin: 2.6rem 0 .6rem; }
p.lead { color: var(--soft); margin: 0 0 1.5rem; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(9rem, 1fr)); gap: 1px;
  background: var(--line); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
.facts div { background: var(--paper); padding: .7rem .9rem; }
.facts b { display: block; font-size: 1.25rem; font-variant-numeric: tabular-nums; }
.facts span { color: var(--soft); font-size: .85rem; }
.note { border-left: 3px solid #edae49; padding: .3rem .9rem; margin: .5rem 0; }
img.plot { width: 100%; height: auto; }
.pictures { display: grid; grid-template-columns: repeat(3, 1fr); gap: .6rem; }
.pictures img { width: 100%; border-radius: 6px; display: block; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { padding: .3rem .9rem .3rem 0; text-align: left; border-bottom: 1px solid var(--line); }
td.number { text-align: right; }
.bar { display: inline-block; height: .6rem; background: #1b7f79; border-radius: 2px; }
.caption { color: var(--soft); font-size: .9rem; margin-top: .2rem; }
"""


def check_report_packages() -> None:
    """Raises InvalidInput, before hours of work, if the report could not be drawn."""
    if importlib.util.find_spec("matplotlib") is None:
        raise InvalidInput(
            "the report needs matplotlib, which is not installed: pip install 'mimetic[report]'"
        )


def write_report(
    performance: Performance,
    footage: Footage,
    path: str | os.PathLike[str],
    summary: CaptureSummary | None = None,
    plots: Plots | None = None,
) -> None:
    """Writes report.html, whole or not at all; raises OSError. plots: where they are drawn."""
    path, summary = Path(path), summary or CaptureSummary()
    text = "".join(_parts(performance, footage, summary, plots or plots_of(performance)))
    with whole_file(path) as stream:
        stream.write(text.encode())


def _parts(
    performance: Performance, footage: Footage, summary: CaptureSummary, plots: Plots
) -> Iterator[str]:
    name = _html(footage.path.name)
    yield "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
    yield "<meta name='viewport' content='width=device-width, initial-scale=1'>"
    yield f"<title>{name}: capture</title><style>{STYLE}</style></head><body>"
    yield f"<h1>{name}</h1><p class='lead'>{_lead(performance, summary)}</p>"
    yield _facts(performance, summary)
    for note in performance.notes or ():
        yield f"<p class='note'>{_html(note)}</p>"
    yield "<h2>The face over the footage</h2><div class='pictures'>"
    for frame, picture in _pictures(performance, footage):
        yield f"<img src='{_jpeg_uri(picture)}' alt='frame {frame}'>"
    yield "</div><p class='caption'>The captured mesh and its landmarks. Bar: quality.</p>"
    yield "<h2>Quality and head motion</h2>" + plots.head
    yield "<p class='caption'>Rotation about the head's own axes relative to facing the camera: "
    yield "pitch down, yaw to the image's right, roll clockwise. Bands: one standard deviation.</p>"
    yield "<h2>Muscles</h2>" + plots.muscles
    yield "<p class='caption'>Activation from 0 to 1 by the seven groups; solid: the subject's "
    yield "left, dashed: right. Bands: one standard deviation. Grey: held frames, in which "
    yield "nothing was measured; blue lines: frames that a person corrected. "
    yield "Hatched: muscles that the pictures cannot tell from another one.</p>"
    if text := confounding_text(performance):
        yield f"<p class='caption'>Not told apart: {_html(text)}.</p>"
    if plots.articulators:
        yield "<h2>Jaw, lids and gaze</h2>" + plots.articulators
    yield _times(performance, summary) + _settings(performance, footage, summary)
    yield "</body></html>\n"


def _html(text: str) -> str:
    """Text that may come from a file, escaped for HTML."""
    return html.escape(shown(text))


def _lead(performance: Performance, summary: CaptureSummary) -> str:
    width, height = performance.image_size
    rest = f"<br>{_html(summary.fit.rest_text())}" if summary.fit else ""
    return (
        f"Frames {performance.frame[0]} to {performance.frame[-1]}, "
        f"{performance.fps:.6g} frames/s, {width} &times; {height} pixels{rest}"
    )


def _facts(performance: Performance, summary: CaptureSummary) -> str:
    total = sum(summary.seconds.values())
    names = np.array(performance.muscles)
    peak = performance.activations.max(axis=0)
    facts = [
        (f"{performance.num_frames}", "frames"),
        (f"{np.median(performance.quality):.2f}", "median quality"),
        (f"{int((performance.quality < HELD_QUALITY).sum())}", "frames held"),
        (f"{names[peak.argmax()].replace('_', ' ')}", f"strongest muscle, {peak.max():.2f}"),
    ]
    if corrected := corrected_frames(performance):
        facts.append((f"{len(corrected)}", "frames corrected"))
    if has_gaze(performance):
        low, high = gaze_range(performance)[0]
        facts.append((f"{low:.0f}° to {high:.0f}°", "gaze, to the subject's left"))
    if total > 0:
        facts.append((f"{performance.num_frames / total:.1f}", "frames captured a second"))
    cells = "".join(f"<div><b>{_html(b)}</b><span>{text}</span></div>" for b, text in facts)
    return f"<div class='facts'>{cells}</div>"


def _pictures(
    performance: Performance, footage: Footage
) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Overlay pictures of the frames that differ most from each other."""
    drawing = FaceDrawing(performance)
    frames = set(performance.frame[_distinct(performance)].tolist())
    for frame, image in footage.frames(min(frames), max(frames)):
        if frame in frames:
            yield frame, drawing.paint(image, performance.index_of(frame))


def _distinct(performance: Performance) -> NDArray[np.int64]:
    """Indices of frames far from each other in expression and head turn."""
    state = np.hstack(
        [
            performance.activations,
            expression_of(performance),
            3 * performance.head_pose[:, :3, 2],
        ]
    )
    usable = performance.quality >= min(0.5, float(np.median(performance.quality)))
    best = int(np.argmax(performance.quality))
    count = min(NUM_PICTURES, int(usable.sum()))
    return np.array(_core.distinct_rows(state, usable.tolist(), best, count), dtype=np.int64)


def _jpeg_uri(picture: NDArray[np.uint8]) -> str:
    from PIL import Image  # comes with matplotlib

    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "jpeg", quality=85)
    return picture_uri("jpeg", stream.getvalue())


def _times(performance: Performance, summary: CaptureSummary) -> str:
    if not summary.seconds:
        return ""
    total = sum(summary.seconds.values())
    rows = "".join(
        f"<tr><td>{_html(stage)}</td><td class='number'>{seconds:.2f} s</td>"
        f"<td class='number'>{1000 * seconds / performance.num_frames:.1f} ms</td>"
        f"<td><span class='bar' style='width:{12 * seconds / total:.2f}rem'></span></td></tr>"
        for stage, seconds in summary.seconds.items()
    )
    return (
        "<h2>Where the time goes</h2><table><tr><th>stage</th><th>total</th><th>a frame</th>"
        f"<th></th></tr>{rows}<tr><th>all</th><td class='number'>{total:.2f} s</td>"
        f"<td class='number'>{1000 * total / performance.num_frames:.1f} ms</td><td></td></tr>"
        "</table>"
    )


def _settings(performance: Performance, footage: Footage, summary: CaptureSummary) -> str:
    k = performance.intrinsics
    rows = {
        "footage": f"{footage.path.name}, {footage.num_frames} frames",
        "camera": f"focal length {k[0, 0]:.0f} pixels, centre ({k[0, 2]:.1f}, {k[1, 2]:.1f})",
        "mesh": f"{len(performance.neutral_vertices)} vertices, {len(performance.faces)} quads",
        **summary.settings,
    }
    if summary.fit is not None:
        shape = sorted(summary.fit.identity.items(), key=lambda item: -abs(item[1]))[:6]
        rows["reference frame"] = str(summary.fit.frame)
        rows["head shape"] = ", ".join(f"{name} {value:+.2f}" for name, value in shape) or "average"
    rows["versions"] = (
        f"Mimetic {__version__}, numpy {np.__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}"
    )
    cells = "".join(
        f"<tr><td>{_html(key)}</td><td>{_html(value)}</td></tr>" for key, value in rows.items()
    )
    return f"<h2>Settings and versions</h2><table>{cells}</table>"
