# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate`: a performance against known truth; in a checkout, tables beside peers too."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path
from types import ModuleType

from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.score.score import Score, score, shared_images
from mimetic.score.tables import as_json, as_text, summary
from mimetic.score.truth import Truth
from mimetic.shared.shown_text import shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Score a performance against a truth file (docs/truth-file.md). In a checkout, without "
        "--truth: render heads with known motion (kept in the cache), capture and score them."
    )
    parser.add_argument("--truth", type=Path, help="truth file of the footage")
    parser.add_argument("--performance", type=Path, help="performance captured from it")
    parser.add_argument("--footage", type=Path, help="the footage: score DIS flow beside it")
    parser.add_argument("--json", action="store_true", help="print JSON, every figure in it")
    if runs := _runs():
        runs.add_arguments(parser)


def run_evaluate(options: argparse.Namespace) -> int:
    """Prints scores; 0 when all went well. Bad input raises InvalidInput or UnreadableMedia."""
    runs = _runs()
    if runs:
        runs.check(options)
    if (options.truth is None) != (options.performance is None):
        raise InvalidInput("give both --truth and --performance, or neither")
    if options.truth is not None:
        return _score_files(options)
    if runs is None:
        raise InvalidInput(
            "clips with known truth are rendered in a checkout of Mimetic: run it there, or give "
            "--truth and --performance"
        )
    return runs.run_tables(options)


def _score_files(options: argparse.Namespace) -> int:
    truth, performance = Truth.load(options.truth), Performance.load(options.performance)
    images = None
    if options.footage is not None:
        images = shared_images(options.footage, truth, performance)
    result = score(truth, performance, shown(options.performance.stem), images)
    print(as_json([result]) if options.json else _text(result))
    return 0


def _text(result: Score) -> str:
    return f"{as_text(result)}\n\n{summary([result])}"


def _runs() -> ModuleType | None:
    """The tables of the checkout that this package or its environment lies in, if it does."""
    for folder in (*Path(__file__).parents, Path(sys.prefix).parent):
        if (folder / "evaluation" / "runs" / "command.py").is_file():
            if str(folder) not in sys.path:
                sys.path.insert(0, str(folder))
            return importlib.import_module("evaluation.runs.command")
    return None
