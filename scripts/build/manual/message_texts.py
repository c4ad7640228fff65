# SPDX-License-Identifier: GPL-3.0-or-later
"""What an expression of the sources can say: literals, and what names, tables and calls stand for.

A value in a text is `…`, unless hardly a word would be left: then it is followed too.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice, product
from pathlib import Path
from string import Formatter

LEAST_LETTERS = 9  # of a message that can be looked up
DEEPEST = 6  # calls and names followed one after another
MOST_WAYS = 60  # that the values of one text are put together
RELAYS = ("str", "shortened", "shown", "list", "tuple", "sorted", "reversed", "filter")
TRANSLATIONS = ("iface_", "rpt_")  # of the text that they are given first
OF_TEXTS = ("replace", "strip", "lower", "capitalize", "removesuffix", "removeprefix", "rstrip")
# Attributes that hold nothing but what a user is told
SAYINGS = ("remark", "remarks", "notes", "problem", "guess")


class Column(ast.expr):
    """The parts at one place of all rows of a table: what a loop over it gives a name."""

    _fields = ("table", "place")


@dataclass
class Sources:
    """Functions, constants and what is given to sayings in a folder's files, by name."""

    functions: dict[str, list[ast.FunctionDef]] = field(default_factory=dict)
    constants: dict[str, list[ast.expr]] = field(default_factory=dict)
    # Of the file that a function is in: they go before those of other files
    own_constants: dict[ast.AST, dict[str, list[ast.expr]]] = field(default_factory=dict)
    sayings: dict[str, list[tuple[ast.expr, ast.AST]]] = field(default_factory=dict)

    @classmethod
    def of(cls, trees: Iterable[ast.Module]) -> Sources:
        sources = cls()
        for tree in trees:
            sources.add(tree)
        return sources

    def add(self, tree: ast.Module) -> None:
        own: dict[str, list[ast.expr]] = {}
        for line in tree.body:
            for name, given in _assigned(line):
                own.setdefault(name, []).append(given)
                self.constants.setdefault(name, []).append(given)
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                self.own_constants[function] = own
                self.functions.setdefault(function.name, []).append(function)
                for name, given in _sayings(function):
                    self.sayings.setdefault(name, []).append((given, function))


