# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate`: scores against known truth."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimetic import InvalidInput
from mimetic.eigenspaces import installed_spaces, load
from mimetic.evaluate import (
    ablations,
    abuse,
    calibration,
    expression_tables,
    expressions,
    fit,
    flow,
    head,
    locate,
    rest,
)
from mimetic.evaluate.head_clips import face_mesh_python
from mimetic.evaluate.portraits import rendered_portraits
from mimetic.evaluate.rendered import scored, shared_images
from mimetic.evaluate.score import score
from mimetic.evaluate.stills import Stills, rendered_stills
from mimetic.evaluate.tables import as_json, as_text, summary
from mimetic.evaluate.truth import Truth
from mimetic.face_template import load_template
from mimetic.performance import Performance
from mimetic.results import prepare_folder
from mimetic.shown_text import shown
from mimetic.whole_file import whole_file

FILES = ("truth", "performance", "footage")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Score a performance against a truth file (docs/truth-file.md). Without --truth, render "
        "heads with known motion (kept in the cache), capture and score them. `locate` scores what "
        "finds faces on still images instead, beside OpenCV's cascades; `head` scores what follows "
        "heads on rendered sequences, beside MediaPipe's face mesh; `fit` scores heads fitted to "
        "portraits (docs/fitting.md); `flow` tells whether optical flow knows how far it is off, "
        "`ablations` what each part of the capture is good for (docs/evaluation.md), `calibration` "
        "what knowing a person's skin is worth (docs/calibration.md), `abuse` whether faces that "
        "are covered, cut away or in the dark are held or right (docs/evaluation.md), `rest` how "
        "often the frame that is taken for the neutral face shows it (docs/fitting.md)."
    )
    parser.add_argument(
        "what",
        nargs="?",
        choices=(
            *("ablations", "abuse", "calibration", "capture", "fit", "flow", "head", "locate"),
            "rest",
        ),
        default="capture",
        help="what to score (default: capture)",
    )
    parser.add_argument("--truth", type=Path, help="truth file of the footage")
    parser.add_argument("--performance", type=Path, help="performance captured from it")
    parser.add_argument("--footage", type=Path, help="the footage: score DIS flow beside it")
    parser.add_argument(
        "--set",
        choices=("held-out", "tuning", "small", "real", *expressions.SETS),
        default="held-out",
        help="which rendered clips or images (default: held-out); locate: real ones too; capture: "
        "full, nine expressions by 30 people, beside all peers (docs/evaluation.md)",
    )
    parser.add_argument("--images", type=Path, help="locate: these images (docs/still-images.md)")
    parser.add_argument(
        "--eigenspaces",
        type=Path,
        help="locate: this model, not the installed one (scripts/train_eigenspaces)",
    )
    parser.add_argument(
        "--people", type=int, metavar="N", help="--set full: only N of the people, evenly"
    )
    parser.add_argument(
        "--jobs", type=int, default=2, help="--set full: clips at once (default: 2)"
    )
    parser.add_argument(
        "--out", type=Path, help="--set full, fit, head, locate: write figures and plots here"
    )
    parser.add_argument("--json", action="store_true", help="print JSON, every figure in it")


def run_evaluate(options: argparse.Namespace) -> int:
    """Prints scores; 0 when all went well. Bad input raises InvalidInput or UnreadableMedia."""
    if options.what == "locate":
        return _run_locate(options)
    if options.images or options.eigenspaces:
        raise InvalidInput("--images and --eigenspaces go with `mimetic evaluate locate`")
    _check_set(options)
    if options.what == "calibration":
        return _run_calibration(options)
    if options.what == "rest":
        return _run_rest(options)
    if options.what == "ablations":
        return _run_ablations(options)
    if options.what == "abuse":
        return _run_abuse(options)
    if options.set in expressions.SETS:
        return _run_expressions(options)
    if options.what == "head":
        return _run_head(options)
    if options.what == "fit":
        return _run_fit(options)
    if options.what == "flow":
        return _run_flow(options)
    if options.out:
        raise InvalidInput("--out goes with --set full, `fit`, `head` and `locate`")
    if (options.truth is None) != (options.performance is None):
        raise InvalidInput("give both --truth and --performance, or neither")
    if options.truth is not None:
        made = iter([_score_files(options)])
    else:
        made = scored(options.set, _to_stderr)
    done = []
    for one in made:
        done.append(one)
        if not options.json:
            print(as_text(one), end="\n\n", flush=True)
    return _show(options, done, as_json, summary)


