# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic compare`: an expression beside the action unit that FACS describes it by."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic import InvalidInput
from mimetic.analyse.comparison import compare
from mimetic.analyse.comparison_report import (
    FILES,
    MOTION_FILES,
    onset_words,
    write_comparison,
)
from mimetic.analyse.motion_fields import motion_fields
from mimetic.analyse.timing import analyse_timing
from mimetic.commands.bake import check_footage
from mimetic.commands.console import Console
from mimetic.media.footage import Footage
from mimetic.muscles.action_units import check_mesh, unit_names
from mimetic.performance.document import Performance
from mimetic.report.html import check_report_packages
from mimetic.shared.regular_file import check_input
from mimetic.shared.results import beside_capture, prepare_folder, publish, staging
from mimetic.template.face_template import load_template

PAGE = "comparison.html"  # in a folder whose report.html is a capture's


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument(
        "--with", dest="other", choices=("facs",), default="facs", help="what to compare with"
    )
    parser.add_argument(
        "--expression",
        default="AU12",
        metavar="UNIT",
        help=f"action unit: {', '.join(unit_names())} (default: AU12)",
    )
    parser.add_argument(
        "--event",
        type=int,
        metavar="N",
        help="which event of the unit's muscle group, or of the jaw or lids where they do it, "
        "counted from 1 as in phases.csv (default: the strongest that begins within the clip)",
    )
    parser.add_argument(
        "--footage", type=Path, help="the captured clip: draws the motion fields too (Fig. 6)"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder for tables and figures")


def run_compare(arguments: argparse.Namespace) -> int:
    check_report_packages()
    if arguments.expression.upper().removeprefix("AU") not in _numbers():
        raise InvalidInput(
            f"--expression {arguments.expression}: known are {', '.join(unit_names())}"
        )
    check_input(arguments.performance, "a performance (the performance.npz of a capture)")
    out = arguments.out
    footage = None
    if arguments.footage is not None:
        check_footage(arguments.performance, arguments.footage)
        footage = Footage(arguments.footage)
    inputs = [arguments.performance, *([arguments.footage] if footage else [])]
    prepare_folder(out, (*FILES, *(MOTION_FILES if footage else ())), *inputs)
    performance, template = Performance.load(arguments.performance), load_template()
    check_mesh(performance.neutral_vertices, template)
    with Console() as console, staging(out) as folder:
        timing = analyse_timing(performance, console.show, kinds=("group",))
        comparison = compare(timing, arguments.expression, template, arguments.event)
        console.show(0.92, "following the flow" if footage else "drawing")
        fields = motion_fields(comparison, template, footage) if footage else None
        console.show(0.95, "drawing")
        name = performance.footage[0] if performance.footage else arguments.performance.name
        write_comparison(comparison, timing, template, folder, name, fields)
        beside_capture(folder, out, PAGE)
        publish(folder, out, is_finished=True)
    spatial, temporal = comparison.spatial, comparison.temporal
    print(
        f"{out}: {comparison.unit.name} at {spatial.intensity:.2f} explains "
        f"{spatial.inside_explained:.2f} of its region; {100 * spatial.outside_share:.0f} % of the "
        f"energy is outside; one pattern has {100 * temporal.rank_one_share:.1f} %"
    )
    if not comparison.is_onset_seen:
        print(f"{out}: {onset_words(comparison)}")
    return 0


def _numbers() -> set[str]:
    return {name.removeprefix("AU") for name in unit_names()}
