# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that a page names is one, with options that it has, by the parsers themselves."""

from __future__ import annotations

import argparse
import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest
from manual_pages import ROOT, TRUE_TODAY, code_lines, code_spans, name_of
from mimetic.commands import cli

CALL = re.compile(r"(?:^|(?<=[\s(\"'/]))(?:\./)?(?:scripts/)?mimetic(?= [a-z-])(?P<words>[^#]*)")
SCRIPT = re.compile(r"(?:\./)?(?P<script>scripts/[a-z_]*[a-z])(?![a-z_])(?P<words>(?: [^#)]*)?)")
MODULE = re.compile(r"python -m (?P<module>evaluation[a-z_.]*)(?P<words>[^#]*)")
# In `[--fast]` and `--model a|b` the page says what may be given
SAYS_WHAT_MAY_BE = re.compile(r"[\[\]|…]|\.\.\.|\b[A-Z]{3,}\b")


def commands(page: Path) -> list[str]:
    return [*code_lines(page), *code_spans(page)]


def calls(page: Path) -> list[list[str]]:
    """The words after `mimetic` of each call on the page."""
    texts = [call["words"] for text in commands(page) for call in CALL.finditer(text)]
    return [words_of(text) for text in texts]


def words_of(text: str) -> list[str]:
    plain = re.split(r"&&|;|\s[<>]\s|→|\\\|", text)[0]
    with contextlib.suppress(ValueError):
        return shlex.split(plain)
    return plain.split()


def parsers_on_the_way(words: list[str]) -> tuple[list[argparse.ArgumentParser], list[str]]:
    """The parser and sub-parsers that the words lead through, and the words after them."""
    parser = cli._make_parser(words)
    way, rest = [parser], list(words)
    while rest and not rest[0].startswith("-"):
        choices = [
            action.choices
            for action in way[-1]._actions
            if isinstance(action, argparse._SubParsersAction)
        ]
        names = rest[0].split("|")
        if not choices or not all(name in choices[0] for name in names):
            break
        way.append(choices[0][names[0]])
        rest = rest[1:]
    return way, rest


def trouble(words: list[str]) -> str:
    """What is wrong with a call of `mimetic`, or nothing."""
    if words[0].startswith("-"):
        return "" if words[0] in ("--help", "--version") else f"no option {words[0]}"
    way, rest = parsers_on_the_way(words)
    if len(way) == 1:
        return f"no command {words[0]}"
    options = {option for parser in way for option in parser._option_string_actions}
    for word in rest:
        option = word.strip("[]().,").split("=")[0]
        if re.fullmatch(r"--[a-z][a-z-]*", option) and option not in options:
            return f"{words[0]} has no option {option}"
    return ""


@pytest.mark.parametrize("page", TRUE_TODAY, ids=name_of)
def test_calls_name_commands_and_options_that_are(page):
    wrong = {" ".join(words): trouble(words) for words in calls(page) if trouble(words)}
    assert wrong == {}


@pytest.mark.parametrize("page", TRUE_TODAY, ids=name_of)
def test_calls_in_blocks_of_code_are_taken_whole(page):
    """What can be copied is parsed as it stands: too few or too many words fail too."""
    wrong = {}
    for line in code_lines(page):
        for call in CALL.finditer(line):
            words = words_of(call["words"])
            if SAYS_WHAT_MAY_BE.search(call["words"]) or "--help" in words:
                continue
            message = io.StringIO()
            try:
                with contextlib.redirect_stderr(message):
                    cli.options_of(words)
            except SystemExit:
                wrong[line] = message.getvalue().splitlines()[-1]
    assert wrong == {}


def test_a_wrong_call_is_noticed():
    assert trouble(["capture", "clip.mp4", "--outt", "out"]) == "capture has no option --outt"
    assert trouble(["captures", "clip.mp4"]) == "no command captures"
    assert trouble(["puppet", "teach", "--lag", "1"]) == "puppet has no option --lag"
    assert trouble(["puppet", "teach|run"]) == ""


@pytest.mark.parametrize("page", TRUE_TODAY, ids=name_of)
def test_scripts_are_there_and_know_their_options(page):
    wrong = []
    for text in commands(page):
        for call in SCRIPT.finditer(text):
            script = ROOT / call["script"]
            if script.name == "mimetic" or script.is_dir():
                continue
            if not script.is_file() or not script.stat().st_mode & 0o100:
                wrong.append(f"{call['script']} is no script")
                continue
            source = script.read_text(encoding="utf-8") + "".join(
                part.read_text(encoding="utf-8") for part in built_by(script)
            )
            named = re.findall(r"(?<!\S)\[?(--[a-z][a-z-]*)", call["words"].split(" -m ")[0])
            wrong += [f"{call['script']} has no {name}" for name in named if name not in source]
    assert wrong == []


def built_by(script: Path) -> list[Path]:
    """Sources that the script calls: what it names under scripts/build, in Python or as a path."""
    text = script.read_text(encoding="utf-8")
    folders = ROOT / "scripts" / "build", ROOT / "evaluation"
    return [
        path for folder in folders for path in sorted(folder.rglob("*.py")) if path.stem in text
    ]


@pytest.mark.parametrize("page", TRUE_TODAY, ids=name_of)
def test_modules_that_are_run_are_there_with_their_options(page):
    wrong = []
    for line in commands(page):
        for call in MODULE.finditer(line):
            path = ROOT / Path(*call["module"].rstrip(".").split("."))
            sources = [path.with_suffix(".py"), *path.glob("*.py")]
            sources = [source for source in sources if source.is_file()]
            text = "".join(source.read_text(encoding="utf-8") for source in sources)
            if "__main__" not in text and path / "__main__.py" not in sources:
                wrong.append(f"{call['module']} cannot be run")
            named = re.findall(r"(?<!\S)\[?(--[a-z][a-z-]*)", call["words"])
            wrong += [f"{call['module']} has no {name}" for name in named if name not in text]
    assert wrong == []


def test_every_command_and_its_options_are_in_the_manual():
    """Each command has a page that names it; each of its options stands on a page of the manual."""
    text = "\n".join(page.read_text(encoding="utf-8") for page in TRUE_TODAY)
    missing = []
    for name in cli.COMMANDS:
        for command in every_parser(cli._make_parser([name]), name):
            if f"mimetic {command.prog.removeprefix('mimetic ')}" not in text:
                missing.append(command.prog)
            missing += [
                f"{command.prog} {action.option_strings[-1]}"
                for action in command._actions
                if action.help != argparse.SUPPRESS  # for programs that call it, not people
                and action.option_strings
                and action.option_strings[-1] not in text
            ]
    assert missing == []


def every_parser(parser: argparse.ArgumentParser, name: str) -> list[argparse.ArgumentParser]:
    """The parser of a command and those of its own commands."""
    parsers = []
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for word, child in action.choices.items():
                if parser.prog != "mimetic" or word == name:
                    parsers += [child, *every_parser(child, name)]
    return parsers
