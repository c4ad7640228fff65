# SPDX-License-Identifier: GPL-3.0-or-later
"""What the extension's sources declare: panels, operators, settings; read without Blender."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
ADDON = ROOT / "blender_addon" / "mimetic"
PROPERTY = (
    *("BoolProperty", "IntProperty", "FloatProperty", "StringProperty", "EnumProperty"),
    *("FloatVectorProperty", "IntVectorProperty", "PointerProperty", "CollectionProperty"),
)


@dataclass
class Setting:
    """A property that Blender shows: its texts, and the numbers it may have."""

    name: str
    kind: str
    keywords: dict = field(default_factory=dict)
    group: str = ""

    @property
    def label(self) -> str:
        return self.keywords.get("name") or self.name.replace("_", " ").title()

    @property
    def description(self) -> str:
        return self.keywords.get("description") or ""

    @property
    def is_hidden(self) -> bool:
        return "HIDDEN" in (self.keywords.get("options") or ())

    @property
    def is_group(self) -> bool:
        """Settings within settings, which nobody sees as such."""
        return (
            self.kind in ("PointerProperty", "CollectionProperty") and "name" not in self.keywords
        )

    @property
    def items(self) -> list[tuple]:
        return list(self.keywords.get("items") or ()) if self.kind == "EnumProperty" else []


@dataclass
class OperatorSource:
    idname: str
    label: str
    description: str
    is_internal: bool
    settings: list[Setting]
    file: str


@dataclass
class PanelSource:
    label: str
    names: list[str]  # of its classes, as in MIMETIC_PT_name
    editors: list[str]
    operators: list[str]
    settings: list[str]


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def constants(path: Path) -> dict[str, object]:
    """Names of the module that stand for texts, numbers, tuples of them; imported ones too."""
    values: dict[str, object] = {}
    for node in tree(path).body:
        if isinstance(node, ast.ImportFrom) and node.level:
            folder = path.parents[node.level - 1]
            source = folder.joinpath(*(node.module or "").split(".")).with_suffix(".py")
            for alias in node.names if source.is_file() else ():
                values[alias.asname or alias.name] = constants(source).get(alias.name)
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            values[node.targets[0].id] = value(node.value, values)
    return values


def value(node: ast.expr, names: dict[str, object]) -> object:
    """What the expression is, of literals and the module's own constants; None if unknown."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, (ast.Tuple, ast.List, ast.Set)):
        items: list[object] = []
        for item in node.elts:
            if isinstance(item, ast.Starred):
                inner = value(item.value, names)
                items += inner if isinstance(inner, (list, tuple)) else []
            else:
                items.append(value(item, names))
        return tuple(items)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        number = value(node.operand, names)
        return -number if isinstance(number, (int, float)) else None
    if isinstance(node, ast.JoinedStr):
        parts = [value(part, names) for part in node.values]
        return "".join(part if isinstance(part, str) else "…" for part in parts)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        both = [value(side, names) for side in (node.left, node.right)]
        return "".join(part if isinstance(part, str) else "…" for part in both)
    return None


def declared(body: list[ast.stmt], names: dict[str, object], group: str) -> list[Setting]:
    """Properties among a class's lines, `name: BoolProperty(...)`."""
    settings = []
    for node in body:
        if not (isinstance(node, ast.AnnAssign) and isinstance(node.annotation, ast.Call)):
            continue
        called = node.annotation.func
        kind = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
        if kind in PROPERTY and isinstance(node.target, ast.Name):
            keywords = {one.arg: value(one.value, names) for one in node.annotation.keywords}
            settings.append(Setting(node.target.id, kind, keywords, group))
    return settings


def classes(folder: Path) -> list[tuple[Path, ast.ClassDef]]:
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder]
    return [
        (path, node) for path in files for node in tree(path).body if isinstance(node, ast.ClassDef)
    ]


def attribute(node: ast.ClassDef, name: str, names: dict[str, object]) -> object:
    for line in node.body:
        if isinstance(line, ast.Assign) and getattr(line.targets[0], "id", "") == name:
            return value(line.value, names)
    return None


def inherited(node: ast.ClassDef, mixins: dict[str, tuple[Path, ast.ClassDef]]) -> list[Setting]:
    """Settings that a class has of its mixins, and these of theirs."""
    found = []
    for base in node.bases:
        name = base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
        if name in mixins:
            path, mixin = mixins[name]
            found += declared(mixin.body, constants(path), name) + inherited(mixin, mixins)
    return found


@cache
def operators() -> list[OperatorSource]:
    """Operators by their files' order, with the properties of their mixins."""
    mixins = {node.name: (path, node) for path, node in classes(ADDON)}
    sources = []
    for path, node in classes(ADDON / "operators"):
        names = constants(path)
        idname = attribute(node, "bl_idname", names)
        if not isinstance(idname, str):
            continue
        settings = declared(node.body, names, node.name)
        settings += inherited(node, mixins)
        text = attribute(node, "bl_description", names) or ast.get_docstring(node) or ""
        options = attribute(node, "bl_options", names) or ()
        sources.append(
            OperatorSource(
                idname,
                str(attribute(node, "bl_label", names) or ""),
                " ".join(str(text).split()),
                "INTERNAL" in options,
                settings,
                path.relative_to(ADDON).as_posix(),
            )
        )
    return sources


def every_setting() -> list[Setting]:
    """Properties of scenes, clips and objects."""
    return [
        setting
        for path, node in classes(ADDON)
        if path.parent.name != "operators"
        for setting in declared(node.body, constants(path), node.name)
    ]


@cache
def settings() -> dict[str, Setting]:
    """The same by name; panels draw them by it."""
    return {setting.name: setting for setting in reversed(every_setting())}


@cache
def panels() -> list[PanelSource]:
    """Panels by label, with what they draw; one that is in two editors is one."""
    parts: dict[str, PanelSource] = {}
    every = classes(ADDON / "panels")
    nodes = {node.name: (path, node) for path, node in every}
    for path, node in every:
        bases = [getattr(base, "id", "") for base in node.bases]
        if "Panel" not in bases:
            continue
        line = [node, *(nodes[base][1] for base in bases if base in nodes)]
        names = constants(path)
        label, space = (
            next((text for one in line if (text := attribute(one, name, names))), "")
            for name in ("bl_label", "bl_space_type")
        )
        panel = parts.setdefault(str(label), PanelSource(str(label), [], [], [], []))
        panel.names.append(node.name.removeprefix("MIMETIC_PT_"))
        panel.editors.append(str(space))
        for one in line:
            _collect(one, panel)
        if node.name == "MIMETIC_PT_controls":
            _collect(nodes["MIMETIC_UL_controls"][1], panel)
    return list(parts.values())


def _collect(node: ast.ClassDef, panel: PanelSource) -> None:
    """Operators and properties that the class's methods name, each once, in their order."""
    for call in ast.walk(node):
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)):
            continue
        texts = [text for part in call.args if isinstance(text := value(part, {}), str)]
        if call.func.attr == "operator" and texts:
            panel.operators += {texts[0]}.difference(panel.operators)
        elif call.func.attr in ("prop", "prop_search") and texts:
            # `f"show_{name}"` stands for all that there are
            pattern = re.escape(texts[0]).replace("…", ".*")
            names = [name for name in settings() if re.fullmatch(pattern, name)]
            panel.settings += [name for name in names if name not in panel.settings]
