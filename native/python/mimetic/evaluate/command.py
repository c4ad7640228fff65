# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate`: scores against known truth."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from mimetic import InvalidInput
from mimetic.evaluate.rendered import scored, shared_images
from mimetic.evaluate.score import score
from mimetic.evaluate.tables import as_json, as_text, summary
from mimetic.evaluate.truth import Truth
from mimetic.performance import Performance


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Score a performance against a truth file (docs/truth-file.md). Without --truth, render "
        "heads with known motion (kept in the cache), capture and score them."
    )
    parser.add_argument("--truth", type=Path, help="truth file of the footage")
    parser.add_argument("--performance", type=Path, help="performance captured from it")
    parser.add_argument("--footage", type=Path, help="the footage: score DIS flow beside it")
    parser.add_argument(
        "--set",
        choices=("held-out", "tuning", "small"),
        default="held-out",
        help="which rendered clips (default: held-out)",
    )
    parser.add_argument("--json", action="store_true", help="print JSON, every figure in it")


def run_evaluate(options: argparse.Namespace) -> int:
    """Prints scores; 0 when all went well. Bad input raises InvalidInput or UnreadableMedia."""
    if (options.truth is None) != (options.performance is None):
        raise InvalidInput("give both --truth and --performance, or neither")
    if options.truth is not None:
        made = iter([_score_files(options)])
    else:
        made = scored(options.set, lambda line: print(line, file=sys.stderr, flush=True))
    done = []
    for one in made:
        done.append(one)
        if not options.json:
            print(as_text(one), end="\n\n", flush=True)
    print(as_json(done) if options.json else summary(done))
    return 0


def _score_files(options: argparse.Namespace):
    truth, performance = Truth.load(options.truth), Performance.load(options.performance)
    images = None
    if options.footage is not None:
        images = shared_images(options.footage, truth, performance)
    return score(truth, performance, options.performance.stem, images)
