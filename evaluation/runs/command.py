# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate`: scores against known truth."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from mimetic import InvalidInput
from mimetic.locate.eigenspaces import installed_spaces, load
from mimetic.score.tables import as_json, as_text, summary
from mimetic.shared.results import prepare_folder
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import load_template

from evaluation.progress import to_stderr
from evaluation.runs import (
    ablations,
    abuse,
    calibration,
    characters,
    consistency,
    expression_tables,
    expressions,
    fit,
    flow,
    gaze,
    head,
    keys,
    live,
    live_still,
    live_taught,
    locate,
    puppet,
    real,
    real_rest,
    rest,
    retarget,
    speech,
    timing,
)
from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.portraits import rendered_portraits
from evaluation.runs.real_noise import noise_text
from evaluation.runs.rendered import scored
from evaluation.runs.stills import Stills, rendered_stills

FILES = ("truth", "performance", "footage")
SCORED_AGAIN = ("consistency", "real", "keys", "live", "puppet", "timing")
WITH_OUT = "--out goes with --set full, `consistency`, `fit`, `head`, `locate`, `real` and `timing`"
WHAT_IS_SCORED = (
    " `locate` scores what finds faces on still images instead, beside OpenCV's cascades; "
    "`head` scores what follows heads on rendered sequences, beside MediaPipe's face mesh; "
    "`fit` scores heads fitted to portraits (docs/measured/fitting.md); `flow` checks "
    "the covariances of optical flow, `ablations` what each part of the capture is good "
    "for, `abuse` whether faces that are covered, cut away or in the dark are held or right "
    "(docs/measured/evaluation.md), `calibration` what knowing a person's skin is worth "
    "(docs/measured/calibration.md), `rest` how often the frame that is taken for the neutral "
    "face shows it (docs/guide/fitting.md), `real` how near eyes and lips come to points "
    "marked by hand on real faces (docs/measured/real-faces.md), `timing` how well the "
    "times at which muscles fire are recovered and `keys` how few keys stand for the curves of "
    "real clips (docs/measured/timing.md), `gaze` how well the eyes of rendered people are "
    "followed (docs/measured/gaze.md), `speech` whether their lips meet and their lids wink when "
    "they do (docs/measured/speech.md), `retarget` how well a performance plays on a "
    "character's own shape keys (docs/measured/retargeting.md), `characters` how near "
    "landmarks that place themselves on heads of other makes come to the true ones "
    "(docs/measured/characters.md), `consistency` whether the same expression is read as the same "
    "muscles on different people (docs/measured/consistency.md), `live` what the live filter loses "
    "against the capture (docs/measured/live.md), `puppet` how a taught face does on time that was "
    "held out, and on disturbed pictures (docs/measured/puppet.md)."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What a checkout can score beside files (`mimetic.commands.evaluate`)."""
    parser.description += WHAT_IS_SCORED
    parser.add_argument(
        "what",
        nargs="?",
        choices=(
            *("ablations", "abuse", "calibration", "capture", "characters", "consistency", "fit"),
            *("flow", "gaze", "head", "keys", "live", "locate", "puppet", "real", "rest"),
            *("retarget", "speech", "timing"),
        ),
        default="capture",
        help="what to score (default: capture)",
    )
    parser.add_argument(
        "--set",
        choices=("held-out", "tuning", "small", "real", *expressions.SETS),
        default="held-out",
        help="which rendered clips or images (default: held-out); locate, rest: real ones too; "
        "capture: full, many people beside peers; lips-and-air (docs/measured/evaluation.md)",
    )
    parser.add_argument(
        "--images", type=Path, help="locate: these images (docs/measured/finding-faces.md)"
    )
    parser.add_argument(
        "--eigenspaces",
        type=Path,
        help="locate: this model, not the installed one (scripts/train_eigenspaces)",
    )
    parser.add_argument(
        "--people", type=int, metavar="N", help="--set full, consistency: N of the people, evenly"
    )
    parser.add_argument(
        "--jobs", type=int, default=2, help="--set full: clips at once (default: 2)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        help="--set full, fit, head, locate, real: write figures here; consistency, real, timing: "
        "performances",
    )
    parser.add_argument(
        "--performances",
        type=Path,
        metavar="DIR",
        help="real, keys, live, puppet: score the performances that an earlier `real --out` left "
        "here; consistency, timing: that an earlier run of theirs with --out left here",
    )
    parser.add_argument(
        "--first-fit",
        action="store_true",
        help="real: fit the head to each marked frame and photograph alone, instead of capturing",
    )


def check(options: argparse.Namespace) -> None:
    """Raises InvalidInput if options do not go together."""
    if options.what != "locate":
        if options.images or options.eigenspaces:
            raise InvalidInput("--images and --eigenspaces go with `mimetic evaluate locate`")
        _check_set(options)
    if options.what != "capture":
        _refuse(options, *FILES)
    if options.performances and options.what not in SCORED_AGAIN:
        names = ", ".join(f"`{what}`" for what in SCORED_AGAIN)
        raise InvalidInput(f"--performances goes with `mimetic evaluate` {names}")
    if options.first_fit and (options.what != "real" or options.performances):
        raise InvalidInput("--first-fit goes with `mimetic evaluate real`, without --performances")
    files = any(getattr(options, name) for name in FILES)
    if options.set in expressions.SETS and (files or options.what in ("fit", "flow", "head")):
        raise InvalidInput(f"--set {options.set} goes with plain `mimetic evaluate`")
    if options.out and files:
        raise InvalidInput(WITH_OUT)


def run_tables(options: argparse.Namespace) -> int:
    """Prints the tables of what is to be scored; 0 when all went well. Options are checked."""
    run = {
        "locate": _run_locate,
        "calibration": _run_calibration,
        "characters": _run_characters,
        "consistency": _run_consistency,
        "ablations": _run_ablations,
        "abuse": _run_abuse,
        "real": _run_real,
        "rest": _run_rest,
        "gaze": partial(_run_by_clip, gaze, gaze.score_gaze),
        "speech": partial(_run_by_clip, speech, speech.score_speech),
        "head": _run_head,
        "fit": _run_fit,
        "flow": partial(_run_at_once, flow, flow.score_flow),
        "timing": _run_timing,
        "keys": _run_keys,
        "retarget": _run_retarget,
        "live": _run_live,
        "puppet": _run_puppet,
    }
    if options.what in run:
        return run[options.what](options)
    if options.set in expressions.SETS:
        return _run_expressions(options)
    if options.out:
        raise InvalidInput(WITH_OUT)
    tables = []
    for one in scored(options.set, to_stderr):
        tables.append(one)
        if not options.json:
            print(as_text(one), end="\n\n", flush=True)
    return _show(options, tables, as_json, summary)


def _run_expressions(options: argparse.Namespace) -> int:
    if options.jobs < 1 or (options.people is not None and options.people < 1):
        raise InvalidInput("--jobs and --people must be 1 or more")
    _prepare_out(options)
    clips, long = expressions.takes(options.set, options.people, to_stderr)
    python = face_mesh_python(to_stderr)
    scores, drifts = expressions.score_set(clips, long, python, to_stderr, options.jobs)
    if options.out is not None:
        with whole_file(options.out / "expressions.json") as stream:
            stream.write(f"{expression_tables.as_json(scores, drifts)}\n".encode())
    if options.json:
        print(expression_tables.as_json(scores, drifts))
    else:
        print(expression_tables.as_text(scores), expression_tables.drift_text(drifts), sep="\n\n")
    return 0


def _run_head(options: argparse.Namespace) -> int:
    _prepare_out(options)
    all_scores = []
    for scores in head.score_heads(options.set, to_stderr):
        all_scores += scores
        if not options.json:
            print(head.clip_text(scores), end="\n\n", flush=True)
    if options.out is not None:
        head.write(all_scores, options.out)
    return _show(options, all_scores, head.as_json, head.summary_text)


def _run_abuse(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    all_scores = []
    for scores in abuse.score_set(options.set, to_stderr):
        all_scores += scores
    return _show(options, all_scores, abuse.as_json, abuse.as_text)


def _run_at_once(which: ModuleType, score: Callable, options: argparse.Namespace) -> int:
    _refuse(options, "out")
    return _show(options, score(options.set, to_stderr), which.as_json, which.as_text)


def _run_rest(options: argparse.Namespace) -> int:
    which = real_rest if options.set == "real" else rest
    return _run_at_once(which, which.score_rest, options)


def _run_by_clip(which: ModuleType, score: Callable, options: argparse.Namespace) -> int:
    """A table a clip as soon as it is known, then one of them all."""
    _refuse(options, "out")
    _check_set_of(options, which.SETS)
    all_scores = []
    for scores in score(options.set, to_stderr):
        all_scores += scores
        if not options.json:
            print(which.clip_text(scores), end="\n\n", flush=True)
    return _show(options, all_scores, which.as_json, which.as_text)


def _run_characters(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    _check_set_of(options, characters.SETS)
    scores = list(characters.score_characters(options.set, to_stderr))
    return _show(options, scores, characters.as_json, characters.as_text)


def _run_consistency(options: argparse.Namespace) -> int:
    _check_set_of(options, consistency.SETS)
    _prepare_out(options)
    scores = consistency.score_consistency(
        options.set, options.people, options.out, options.performances, to_stderr
    )
    return _show(options, scores, consistency.as_json, consistency.as_text)


def _run_timing(options: argparse.Namespace) -> int:
    _check_set_of(options, timing.SETS)
    _prepare_out(options)
    scores = timing.score_timing(options.set, to_stderr, options.out, options.performances)
    return _show(options, scores, timing.as_json, timing.as_text)


def _run_keys(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    scores = list(keys.score_keys(to_stderr, options.performances))
    return _show(options, scores, keys.as_json, keys.as_text)


def _run_retarget(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    _check_set_of(options, retarget.SETS)
    scores = list(retarget.score_retargeting(options.set, to_stderr))
    return _show(options, scores, retarget.as_json, retarget.as_text)


def _run_live(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    scores = []
    for of_clip in live.score_live(to_stderr, options.performances):
        scores += of_clip
        if not options.json:
            print(live.as_text(of_clip), end="\n\n", flush=True)
    of_clips = live_taught.score_taught(to_stderr, options.performances)
    taught = [score for of_clip in of_clips for score in of_clip]
    still = live_still.score_still(to_stderr)
    if not options.json:
        print(live_taught.as_text(taught), end="\n\n", flush=True)
        print(live_still.as_text(still), end="\n\n", flush=True)
        print(live.speed_text(live.speed(to_stderr)))
    else:
        print(live.as_json([*scores, *taught, *still]))
    return 0


def _run_puppet(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    scores = puppet.score_puppet(to_stderr, options.performances)
    return _show(options, scores, puppet.as_json, puppet.as_text)


def _run_real(options: argparse.Namespace) -> int:
    _prepare_out(options)
    all_scores, all_sightings = [], []
    for scores, sightings in (
        real.score_fits(to_stderr)
        if options.first_fit
        else real.score_real(to_stderr, options.out, options.performances)
    ):
        all_scores += scores
        all_sightings += sightings
        if not options.json:
            print(real.clip_text(scores), end="\n\n", flush=True)
    if all_sightings and not options.json:
        print(noise_text(all_sightings))
    if options.out is not None:
        with whole_file(options.out / "real.json") as stream:
            stream.write(f"{real.as_json(all_scores)}\n".encode())
    if options.json:
        print(real.as_json(all_scores))
    return 0


def _run_ablations(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    scores = ablations.score_ablations(options.set, options.people, to_stderr)
    return _show(options, scores, ablations.as_json, ablations.as_text)


def _run_calibration(options: argparse.Namespace) -> int:
    _refuse(options, "out")
    scores = calibration.score_calibration(options.set, options.people, to_stderr)
    return _show(options, scores, calibration.as_json, calibration.as_text)


def _prepare_out(options: argparse.Namespace) -> None:
    """Raises before hours of work if --out cannot be written to."""
    if options.out is not None:
        prepare_folder(options.out, ())


def _refuse(options: argparse.Namespace, *names: str) -> None:
    """Raises InvalidInput if a path is given for which what is scored has no use."""
    if any(getattr(options, name) for name in names):
        options_text = " and ".join(f"--{name}" for name in names)
        raise InvalidInput(f"{options_text} do not go with `{options.what}`")


def _show(
    options: argparse.Namespace,
    scores: Any,
    as_json: Callable[[Any], str],
    as_text: Callable[[Any], str],
) -> int:
    """Prints what was scored in the form that is asked for; the exit status."""
    print(as_json(scores) if options.json else as_text(scores))
    return 0


def _check_set_of(options: argparse.Namespace, sets: Collection[str]) -> None:
    """Raises InvalidInput on a set that what is scored does not have."""
    if options.set not in sets:
        raise InvalidInput(f"--set {options.set} does not go with `{options.what}`")


def _check_set(options: argparse.Namespace) -> None:
    is_of_many = options.set in expressions.SETS or options.what == "consistency"
    if options.people is not None and not is_of_many:
        raise InvalidInput("--people goes with --set full and `consistency`")
    if options.set == "real" and options.what != "rest":
        raise InvalidInput("--set real goes with `mimetic evaluate locate` and `rest`")


def _run_locate(options: argparse.Namespace) -> int:
    _prepare_out(options)
    if options.images is not None:
        images = Stills.load(options.images)
    else:
        images = rendered_stills(options.set, to_stderr)
    spaces = load(options.eigenspaces) if options.eigenspaces else installed_spaces()
    scores = locate.score_finders(images, spaces)
    if options.out is not None:
        locate.write(scores, options.out)
    return _show(options, scores, locate.as_json, locate.as_text)


def _run_fit(options: argparse.Namespace) -> int:
    _prepare_out(options)
    template = load_template()
    scores = fit.score_fits(rendered_portraits(options.set, template, to_stderr), template)
    if options.out is not None:
        fit.write(scores, options.out)
    return _show(options, scores, fit.as_json, fit.as_text)
