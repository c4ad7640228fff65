# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of all commands, written by their own parsers."""

from __future__ import annotations

import argparse
import os
import re

from mimetic.commands import cli

# Where more is said of a command than its options
PAGES = {
    "capture": ["fitting.md", "filming.md", "../performance-file.md"],
    "fit": ["fitting.md", "../fit-file.md"],
    "calibrate": ["calibration.md"],
    "head": ["head-tracking.md"],
    "bake": ["own-controls.md", "control-object.md", "comparison.md"],
    "shapes": ["skin-and-muscles.md"],
    "analyse": ["timing.md"],
    "compare": ["comparison.md"],
    "library": ["expressions.md", "../expression-file.md"],
    "puppet": ["live.md", "puppet.md", "../puppet-file.md"],
    "evaluate": ["../measured/evaluation.md", "../measured/scores.md", "../truth-file.md"],
    "batch": ["batch.md"],
    "info": ["../performance-file.md"],
}
BEGINNING = """\
# Commands

Every command and every option. `scripts/make_manual` writes this page from the program itself, so
that it says what `mimetic COMMAND --help` says. From a checkout a command is `./scripts/mimetic
…`; from the wheel, `mimetic …`.

Units are seconds, metres, radians and pixels unless an option names another; frames count from 1,
and `A:B` is from A up to and with B. A pixel's X goes right and its Y down from the middle of the
picture's top left pixel. Files that a command reads are never changed.
An activation lies between 0 (at rest) and 1 (all that the muscle can do).

| exit status | what it means |
| --- | --- |
| 0 | done |
| 1 | failed: the disk is full, memory ran out, Blender ended badly |
| 2 | what was given is wrong; one line says what, where, what to do ([messages](messages.md)) |
| 130, 143, 129 | ended by Ctrl-C, SIGTERM, a closed terminal; the finished part is kept |

What footage can be: one video file with pictures of 16 to 16384
pixels a side, in any format that ffmpeg reads, with one face seen from the front to about three
quarters, at least an eighth of the picture high ([filming.md](filming.md)).
"""


def page() -> str:
    parts = [BEGINNING]
    for name, (_, summary) in cli.COMMANDS.items():
        parser = subparsers(cli._make_parser([name]))[name]
        parts.append(f"## mimetic {name}\n\n{sentence(summary)}{more(name)}\n")
        parts += described(parser, name)
    return "\n".join(parts)


def more(name: str) -> str:
    links = [f"[{os.path.basename(page)}]({page})" for page in PAGES.get(name, [])]
    return f" More: {', '.join(links)}." if links else ""


def described(parser: argparse.ArgumentParser, name: str) -> list[str]:
    children = subparsers(parser)
    own = [action for action in parser._actions if not is_own(action)]
    parts = [table(own)] if own else []
    helps = {
        choice.dest: choice.help or ""
        for action in parser._actions
        if isinstance(action, argparse._SubParsersAction)
        for choice in action._choices_actions
    }
    for word, child in children.items():
        parts.append(f"### mimetic {name} {word}\n\n{sentence(helps.get(word, ''))}\n")
        parts += described(child, f"{name} {word}")
    return parts


def subparsers(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return dict(action.choices)
    return {}


def is_own(action: argparse.Action) -> bool:
    """What argparse needs for itself, or programs call and nobody types."""
    is_hidden = action.help == argparse.SUPPRESS
    return is_hidden or isinstance(action, (argparse._SubParsersAction, argparse._HelpAction))


def table(actions: list[argparse.Action]) -> str:
    rows = ["| what | needed | what it is |", "| --- | --- | --- |"]
    for action in actions:
        needed = "yes" if action.required and action.nargs not in ("*", "?") else ""
        text = (action.help or "").replace("|", "\\|").replace("%%", "%")
        if "%(default)" in text:
            text = text % {"default": action.default}
        rows.append(f"| {called(action)} | {needed} | {shown(text)} |")
    return "\n".join(rows) + "\n"


def called(action: argparse.Action) -> str:
    choices = action.choices and ", ".join(map(str, action.choices))
    # The first in full: what follows are older names
    full = [name for name in action.option_strings if name.startswith("--")]
    name = next(iter(full or action.option_strings), "")
    value = "" if action.nargs == 0 else value_of(action)
    text = " ".join(part for part in (name, value) if part)
    return f"`{text}`" + (f": {choices}" if choices and not action.option_strings else "")


def value_of(action: argparse.Action) -> str:
    if action.choices:
        return (
            "{" + ",".join(map(str, action.choices)) + "}" if action.option_strings else action.dest
        )
    one = action.metavar if isinstance(action.metavar, str) else action.dest.upper()
    return {"?": f"[{one}]", "+": f"{one} [{one} ...]", "*": f"[{one} ...]"}.get(
        str(action.nargs), one
    )


def sentence(text: str) -> str:
    """A summary as a sentence."""
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def shown(text: str) -> str:
    """Underscores and angles as they are, and no number of this machine's cores."""
    return re.sub(r"(one a core), \d+ here", r"\1", text).replace("<", "&lt;")
