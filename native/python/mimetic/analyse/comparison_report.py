# SPDX-License-Identifier: GPL-3.0-or-later
"""All that a comparison with FACS writes: figures, the numbers behind them, a page."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from mimetic import _core
from mimetic.analyse import drawing
from mimetic.analyse.comparison import Comparison
from mimetic.analyse.comparison_figures import (
    control_points,
    course_figure,
    difference_figure,
    motion_lengths,
    neutral_figure,
)
from mimetic.analyse.motion_fields import COLUMNS, MotionFields, motion_figure, motion_rows
from mimetic.analyse.tables import write_table
from mimetic.analyse.timing import Timing
from mimetic.analyse.timing_figures import group_figure
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import FaceTemplate

FIGURES = ("neutral", "courses", "difference", "groups")
TABLES = ("comparison.csv", "places.csv", "courses.csv", "difference.csv", "course.csv")
# Only where footage is given
MOTION_FILES = ("motion.csv", "motion.png", "motion.svg")
FILES = (*TABLES, "report.html", *(f"{name}.{k}" for name in FIGURES for k in ("png", "svg")))


def write_comparison(
    comparison: Comparison,
    timing: Timing,
    template: FaceTemplate,
    folder: Path,
    name: str,
    fields: MotionFields | None = None,
) -> None:
    """FILES into the folder, and MOTION_FILES of motion fields; name: what was compared.

    Raises OSError.
    """
    _write_tables(comparison, template, folder)
    figures = {
        "neutral": neutral_figure(comparison, template),
        "courses": course_figure(comparison, template),
        "difference": difference_figure(comparison, template),
        "groups": group_figure(timing),
    }
    if fields is not None:
        figures["motion"] = motion_figure(fields, comparison, template)
        write_table(folder / "motion.csv", motion_rows(fields), COLUMNS)
    pictures = {key: drawing.write_figure(figure, folder, key) for key, figure in figures.items()}
    unit, event = comparison.unit, comparison.event
    lead = (
        f"{unit.name}, {unit.meaning}, beside event {event.number} of the {event.curve.name}, "
        f"frames {_frame(comparison, 0)} to {_frame(comparison, -1)}"
    )
    if not comparison.is_onset_seen:
        lead += f"; {onset_words(comparison)}"
    text = drawing.page(f"{name}: beside FACS", lead, _parts(comparison, pictures))
    with whole_file(folder / "report.html") as stream:
        stream.write(text.encode())


def _frame(comparison: Comparison, row: int) -> int:
    return int(comparison.performance.frame[comparison.rows[row]])


def onset_words(comparison: Comparison) -> str:
    """What an onset that is not seen means for the numbers."""
    return (
        "its onset is not seen, as it is there when its scene begins: displacements are from frame "
        f"{_frame(comparison, comparison.rest)}, after its release"
    )


def summary_row(comparison: Comparison) -> dict[str, object]:
    spatial, temporal = comparison.spatial, comparison.temporal
    is_seen = comparison.is_onset_seen
    return {
        "unit": comparison.unit.name,
        "event": comparison.event.number,
        "first_frame": _frame(comparison, 0),
        "peak_frame": _frame(comparison, comparison.peak),
        "last_frame": _frame(comparison, -1),
        "begins_before_clip": not is_seen,
        "rest_frame": _frame(comparison, comparison.rest),
        "intensity": spatial.intensity,
        "inside_r2": spatial.inside_explained,
        "outside_energy": spatial.outside_share,
        "outside_energy_significant": spatial.outside_significant_share,
        "outside_energy_far": spatial.outside_far_share,
        "motion_gini": spatial.gini,
        "rank_one_energy": temporal.rank_one_share,
        "application_line_r2": temporal.ramp_explained if is_seen else "",
        "best_ramp_r2": temporal.ramp_whole_explained if is_seen else "",
    }


def _write_tables(comparison: Comparison, template: FaceTemplate, folder: Path) -> None:
    row = summary_row(comparison)
    write_table(folder / "comparison.csv", [row], list(row))
    write_table(
        folder / "places.csv",
        (
            {
                "place": motion.place,
                "seen_mm": motion.seen,
                "unit_mm": motion.unit,
                "std_mm": motion.std,
                "is_in_reach_of_unit": motion.is_in_reach,
                "more_than_unit": motion.verdict,
            }
            for motion in comparison.places
        ),
        ["place", "seen_mm", "unit_mm", "std_mm", "is_in_reach_of_unit", "more_than_unit"],
    )
    frames = comparison.performance.frame[comparison.rows]
    names, in_video, by_unit = control_points(comparison, template)
    write_table(
        folder / "courses.csv",
        (
            {"frame": int(frame), "point": name, "seen_mm": s, "unit_mm": u}
            for name, seen_row, unit_row in zip(names, in_video, by_unit, strict=True)
            for frame, s, u in zip(frames, seen_row.tolist(), unit_row.tolist(), strict=True)
        ),
        ["frame", "point", "seen_mm", "unit_mm"],
    )
    write_table(
        folder / "course.csv",
        (
            {"frame": int(frame), "course": course, "best_ramp": ramp}
            for frame, course, ramp in zip(
                frames, comparison.course.tolist(), comparison.ramp.tolist(), strict=True
            )
        ),
        ["frame", "course", "best_ramp"],
    )
    lengths = (array.tolist() for array in motion_lengths(comparison))
    stds = (1000 * comparison.stds).tolist()
    columns = ["vertex", "unit_mm", "seen_mm", "excess_mm", "std_mm", "in_reach", "area_mm2"]
    areas, reach = (1e6 * comparison.areas).tolist(), (comparison.unit.reach > 0).tolist()
    rows = zip(range(len(stds)), *lengths, stds, reach, areas, strict=True)
    write_table(
        folder / "difference.csv",
        (dict(zip(columns, row, strict=True)) for row in rows if row[-1] > 0),
        columns,
    )


def _parts(comparison: Comparison, pictures: dict[str, bytes]) -> Iterator[str]:
    rest = f"the event's {'first' if comparison.is_onset_seen else 'last'} frame"
    yield drawing.table(["beside FACS", ""], _figures(comparison))
    for key, heading, caption in (
        ("neutral", "Neutral, FACS and video", "As the paper's Fig. 7, seen from the front."),
        (
            "difference",
            "Where motion differs",
            "As the paper's Fig. 9: how far skin moves; red in (c) is motion that the unit lacks, "
            "blue what the video lacks, grey what is within two standard deviations.",
        ),
        (
            "courses",
            "Control points over time",
            "As the paper's Fig. 8: landmarks from brow to chin, millimetres from where they are "
            f"in {rest}.",
        ),
        ("groups", "Seven groups", "As the paper's Fig. 10, of the whole performance."),
        (
            "motion",
            "Motion fields",
            f"As the paper's Fig. 6, from {rest} to its peak: (a) optical flow, followed "
            "frame by frame, (b) the captured surface's motion in the picture, head and "
            "skin, (c) the skin's motion in space, in the head's own frame.",
        ),
    ):
        if key not in pictures:
            continue
        figure = drawing.picture(pictures[key], heading)
        yield drawing.section(heading, figure, drawing.paragraph(caption, "caption"))
    yield drawing.section(
        "The places that the paper names",
        drawing.table(
            ["place", "seen, mm", f"{comparison.unit.name}, mm", "s.d., mm", "more than FACS?"],
            [
                [m.place, f"{m.seen:.1f}", f"{m.unit:.1f}", f"{m.std:.1f}", m.verdict]
                for m in comparison.places
            ],
        ),
        drawing.paragraph(
            "Yes: beyond the unit by two standard deviations. No: the unit moves the skin there "
            "further by two, or it moves by less than two, which are themselves under a "
            "millimetre. Muscles that share skin and the skin's own spread reach far places too: "
            "what a capture itself adds is measured on clips that move by the unit alone "
            "(docs/measured/timing.md).",
            "caption",
        ),
    )


def _figures(comparison: Comparison) -> list[list[str]]:
    spatial, temporal = comparison.spatial, comparison.temporal
    line, ramp = f"{temporal.ramp_explained:.3f}", f"{temporal.ramp_whole_explained:.3f}"
    if not comparison.is_onset_seen:
        line = ramp = "onset not seen"
    return [
        ["intensity of the unit that explains most of its own region", f"{spatial.intensity:.2f}"],
        ["motion in that region that it explains, R²", f"{spatial.inside_explained:.2f}"],
        ["energy outside the region", f"{100 * spatial.outside_share:.0f} %"],
        [
            "  farther from it than a capture blurs, 15 mm",
            f"{100 * spatial.outside_far_share:.0f} %",
        ],
        ["  of what is beyond two standard deviations", _percent(spatial)],
        ["energy of one pattern times one curve (FACS: 100 %)", f"{temporal.rank_one_share:.1%}"],
        ["application as a straight line, R² (FACS: 1)", line],
        ["all of it as straight up, hold, straight down, R²", ramp],
    ]


def _percent(spatial: _core.SpatialComparison) -> str:
    share = spatial.outside_significant_share
    return f"{100 * share:.0f} %" if share == share else "nothing is"
