# SPDX-License-Identifier: GPL-3.0-or-later
"""index.html: every clip of a batch with a picture and its quality, in one file."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterator, Mapping
from pathlib import Path
from urllib.parse import quote

from mimetic.batch.plan import PAGE, Batch
from mimetic.batch.standing import Standing
from mimetic.batch.take_summary import PICTURE
from mimetic.batch.task import Task
from mimetic.performance.document import HELD_QUALITY
from mimetic.report.html import STYLE
from mimetic.shared.counted import counted
from mimetic.shared.shown_text import shown
from mimetic.shared.whole_file import whole_file

LARGEST_PICTURE = 1 << 20  # bytes
CURVE = (160, 28)  # width and height, units of the drawing
STYLE_OF_CLIPS = """
.clips { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(17rem, 1fr)); }
.clip { border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
.clip > img { width: 100%; aspect-ratio: 4 / 3; object-fit: contain; display: block;
  background: #22282c; }
.clip > div.text { padding: .6rem .8rem .8rem; } .clip h3 { margin: 0 0 .2rem; font-size: 1rem;
  overflow-wrap: anywhere; }
.clip p { margin: .2rem 0; font-size: .9rem; overflow-wrap: anywhere; }
.clip svg { width: 100%; height: 1.8rem; display: block; margin: .3rem 0; }
.failed { border-color: #d1495b; } .failed p.why { color: #d1495b; }
"""


def write_page(batch: Batch, failures: Mapping[str, str], standing: Standing) -> None:
    """Writes index.html in the batch's folder, whole or not at all; raises OSError.

    failures: as for `Standing.why_not`.
    """
    with whole_file(batch.out / PAGE) as stream:
        for part in _parts(batch, failures, standing):  # with its pictures a page is 20 kB a clip
            stream.write(part.encode())


def _parts(batch: Batch, failures: Mapping[str, str], standing: Standing) -> Iterator[str]:
    states = [(task, standing.why_not(task, failures)) for task in batch.tasks]
    num_done = sum(why == "" for _, why in states)
    num_failed = len(batch.problems) + sum(bool(why) for _, why in states)
    num_waiting = sum(why is None for _, why in states)
    title = _html(f"Batch {batch.out.absolute().name}")
    yield "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
    yield "<meta name='viewport' content='width=device-width, initial-scale=1'>"
    yield f"<title>{title}</title><style>{STYLE}{STYLE_OF_CLIPS}</style></head><body>"
    yield f"<h1>{title}</h1><div class='facts'>"
    num_held = sum(int(task.take.get("num_held", 0)) for task, why in states if why == "")
    facts = [f"{counted(num_done, 'clip')} done", f"{num_failed} failed"]
    facts += [f"{num_waiting} not done yet", f"{counted(num_held, 'frame')} held in all"]
    for fact in facts:
        number, _, text = fact.partition(" ")
        yield f"<div><b>{number}</b><span>{text}</span></div>"
    yield "</div>"
    if num_failed:
        yield "<h2>Failed</h2><div class='clips'>"
        yield from (_card(task, why) for task, why in states if why)
        yield from (_lone_card(row.clip, row.problem) for row in batch.problems)
        yield "</div>"
    yield "<h2>Clips</h2><div class='clips'>"
    # Those to look at first: the least quality
    shown_states = [(task, why) for task, why in states if not why]
    shown_states.sort(key=lambda state: (state[1] is None, _median(state[0])))
    yield from (_card(task, why) for task, why in shown_states)
    yield "</div><p class='caption'>Sorted by quality, the least first. Curve: quality over the "
    yield "clip; under the dotted line frames are held. Picture: the frame in which most muscles "
    yield "are at work.</p></body></html>\n"


def _median(task: Task) -> float:
    value = task.take.get("median", 0.0)
    return float(value) if isinstance(value, int | float) else 0.0


def _card(task: Task, why: str | None) -> str:
    is_captured = "capture" in task.done and bool(task.take)
    parts = [f"<div class='clip{' failed' if why else ''}'>"]
    if is_captured:
        parts.append(_picture(task))
    parts.append(f"<div class='text'><h3>{_html(task.name)}</h3>")
    if is_captured:
        parts += [_curve(task.take), f"<p>{_html(_described(task))}</p>"]
    if why is None:
        parts.append("<p>not done yet</p>")
    elif why:
        parts.append(f"<p class='why'>{_html(why)}</p>")
    for note in (*task.take.get("notes", ()), *task.notes):
        parts.append(f"<p class='caption'>{_html(str(note))}</p>")
    links = [
        f"<a href='{_html(quote(f'{task.name}/{name}'))}'>{_html(name)}</a>"
        for step in task.steps()
        if task.has_results(step)
        for name in step.outputs
    ]
    parts.append(f"<p>{' '.join(links)}</p><p class='caption'>{_html(_source(task))}</p>")
    return "".join((*parts, "</div></div>"))


def _lone_card(clip: str, why: str) -> str:
    return (
        f"<div class='clip failed'><div class='text'><h3>{_html(Path(clip).name)}</h3>"
        f"<p class='why'>{_html(why)}</p><p class='caption'>{_html(clip)}</p></div></div>"
    )


def _described(task: Task) -> str:
    take = task.take
    first, last = take["frames"]
    holds = f", {counted(take['num_held'], 'frame')} held" if take["num_held"] else ""
    return (
        f"quality {take['median']:.2f}, lowest {take['lowest']:.2f}{holds}; "
        f"frames {first} to {last}"
    )


def _source(task: Task) -> str:
    row = task.row
    parts = [row.clip, row.frames and f"frames {row.frames}", row.person, row.character]
    return ", ".join(filter(None, parts))


def _picture(task: Task) -> str:
    path = task.folder / PICTURE
    try:
        if path.stat().st_size <= LARGEST_PICTURE:
            data = base64.b64encode(path.read_bytes()).decode()
            label = f"{task.name}, frame {task.take.get('shown')}"
            return f"<img alt='{_html(label)}' src='data:image/jpeg;base64,{data}'>"
    except OSError:
        pass
    return ""


def _curve(take: Mapping[str, object]) -> str:
    """Quality over the clip as a small drawing."""
    width, height = CURVE
    values = take.get("curve")
    if not isinstance(values, list) or not values:
        return ""
    step = width / max(1, len(values) - 1)
    points = " ".join(
        f"{i * step:.1f},{height * (1 - float(value)):.1f}" for i, value in enumerate(values)
    )
    line = height * (1 - HELD_QUALITY)
    return (
        f"<svg viewBox='0 -1 {width} {height + 2}' preserveAspectRatio='none' role='img' "
        f"aria-label='quality over the clip'><line x1='0' x2='{width}' y1='{line}' y2='{line}' "
        "stroke='#d1495b' stroke-width='.6' stroke-dasharray='2 2'/>"
        f"<polyline points='{points}' fill='none' stroke='#1b7f79' stroke-width='1.5'/></svg>"
    )


def _html(text: str) -> str:
    return html.escape(shown(text), quote=True)