def files_of(folder: Path) -> dict[Path, ast.Module]:
    return {
        path: ast.parse(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.py"))
    }


def plain(text: str) -> str:
    """As it is compared: a value, also one that a template still names, is `…`."""
    text = re.sub(r"\{[a-z]\w*(:[^{}]*)?\}", "…", text.replace("`", "").replace("\\|", "|"))
    return " ".join(re.sub("…(…| …)+", "…", text).split())


def letters(text: str) -> int:
    return len(re.findall(r"[A-Za-z]", text))


def texts(node: ast.expr, function: ast.AST, sources: Sources, depth: int = 0) -> list[str]:
    """What the expression can say; nothing where that is known to the program alone.

    function: the one that it stands in, whose assignments and loops give its names.
    """
    if depth > DEEPEST:
        return []

    def follow(one: ast.expr) -> list[str]:
        return texts(one, function, sources, depth)

    match node:
        case ast.Constant(value=str(text)):
            return [text]
        case ast.JoinedStr():
            return _formatted(node, function, sources, depth)
        case ast.BinOp(op=ast.Add()):
            left, right = follow(node.left) or ["…"], follow(node.right) or ["…"]
            return [one + other for one in left for other in right]
        case ast.IfExp():
            return [*follow(node.body), *follow(node.orelse)]
        case ast.BoolOp():
            return _all(node.values, follow)
        case ast.Tuple() | ast.List() | ast.Set():
            return _all(node.elts, follow)
        case ast.Dict():
            return _all(node.values, follow)
        case ast.ListComp() | ast.GeneratorExp():
            return follow(node.elt)
        case ast.Starred() | ast.Subscript() | ast.NamedExpr():
            return follow(node.value)
        case Column():
            rows = _rows(node.table, function, sources)
            return _all(
                [row.elts[node.place] for row in rows if node.place < len(row.elts)], follow
            )
        case ast.Name():
            return _named(node.id, node.lineno, function, sources, depth)
        case ast.Attribute() if node.attr.isupper():
            return _named(node.attr, 0, ast.Module([], []), sources, depth)
        case ast.Attribute() if node.attr in SAYINGS and depth == 0:
            given = sources.sayings.get(node.attr, ())
            return [text for one, where in given for text in texts(one, where, sources, depth + 1)]
        case ast.Call():
            return _called(node, function, sources, depth)
    return []


def _all(nodes: Iterable[ast.expr], follow) -> list[str]:
    return [text for one in nodes for text in follow(one)]


def _formatted(node: ast.JoinedStr, function: ast.AST, sources: Sources, depth: int) -> list[str]:
    parts = [
        str(part.value) if isinstance(part, ast.Constant) else part.value
        for part in node.values
        if isinstance(part, (ast.Constant, ast.FormattedValue))
    ]
    return _put_together(parts, function, sources, depth)


def _filled(
    template: str, node: ast.Call, function: ast.AST, sources: Sources, depth: int
) -> list[str]:
    """A template with what `format` is given for its fields."""
    given = {keyword.arg: keyword.value for keyword in node.keywords}
    parts: list[str | ast.expr] = []
    for text, name, _, _ in Formatter().parse(template):
        parts.append(text)
        if name is not None:
            parts.append(given.get(name, "…"))
    return _put_together(parts, function, sources, depth)


def _put_together(
    parts: list[str | ast.expr], function: ast.AST, sources: Sources, depth: int
) -> list[str]:
    """Words and values; the values are followed where hardly a word would be left without them."""
    text = "".join(part if isinstance(part, str) else "…" for part in parts)
    if letters(plain(text)) >= LEAST_LETTERS:
        return [text]
    ways = [
        [part] if isinstance(part, str) else texts(part, function, sources, depth + 1) or ["…"]
        for part in parts
    ]
    return ["".join(way) for way in islice(product(*ways), MOST_WAYS)]


def _named(name: str, line: int, function: ast.AST, sources: Sources, depth: int) -> list[str]:
    """Of what a name was given in its function, what stands above the line that reads it."""
    given = _given(name, function, sources)
    above = [pair for pair in given if getattr(pair[0], "lineno", 0) <= line]
    return [
        text
        for one, where in above or given
        if name not in {part.id for part in ast.walk(one) if isinstance(part, ast.Name)}
        for text in texts(one, where, sources, depth + 1)
    ]


def _given(name: str, function: ast.AST, sources: Sources) -> list[tuple[ast.expr, ast.AST]]:
    """What a name stands for, and where: by the lines of its function, or as a constant."""
    own = [one for line in ast.walk(function) for other, one in _assigned(line) if other == name]
    if own:
        return [(one, function) for one in own]
    constants = sources.own_constants.get(function, {}).get(name) or sources.constants.get(name, [])
    return [(one, function) for one in constants]


def _rows(table: ast.expr, function: ast.AST, sources: Sources) -> list[ast.Tuple]:
    """Rows of a table that is written down somewhere, those of a dict as (key, value)."""
    if isinstance(table, ast.Call) and isinstance(table.func, ast.Attribute):
        return _rows(table.func.value, function, sources) if table.func.attr == "items" else []
    if isinstance(table, (ast.Name, ast.Attribute)):
        name = table.id if isinstance(table, ast.Name) else table.attr
        given = [one for one, _ in _given(name, function, sources)]
        tables = [one for one in given if isinstance(one, (ast.Tuple, ast.List, ast.Dict))]
        return [row for one in tables for row in _rows(one, function, sources)]
    if isinstance(table, ast.Dict):
        pairs = zip(table.keys, table.values, strict=True)
        return [ast.Tuple([key or ast.Constant(""), one], ast.Load()) for key, one in pairs]
    if isinstance(table, (ast.Tuple, ast.List)):
        return [row for row in table.elts if isinstance(row, ast.Tuple)]
    return []


def _called(node: ast.Call, function: ast.AST, sources: Sources, depth: int) -> list[str]:
    called = node.func
    name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
    if name in TRANSLATIONS:
        return texts(node.args[0], function, sources, depth)
    if name in RELAYS or name[:1].isupper():
        return [text for part in node.args for text in texts(part, function, sources, depth + 1)]
    if isinstance(called, ast.Attribute) and name == "join":
        return texts(node.args[0], function, sources, depth + 1)
    if isinstance(called, ast.Attribute) and name == "format":
        own = texts(called.value, function, sources, depth)
        return [text for one in own for text in _filled(one, node, function, sources, depth)]
    if isinstance(called, ast.Attribute) and name in OF_TEXTS:
        return texts(called.value, function, sources, depth)
    if isinstance(called, ast.Attribute) and name in ("get", "items", "values"):
        return texts(called.value, function, sources, depth)
    return [
        text
        for other in sources.functions.get(name, ())
        for line in ast.walk(other)
        if isinstance(line, ast.Return) and line.value
        for text in texts(line.value, other, sources, depth + 1)
    ]


def _assigned(line: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Names that a line gives, each with what: by `=`, `+=`, `:=`, a loop or `append`."""
    match line:
        case ast.Assign():
            yield from _unpacked(line.targets[0], line.value)
        case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as given):
            yield name, given
        case ast.AugAssign(target=ast.Name(id=name)):
            yield name, line.value
        case ast.NamedExpr(target=ast.Name(id=name)):
            yield name, line.value
        case ast.For(target=ast.Tuple()) | ast.comprehension(target=ast.Tuple()):
            for place, one in enumerate(line.target.elts):
                if isinstance(one, ast.Name):
                    yield one.id, Column(table=line.iter, place=place)
        case ast.For(target=ast.Name(id=name)) | ast.comprehension(target=ast.Name(id=name)):
            yield name, line.iter
        case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="append")):
            yield name, line.args[0]


def _unpacked(target: ast.expr, given: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    """Names of a target; of a tuple each with its own part, where the parts are written down."""
    if isinstance(target, ast.Name):
        yield target.id, given
    elif isinstance(target, (ast.Tuple, ast.List)):
        is_written = isinstance(given, (ast.Tuple, ast.List)) and len(given.elts) == len(
            target.elts
        )
        parts = given.elts if is_written else [given] * len(target.elts)
        for one, part in zip(target.elts, parts, strict=True):
            yield from _unpacked(one, part)


def _sayings(function: ast.FunctionDef) -> Iterator[tuple[str, ast.expr]]:
    """What a function gives to attributes that hold nothing but sayings."""
    for node in ast.walk(function):
        if isinstance(node, ast.keyword) and node.arg in SAYINGS:
            yield node.arg, node.value
        elif isinstance(node, ast.Assign):
            target = node.targets[0]
            if isinstance(target, ast.Attribute) and target.attr in SAYINGS:
                yield target.attr, node.value
