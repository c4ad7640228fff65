# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders clips and prints one line for each: name, footage, truth, separated by tabs."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from functools import partial
from pathlib import Path

from mimetic.template.face_template import load_template

from evaluation.progress import to_stderr

from .abuse.films import abused_clip
from .abuse.recipes import SETS as ABUSE
from .clips import CannotRender, Clip, clip
from .expressions.films import long_clip, take_clip
from .expressions.recipes import SETS as EXPRESSIONS
from .expressions.recipes import some_of
from .gaze.films import gaze_clip
from .gaze.recipes import SETS as GAZES
from .heads.films import head_clip
from .heads.recipes import SETS as HEADS
from .photographs.real import real_stills
from .portraits.portrait_set import SETS as PORTRAITS
from .portraits.portrait_set import portraits
from .recipes import ALL, SETS
from .rest.films import shown_clips
from .rest.recipes import SETS as RESTS
from .speech.films import speech_clip
from .speech.recipes import SETS as SPEECHES
from .stills.image_set import SETS as STILLS
from .stills.image_set import stills

REAL = "real"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="render_truth", description="Render heads that move in a known way."
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--set", choices=SETS, default="held-out", help="default: held-out")
    which.add_argument("--small", action="store_true", help="the clips of the tests and the demo")
    which.add_argument("--name", choices=ALL, action="append", help="these alone")
    which.add_argument(
        "--stills", choices=[*STILLS, REAL], help="still images, not clips; prints the .npz"
    )
    which.add_argument("--heads", choices=HEADS, help="heads that turn; prints kind, name, paths")
    which.add_argument("--abuse", choices=ABUSE, help="faces covered, cut, darkened; see --heads")
    which.add_argument("--expressions", choices=EXPRESSIONS, help="nine expressions by many people")
    which.add_argument("--portraits", choices=PORTRAITS, help="portraits; prints the .npz")
    which.add_argument("--gaze", choices=GAZES, help="people who look about; prints paths")
    which.add_argument("--speech", choices=SPEECHES, help="people who speak and wink; prints paths")
    which.add_argument("--rest", choices=RESTS, help="short clips, at rest first or last")
    parser.add_argument("--people", type=int, help="with --expressions: so many, evenly chosen")
    parser.add_argument("--out", type=Path, help="copy the clips into this folder")
    options = parser.parse_args(arguments)
    recipes = SETS["small" if options.small else options.set]
    if options.name:
        recipes = [ALL[name] for name in options.name]
    try:
        template = load_template()
        if options.stills:
            made = (
                real_stills if options.stills == REAL else partial(stills, options.stills, template)
            )
            print(made(to_stderr))
            return 0
        for name, (sets, print_clips) in PRINTED.items():
            if chosen := getattr(options, name):
                print_clips(sets[chosen], template)
                return 0
        if options.portraits:
            print(portraits(options.portraits, template, to_stderr))
            return 0
        if options.expressions:
            _print_takes(some_of(EXPRESSIONS[options.expressions], options.people), template)
            return 0
        for recipe in recipes:
            made = clip(recipe, template, to_stderr)
            if options.out:
                made = _copied(made, options.out)
            print(made.name, made.footage, made.truth, sep="\t", flush=True)
    except (CannotRender, OSError, ValueError) as error:
        print(f"render_truth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _print_heads(clips, template) -> None:
    for wanted in clips:
        head = head_clip(wanted, template, to_stderr)
        print(wanted.kind, wanted.name, head.footage, head.truth, sep="\t", flush=True)


def _print_gazes(clips, template) -> None:
    """Width of the eyes, what the head and the eyes do, name and paths of each clip."""
    for looking in clips:
        made = gaze_clip(looking, template, to_stderr)
        row = (looking.eye_px, looking.head, looking.gaze)
        print(*row, made.name, made.footage, made.truth, sep="\t", flush=True)


def _print_speeches(clips, template) -> None:
    """What the head does, name and paths of each clip."""
    for spoken in clips:
        made = speech_clip(spoken, template, to_stderr)
        print(spoken.head, made.name, made.footage, made.truth, sep="\t", flush=True)


def _print_rests(people, template) -> None:
    for person in people:
        for shown in shown_clips(person, template, to_stderr):
            print(shown.kind, shown.name, shown.footage, shown.truth, sep="\t", flush=True)


def _print_takes(takes, template) -> None:
    """Kind, the head's motion and the paths of each take; at last the long clip of the first."""
    for number, take in enumerate(takes):
        made = take_clip(take, template, to_stderr)
        row = (take.recipe.kind, take.head, made.name, made.footage, made.truth)
        print(*row, sep="\t", flush=True)
        if number == 0:
            long = long_clip(take, template, to_stderr)
    print("long", takes[0].head, long.name, long.footage, long.truth, sep="\t", flush=True)


def _print_abused(clips, template) -> None:
    """Kind, source, which side the reference frame is on, and the paths of each clip."""
    for wanted in clips:
        made = abused_clip(wanted, template, to_stderr)
        side = "later" if wanted.later else "earlier"
        row = (wanted.kind, wanted.source.name, side, made.footage, made.clean, made.truth)
        print(*row, sep="\t", flush=True)


def _copied(made: Clip, folder: Path) -> Clip:
    folder.mkdir(parents=True, exist_ok=True)
    for path in (made.footage, made.truth):
        aside = folder / f".{path.name}.{os.getpid()}.part"  # another may copy the same
        shutil.copyfile(path, aside)
        aside.replace(folder / path.name)
    return Clip(made.name, folder / made.footage.name, folder / made.truth.name)


# By the option that names one of its sets
PRINTED = {
    "heads": (HEADS, _print_heads),
    "abuse": (ABUSE, _print_abused),
    "rest": (RESTS, _print_rests),
    "gaze": (GAZES, _print_gazes),
    "speech": (SPEECHES, _print_speeches),
}


if __name__ == "__main__":
    sys.exit(main())
