# SPDX-License-Identifier: GPL-3.0-or-later
"""What the sources say to users when something is wrong, and whether docs/guide/messages.md has it.

The package's and the extension's messages are read by `ast`, the core's by what it throws. A value
in a message is `…`; on the page `…` stands for anything, so one line can be of several messages.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from message_texts import LEAST_LETTERS, Sources, files_of, letters, plain, texts

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "native" / "python" / "mimetic"
ADDON = ROOT / "blender_addon" / "mimetic"
CORE = ROOT / "native" / "src"
ERRORS = {
    *("InvalidInput", "UnreadableMedia", "NoFace", "NothingSeen", "ArgumentTypeError"),
    "invalid_input",
}
LISTS = ("warnings", "notes", "remarks")
LEAST_OF_A_LINE, MOST_OF_A_LINE = (
    4,
    30,
)  # letters of a line of the page; messages that it stands for


@dataclass(frozen=True)
class Message:
    text: str
    source: str


@cache
def messages() -> list[Message]:
    """All of them, each text once."""
    every = [*_of_python(PACKAGE), *_of_python(ADDON), *_of_core()]
    once = {message.text: message for message in reversed(every)}
    return [message for message in dict.fromkeys(every) if once[message.text] == message]


def missing(page: str) -> list[Message]:
    patterns = [_pattern(line) for line in lines(page)]
    return [
        message
        for message in messages()
        if not any(pattern.fullmatch(message.text) for pattern in patterns)
    ]


def unused(page: str) -> list[str]:
    """Lines of the page that no message is like any more, or that stand for too many."""
    texts = [message.text for message in messages()]
    alike = {
        line: sum(1 for text in texts if _pattern(line).fullmatch(text)) for line in lines(page)
    }
    return [
        line
        for line, count in alike.items()
        if letters(line) < LEAST_OF_A_LINE or not 1 <= count <= MOST_OF_A_LINE
    ]


def lines(page: str) -> list[str]:
    """The messages that the page lists: what stands in backticks at the start of a table's row."""
    return [plain(line) for line in re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE)]


def _pattern(line: str) -> re.Pattern[str]:
    return re.compile(".*".join(re.escape(part) for part in line.split("…")))


def _of_python(folder: Path) -> list[Message]:
    found = []
    trees = files_of(folder)
    sources = Sources.of(trees.values())
    for path, tree in trees.items():
        name = path.relative_to(ROOT).as_posix()
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                for said in said_by(function, is_addon=folder == ADDON):
                    for text in texts(said, function, sources):
                        if letters(plain(text)) >= LEAST_LETTERS:
                            found.append(Message(plain(text), f"{name}:{said.lineno}"))
    return found


def said_by(function: ast.FunctionDef, is_addon: bool) -> list[ast.expr]:
    """Expressions that are messages: of errors, of warnings, of why a button is grey."""
    said: list[ast.expr] = []
    is_reason = function.name.startswith(("no_", "obstacle", "busy", "problem", "_no_"))
    for node in ast.walk(function):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            if _name(node.exc.func) in ERRORS:
                said += node.exc.args[:1]
        elif isinstance(node, ast.Call) and _is_warning(node.func):
            said += node.args[:1]
        elif isinstance(node, (ast.Assign, ast.AugAssign)) and _is_of_lists(node):
            said += node.value.elts if isinstance(node.value, ast.List) else [node.value]
        elif isinstance(node, ast.Call) and is_addon:
            level = ast.unparse(node.args[0]) if node.args else ""
            if _name(node.func) == "cancelled":
                said += node.args[2:3]
            elif _name(node.func) == "report" and "INFO" not in level:
                said += node.args[1:2]
        elif is_addon and is_reason and isinstance(node, ast.Return) and node.value:
            said.append(node.value)
    return said


def _is_of_lists(node: ast.Assign | ast.AugAssign) -> bool:
    """Whether it says what a list of notes is given: not where lists are merely joined."""
    if isinstance(node, ast.AugAssign):
        return _name(node.target) in LISTS
    return _name(node.targets[0]) in LISTS and isinstance(node.value, ast.List)


def _is_warning(called: ast.expr) -> bool:
    """Of `warnings.warn`, of `_warn`, and of what adds to a list of warnings, notes or remarks."""
    return isinstance(called, ast.Attribute) and (
        called.attr in ("warn", "_warn")
        or (called.attr == "append" and _name(called.value) in LISTS)
    )


def _name(called: ast.expr) -> str:
    return called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")


def _of_core() -> list[Message]:
    """What the core throws with an advice: the rest is about arrays that Python code hands it."""
    texts = []
    for path in sorted(CORE.rglob("*.cpp")):
        source = path.read_text(encoding="utf-8")
        for start in re.finditer(r"throw\s+(InvalidInput|UnreadableMedia)\s*\(", source):
            text = plain(_concatenated(source, start.end()))
            if re.search(r"[:;] [a-z]{3}", text) and letters(text) >= LEAST_LETTERS:
                line = source.count("\n", 0, start.start()) + 1
                texts.append(Message(text, f"{path.relative_to(ROOT).as_posix()}:{line}"))
    return texts


def _concatenated(source: str, start: int) -> str:
    """The literals of a C++ expression up to its closing bracket, what is between them as `…`."""
    text, depth, i = "", 1, start
    while depth:
        if literal := re.compile(r'"((?:[^"\\]|\\.)*)"').match(source, i):
            text += literal[1]
            i = literal.end()
            continue
        depth += (source[i] in "({") - (source[i] in ")}")
        if depth and not source[i].isspace() and not text.endswith("…"):
            text += "…"
        i += 1
    return text
