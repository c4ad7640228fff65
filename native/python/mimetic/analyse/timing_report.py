# SPDX-License-Identifier: GPL-3.0-or-later
"""All that an analysis of timing writes: tables, figures, a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from mimetic.analyse import drawing
from mimetic.analyse.smiles import (
    BLINK,
    LONGER,
    PUBLISHED,
    Smile,
    smile_rows,
    smiles_of,
    summary_of,
)
from mimetic.analyse.tables import columns_of, delay_rows, phase_rows, write_table
from mimetic.analyse.timing import Event, GroupDelay, Timing, events_text
from mimetic.analyse.timing_figures import delay_figure, group_figure, smile_figure
from mimetic.shared.whole_file import whole_file

FILES = (
    *("phases.csv", "delays.csv", "smiles.csv", "report.html"),
    *(f"{name}.{kind}" for name in ("groups", "delays", "smiles") for kind in ("png", "svg")),
)
PHASE_COLUMNS = ["kind", "name", "group", "event"]
DELAY_COLUMNS = ["leader", "follower", "delay_frames", "is_delayed"]
SMILE_COLUMNS = ["event", "rise_seconds", "eye_ratio", "eye_delay_frames"]


def write_timing(timing: Timing, folder: Path, name: str) -> None:
    """FILES into the folder; name: what was analysed. Raises OSError."""
    smiles = smiles_of(timing)
    for file, rows, empty in (
        ("phases.csv", phase_rows(timing), PHASE_COLUMNS),
        ("delays.csv", delay_rows(timing), DELAY_COLUMNS),
        ("smiles.csv", smile_rows(smiles), SMILE_COLUMNS),
    ):
        write_table(folder / file, rows, columns_of(rows, empty))
    pictures = {
        "groups": drawing.write_figure(group_figure(timing), folder, "groups"),
        "delays": drawing.write_figure(delay_figure(timing), folder, "delays"),
        "smiles": drawing.write_figure(smile_figure(smiles), folder, "smiles"),
    }
    performance = timing.performance
    lead = (
        f"Frames {performance.frame[0]} to {performance.frame[-1]}, "
        f"{performance.fps:.6g} frames/s: when muscles fire"
    )
    text = drawing.page(f"{name}: timing", lead, _parts(timing, smiles, pictures))
    with whole_file(folder / "report.html") as stream:
        stream.write(text.encode())


def _parts(timing: Timing, smiles: list[Smile], pictures: dict[str, bytes]) -> Iterator[str]:
    yield drawing.section(
        "Seven groups and their phases",
        drawing.picture(pictures["groups"], "seven groups over time with fitted phases"),
        drawing.paragraph(
            "Solid: the mean of a group's muscles, with one standard deviation. Dashed: fitted "
            "application, hold and release of events whose amplitude is beyond what the capture "
            "may be wrong by. Tick: onset with its 95 % interval.",
            "caption",
        ),
    )
    certain = [event for event in timing.of_kind("group") if event.fit.is_certain]
    if certain:
        yield drawing.table(*_phase_table(certain))
        yield drawing.paragraph(_model_words(certain))
    yield drawing.section("Delays between groups", *_delay_parts(timing.delays, pictures))
    yield drawing.section("Smiles", *_smile_parts(smiles, pictures))
    yield drawing.section(
        "What this cannot determine",
        drawing.paragraph(
            "Only the surface is seen: a slow fall may be a muscle that lets go slowly or skin "
            "that relaxes. Which of the two it is cannot be determined from video. Intervals "
            "count the curve's own noise, as the capture's smoother correlates it, and for "
            "amplitudes the capture's standard deviations and what fitted heads usually get wrong."
        ),
    )


def _phase_table(events: list[Event]) -> tuple[list[str], list[list[str]]]:
    rows = []
    for event in events:
        fit = event.fit
        rows.append(
            [
                f"{event.curve.group} {event.curve.name}",
                str(event.number),
                fit.shape.model.name.replace("_", " "),
                "before the clip" if fit.begins_before else _words(fit.onset),
                "" if fit.begins_before else _words(fit.apex),
                "after the clip" if fit.ends_after else _words(fit.release),
                _words(event.amplitude, 2),
                "" if fit.begins_before else _words(fit.exponent),
                f"{fit.explained:.3f}",
            ]
        )
    header = ["group", "event", "model", "onset", "apex", "release", "amplitude", "exponent", "R²"]
    return header, rows


def _model_words(events: list[Event]) -> str:
    counts = Counter(event.fit.shape.model.name.replace("_", " ") for event in events)
    words = ", ".join(f"{count} as {model}" for model, count in counts.most_common())
    return f"By the Bayesian information criterion, of {events_text(len(events))} {words}."


def _delay_parts(pairs: list[GroupDelay], pictures: dict[str, bytes]) -> Iterator[str]:
    if not pairs:
        yield drawing.paragraph("No two groups have certain events that begin near each other.")
        return
    delayed_pairs = [pair for pair in pairs if pair.delay.is_delayed]
    yield drawing.picture(pictures["delays"], "delays between groups")
    yield drawing.paragraph(
        f"{len(delayed_pairs)} of {len(pairs)} pairs are delayed: the 95 % interval excludes 0, "
        "fewer than 5 % of circular shifts correlate as well, and the fitted onsets and apexes "
        "agree in sign.",
        "caption",
    )


def _smile_parts(smiles: list[Smile], pictures: dict[str, bytes]) -> Iterator[str]:
    if not smiles:
        yield drawing.paragraph("The lip-corner pullers have no event that is certain.")
        return
    for smile in smiles:
        yield drawing.paragraph(summary_of(smile))
    yield drawing.picture(pictures["smiles"], "smiles beside published bands")
    yield drawing.paragraph(
        "Bands are what others measured of other people, by other means; they say nothing about "
        "whether this smile is felt. Their numbers are as later work quotes them. The eyes "
        "contract in polite and embarrassed smiles too "
        f"(Ambadar et al. 2009). {LONGER} {BLINK}",
        "caption",
    )
    rows = [[b.text, f"{b.lower:g} to {b.upper:g} s", b.source] for b in PUBLISHED]
    yield drawing.table(["published", "band", "source"], rows)


def _words(interval: object, digits: int = 1) -> str:
    value, lower, upper = (getattr(interval, name) for name in ("value", "lower", "upper"))
    return f"{value:.{digits}f} ({lower:.{digits}f} to {upper:.{digits}f})"
