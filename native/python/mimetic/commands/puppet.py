# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet WORD ...`: a face that drives another while it is filmed."""

from __future__ import annotations

import argparse
import importlib

# word: (module with add_arguments(parser) and run_<word>(arguments) -> status, summary)
WORDS = {
    "teach": (
        "mimetic.commands.puppet_teach",
        "looks of a captured clip -> a taught set: templates, and which are hard to tell apart",
    ),
    "run": (
        "mimetic.commands.puppet_run",
        "a clip and a taught set -> a driven face: performance, video, figures, page",
    ),
    "record": (
        "mimetic.commands.puppet_record",
        "a camera, or a clip in its place -> performance.npz while it plays, sent elsewhere too",
    ),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    words = parser.add_subparsers(dest="word", required=True, metavar="WORD")
    for name, (module_name, summary) in WORDS.items():
        module = importlib.import_module(module_name)
        word = words.add_parser(
            name, help=summary, description=f"{summary[0].upper()}{summary[1:]}."
        )
        module.add_arguments(word)
        word.set_defaults(run_word=getattr(module, f"run_{name}"))


def run_puppet(arguments: argparse.Namespace) -> int:
    return arguments.run_word(arguments)
