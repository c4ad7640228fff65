# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of the extension can be translated: what is put together of words and values is a template
that is looked up whole, `iface_("{name} is missing").format(name=...)`, never an f-string."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest

ADDON = Path(__file__).resolve().parents[2] / "blender_addon" / "mimetic"
# What `mimetic bake` says on a terminal, of whose words none are translated
OF_COMMANDS = {
    *("scene_out/asset_file.py", "scene_out/new_file.py"),
    *("scene_out/rig_file.py", "scene_out/shapes_file.py"),
}
FILES = [
    path
    for path in sorted(ADDON.rglob("*.py"))
    if path.relative_to(ADDON).as_posix() not in OF_COMMANDS
]
# Texts that a file keeps, and one that Blender itself looks up whole
KEPT = ("A motion of … s", "… of … muscles and articulators…", "The target's face looks along …")
TRANSLATIONS = ("iface_", "rpt_")
# Calls that show a text to the user: the place of its argument
SHOWN = {
    **{"poll_message_set": 0, "status_text_set": 0, "undo_push": 0, "invalid_input": 0},
    **{"report": 1, "paragraph": 1, "finished": 2, "cancelled": 2},
}
# Keywords by which layouts, and those calls, are given one
KEYWORDS = ("text", "heading", "message")

# Beginnings of functions that return one: why a button is grey, what a job or an edit did
ASKED = (
    *("obstacle", "no_", "busy", "remark", "unread", "change_of"),
    *(
        "write",
        "change",
        "use",
        "edit",
        "told",
        "settings",
        "summary",
        "text",
        "short_text",
        "line",
    ),
)


def name_of(called: ast.expr) -> str:
    return called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")


def words(node: ast.expr) -> str:
    """Literals of an f-string, its values as `…`."""
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    return "".join(str(part.value) if isinstance(part, ast.Constant) else "…" for part in parts)


def has_words(node: ast.expr) -> bool:
    is_text = isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    return is_text and re.search(r"[A-Za-z]{2}", words(node)) is not None


def composed(
    node: ast.expr, function: ast.AST, is_part: bool = False, asked: tuple[str, ...] = ()
) -> list[ast.expr]:
    """Words of a text that no translation finds: those of an f-string, and those that are joined
    or formatted without a look-up; names stand for what the function gives them.

    is_part: of a text that is put together, so that Blender never looks up the node alone.
    """

    def follow(*nodes: ast.expr, is_part: bool = is_part) -> list[ast.expr]:
        return [part for one in nodes for part in composed(one, function, is_part, asked)]

    match node:
        case ast.Constant():
            return [node] if is_part and has_words(node) else []
        case ast.JoinedStr():
            values = [part.value for part in node.values if isinstance(part, ast.FormattedValue)]
            return ([node] if has_words(node) else []) + follow(*values, is_part=True)
        case ast.BinOp(op=ast.Add() | ast.Mod()):
            return follow(node.left, node.right, is_part=True)
        case ast.IfExp():
            return follow(node.body, node.orelse)
        case ast.BoolOp():
            return follow(*node.values)
        case ast.List() | ast.Tuple():
            return follow(*node.elts)
        case ast.Starred():
            return follow(node.value)
        case ast.Call(func=ast.Attribute(value=template, attr="format")):
            values = [keyword.value for keyword in node.keywords]
            return follow(template, *node.args, *values, is_part=True)
        case ast.Call(func=ast.Attribute(attr="join")):
            return follow(*node.args, is_part=True)
        case ast.Call(func=ast.Attribute(value=text, attr="strip" | "rstrip" | "replace")):
            return follow(text)
        case ast.Name() if node.id not in asked:
            return [
                part
                for one, is_added in assigned(node.id, function)
                for part in composed(one, function, is_part or is_added, (*asked, node.id))
            ]
    return []


def assigned(name: str, function: ast.AST) -> Iterator[tuple[ast.expr, bool]]:
    """What a function gives a name, and whether it is added to what the name was."""
    for line in ast.walk(function):
        if isinstance(line, (ast.Assign, ast.AugAssign, ast.AnnAssign)) and line.value:
            targets = line.targets if isinstance(line, ast.Assign) else [line.target]
            if any(isinstance(one, ast.Name) and one.id == name for one in targets):
                yield line.value, isinstance(line, ast.AugAssign)


def shown(function: ast.AST) -> list[ast.expr]:
    """Expressions that a function shows as texts, or gives to whoever shows them."""
    texts = []
    is_asked = getattr(function, "name", "").lstrip("_").startswith(ASKED)
    for node in ast.walk(function):
        if isinstance(node, ast.Call):
            texts += [one.value for one in node.keywords if one.arg in KEYWORDS]
            place = SHOWN.get(name_of(node.func))
            if place is not None:
                texts += node.args[place : place + 1]
        elif is_asked and isinstance(node, ast.Return) and node.value:
            texts.append(node.value)
    return texts