def _run_expressions(options: argparse.Namespace) -> int:
    if options.what != "capture" or options.truth or options.performance or options.footage:
        raise InvalidInput(f"--set {options.set} goes with plain `mimetic evaluate`")
    if options.jobs < 1 or (options.people is not None and options.people < 1):
        raise InvalidInput("--jobs and --people must be 1 or more")
    _prepare_out(options)
    chosen, long = expressions.takes(options.set, options.people, _to_stderr)
    python = face_mesh_python(_to_stderr)
    shown, drifts = expressions.score_set(chosen, long, python, _to_stderr, options.jobs)
    if options.out is not None:
        with whole_file(options.out / "expressions.json") as stream:
            stream.write(f"{expression_tables.as_json(shown, drifts)}\n".encode())
    if options.json:
        print(expression_tables.as_json(shown, drifts))
    else:
        print(expression_tables.as_text(shown), expression_tables.drift_text(drifts), sep="\n\n")
    return 0


def _run_head(options: argparse.Namespace) -> int:
    _refuse(options, *FILES)
    _prepare_out(options)
    done = []
    for scores in head.score_heads(options.set, _to_stderr):
        done += scores
        if not options.json:
            print(head.clip_text(scores), end="\n\n", flush=True)
    if options.out is not None:
        head.write(done, options.out)
    return _show(options, done, head.as_json, head.summary_text)


def _run_abuse(options: argparse.Namespace) -> int:
    _refuse(options, *FILES, "out")
    done = []
    for scores in abuse.score_set(options.set, _to_stderr):
        done += scores
    return _show(options, done, abuse.as_json, abuse.as_text)


def _run_flow(options: argparse.Namespace) -> int:
    _refuse(options, *FILES, "out")
    found = flow.score_flow(options.set, _to_stderr)
    return _show(options, found, flow.as_json, flow.as_text)


def _run_rest(options: argparse.Namespace) -> int:
    _refuse(options, *FILES, "out")
    return _show(options, rest.score_rest(options.set, _to_stderr), rest.as_json, rest.as_text)


def _run_ablations(options: argparse.Namespace) -> int:
    _refuse(options, *FILES, "out")
    made = ablations.score_ablations(options.set, options.people, _to_stderr)
    return _show(options, made, ablations.as_json, ablations.as_text)


def _run_calibration(options: argparse.Namespace) -> int:
    _refuse(options, *FILES, "out")
    made = calibration.score_calibration(options.set, options.people, _to_stderr)
    return _show(options, made, calibration.as_json, calibration.as_text)


def _prepare_out(options: argparse.Namespace) -> None:
    """Tells before hours of work that --out cannot be written to."""
    if options.out is not None:
        prepare_folder(options.out, ())


def _refuse(options: argparse.Namespace, *names: str) -> None:
    """Raises InvalidInput if a path is given for which what is scored has no use."""
    if any(getattr(options, name) for name in names):
        *first, last = (f"--{name}" for name in names)
        raise InvalidInput(f"{', '.join(first)} and {last} do not go with `{options.what}`")


def _show(
    options: argparse.Namespace,
    made: Any,
    as_json: Callable[[Any], str],
    as_text: Callable[[Any], str],
) -> int:
    """Prints what was scored in the form that is asked for; the exit status."""
    print(as_json(made) if options.json else as_text(made))
    return 0


def _check_set(options: argparse.Namespace) -> None:
    if options.people is not None and options.set not in expressions.SETS:
        raise InvalidInput("--people goes with --set full")
    if options.set == "real":
        raise InvalidInput("--set real goes with `mimetic evaluate locate`")


def _run_locate(options: argparse.Namespace) -> int:
    _refuse(options, *FILES)
    _prepare_out(options)
    if options.images is not None:
        images = Stills.load(options.images)
    else:
        images = rendered_stills(options.set, _to_stderr)
    spaces = load(options.eigenspaces) if options.eigenspaces else installed_spaces()
    scores = locate.score_finders(images, spaces)
    if options.out is not None:
        locate.write(scores, options.out)
    return _show(options, scores, locate.as_json, locate.as_text)


def _run_fit(options: argparse.Namespace) -> int:
    _refuse(options, *FILES)
    _prepare_out(options)
    template = load_template()
    scores = fit.score_fits(rendered_portraits(options.set, template, _to_stderr), template)
    if options.out is not None:
        fit.write(scores, options.out)
    return _show(options, scores, fit.as_json, fit.as_text)


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _score_files(options: argparse.Namespace):
    truth, performance = Truth.load(options.truth), Performance.load(options.performance)
    images = None
    if options.footage is not None:
        images = shared_images(options.footage, truth, performance)
    return score(truth, performance, shown(options.performance.stem), images)
