# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic analyse`: when muscles fire, as tables, figures and a page."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic.analyse.timing import analyse_timing, events_text
from mimetic.analyse.timing_report import FILES, write_timing
from mimetic.commands.console import Console
from mimetic.performance.document import Performance
from mimetic.report.html import check_report_packages
from mimetic.shared.counted import counted
from mimetic.shared.regular_file import check_input
from mimetic.shared.results import beside_capture, prepare_folder, publish, staging

PAGE = "timing.html"  # in a folder whose report.html is a capture's


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("--out", type=Path, required=True, help="folder for tables and figures")


def run_analyse(arguments: argparse.Namespace) -> int:
    check_report_packages()
    check_input(arguments.performance, "a performance (the performance.npz of a capture)")
    out = arguments.out
    prepare_folder(out, FILES, arguments.performance)
    performance = Performance.load(arguments.performance)
    with Console() as console, staging(out) as folder:
        timing = analyse_timing(performance, console.show)
        console.show(0.95, "drawing")
        name = performance.footage[0] if performance.footage else arguments.performance.name
        write_timing(timing, folder, name)
        beside_capture(folder, out, PAGE)
        publish(folder, out, is_finished=True)
    certain = [event for event in timing.of_kind("group") if event.fit.is_certain]
    delayed_pairs = [pair for pair in timing.delays if pair.delay.is_delayed]
    print(
        f"{out}: {events_text(len(certain))} of groups, {len(delayed_pairs)} of "
        f"{counted(len(timing.delays), 'pair')} delayed"
    )
    return 0