def untranslated(tree: ast.Module) -> list[tuple[int, str]]:
    """Lines and words of the texts that a module shows and no translation finds."""
    found = {
        (part.lineno, words(part))
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
        for text in shown(function)
        for part in composed(text, function)
    }
    return sorted(found)


def sentences(tree: ast.Module) -> list[tuple[int, str]]:
    """F-strings that are sentences, wherever they go; what is printed is for a terminal."""
    printed = {
        id(part)
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and name_of(call.func) == "print"
        for part in ast.walk(call)
    }
    return [
        (node.lineno, words(node))
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
        and id(node) not in printed
        and re.search(r"[A-Za-z]{2,}[,;:]? [a-z]{2}", words(node))
        and words(node) not in KEPT
    ]


def badly_asked(tree: ast.Module) -> list[tuple[int, str]]:
    """Translations of what is no template, and templates that are not given just their fields."""
    found = []
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call):
            continue
        if name_of(call.func) in TRANSLATIONS and isinstance(
            call.args[0], (ast.JoinedStr, ast.BinOp)
        ):
            found.append((call.lineno, "is put together before it is looked up"))
        template = call.func.value if isinstance(call.func, ast.Attribute) else None
        if (
            name_of(call.func) == "format"
            and isinstance(template, ast.Call)
            and name_of(template.func) in TRANSLATIONS
            and isinstance(template.args[0], ast.Constant)
        ):
            fields = {name for _, name, _, _ in Formatter().parse(template.args[0].value)} - {None}
            if call.args or fields != {keyword.arg for keyword in call.keywords}:
                found.append((call.lineno, template.args[0].value))
    return found


def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("check", [untranslated, sentences, badly_asked])
def test_texts_of_words_and_values_are_templates(check):
    assert len(FILES) > 100
    found = [
        f"{path.relative_to(ADDON)}:{line}: {text}"
        for path in FILES
        for line, text in check(tree_of(path))
    ]
    assert found == []


BAD = """
def draw(self, context):
    self.layout.label(text=f"{name} is gone")
    self.layout.operator("mimetic.bake", text="Bake on " + head.name)
    self.layout.prop(self, "value", text="Group %s" % name)
    keeps = " and keeps it" if run.keeps else ""
    keeps += ", whole"
    row.label(text=f"{iface_('Esc stops')}{keeps}")
    self.layout.label(text="No curves yet" if not curves else f"{count} curves")

def poll(cls, context):
    cls.poll_message_set("{} runs".format(job))

def obstacle(cls, context):
    reason = f"{clip} is missing"
    return reason

def edit(self, context, face):
    return message + ", all of it", {"name": face.name}

def execute(self, context):
    self.report({"INFO"}, f"Wrote {path}")
    context.workspace.status_text_set("; ".join([text, "Esc stops"]))
    return outcome.finished(self, context, message + "; it stays")
"""
GOOD = """
def draw(self, context):
    self.layout.label(text=iface_("{name} is gone").format(name=name))
    self.layout.label(text="No curves yet", heading="Curves")
    self.layout.label(text=f"{name}: {text}")
    self.layout.prop(self, f"show_{name}")
    bar.progress(factor=0.5, text=f"{share:.0%}")

def obstacle(cls, context):
    reason = iface_("{clip} is missing").format(clip=clip)
    return reason or "Load the footage first"

def execute(self, context):
    message = rpt_("{count} keys").format(count=3)
    message += rpt_("; the rest stays")
    self.report({"INFO"}, message)
    action = actions.new(f"{take} muscles")
"""


def test_the_check_sees_every_way_that_a_text_is_put_together():
    assert [text for _, text in untranslated(ast.parse(BAD))] == [
        "… is gone",
        "Bake on ",
        "Group %s",
        " and keeps it",
        ", whole",
        "… curves",
        "{} runs",
        "… is missing",
        ", all of it",
        "Wrote …",
        "Esc stops",
        "; it stays",
    ]
    assert untranslated(ast.parse(GOOD)) == []
    for text in ('iface_(f"{a} is gone")', 'iface_("a " + b)', 'rpt_("{a} of {}").format(a=1)'):
        assert badly_asked(ast.parse(text)), text
    assert badly_asked(ast.parse('rpt_("{a} goes").format(b=1)'))
    assert badly_asked(ast.parse('rpt_("{a:.2f} of {b}").format(a=1, b=2)')) == []
    assert sentences(ast.parse('what = f"{clip} is not there"'))
    assert sentences(ast.parse('print(f"{clip} is not there")')) == []
