# SPDX-License-Identifier: GPL-3.0-or-later
"""A layout that records what a panel draws, and how wide each of its rows has to be.

Widths are what Blender's own widgets leave for texts at a UI scale of 1, as measured in a window.
"""

from __future__ import annotations

from types import MethodType, SimpleNamespace

import blf
import bpy

POINTS = 11  # of Blender's widgets
UNIT = 20.0  # pixels
MARGIN = 10.0  # of a text in its widget
LABEL = 3.0  # of a text that stands by itself
FIELD = 60.0  # the least of a text or pointer beside its name
VALUE = 40.0  # of a number beside its name
LIST = 24.0  # of a list: its frame, and its scroll bar
SPLIT = 0.4  # of the width is for names where properties are split


def text_width(text: str) -> float:
    blf.size(0, POINTS)
    return blf.dimensions(0, text)[0]


class Recorded:
    """Answers as bpy.types.UILayout does, as far as our panels ask."""

    def __init__(self, across: bool = False):
        self.across = across
        self.parts: list = []  # (width, what) or layouts
        self.ui_units_x = 0.0
        self.use_property_split = False

    def row(self, align=False, heading="", **_):
        child = self._child(across=True)
        if heading:
            child._add(text_width(heading) + MARGIN, heading)
        return child

    def column(self, align=False, **_):
        return self._child(across=False)

    def box(self):
        return self._child(across=False)

    def panel(self, name, default_closed=False):
        header, body = self._child(across=True), self._child(across=False)
        header._add(UNIT, "arrow")
        return header, body

    def label(self, text="", icon="NONE", **_):
        self._add(_labelled(text, icon, LABEL), text)

    def separator(self, **_):
        pass

    def operator(self, name, text=None, icon="NONE", **_):
        group, command = name.split(".")
        kind = getattr(getattr(bpy.ops, group), command).get_rna_type()
        shown = kind.name if text is None else text
        self._add(_labelled(shown, icon), shown)
        return SimpleNamespace()

    def operator_menu_enum(self, name, _property, text=None, icon="NONE", **_):
        return self.operator(name, text, icon)

    def prop(self, data, name, text=None, icon="NONE", expand=False, slider=False, **_):
        kind = data.bl_rna.properties[name]
        shown = kind.name if text is None else text
        if kind.type == "ENUM" and (expand or kind.is_enum_flag):
            widths = [text_width(item.name) + MARGIN for item in kind.enum_items]
            self._add(sum(widths) if self.across else max(widths), shown)
        elif self.use_property_split:
            self._add(text_width(shown) / SPLIT, shown)
        elif not shown:
            bare = {"BOOLEAN": UNIT, "INT": VALUE, "FLOAT": VALUE}
            self._add(bare.get(kind.type, FIELD), name)
        elif kind.type in {"INT", "FLOAT"}:
            self._add(text_width(shown) + MARGIN + VALUE, shown)
        elif kind.type == "BOOLEAN":
            self._add(text_width(shown) + MARGIN + UNIT, shown)
        else:
            self._add(text_width(f"{shown}:") + MARGIN + FIELD, shown)

    def prop_search(self, data, name, _where, _list, text=None, **_):
        self.prop(data, name, text)

    def progress(self, factor=0.0, text="", **_):
        self._add(text_width(text) + LABEL, text)

    def template_icon(self, *_, **__):
        self._add(100.0, "icon")

    def template_list(self, kind, _, data, name, active_data, active, **__):
        """Its rows, each as its list draws it: what the frame and a scroll bar take is beside."""
        listed = self._child(across=False)
        for index, item in enumerate(getattr(data, name)):
            row = listed.row()
            row._add(LIST, "list")
            shown = _stand_in(getattr(bpy.types, kind), row.row())
            shown.draw_item(bpy.context, shown.layout, data, item, 0, active_data, active, index)

    @property
    def width(self) -> float:
        return UNIT * self.ui_units_x if self.ui_units_x else self.needed

    @property
    def needed(self) -> float:
        """By what it shows, whatever width it was given."""
        widths = [part.width if isinstance(part, Recorded) else part[0] for part in self.parts]
        return sum(widths) if self.across else max(widths, default=0.0)

    @property
    def texts(self) -> list[str]:
        found = []
        for part in self.parts:
            found += part.texts if isinstance(part, Recorded) else [part[1]]
        return found

    def wider_than(self, limit: float) -> list[tuple[str, float]]:
        """Rows, and what stands by itself, that ask for more: their texts and how wide they are."""
        if self.across:
            return [(" | ".join(self.texts), self.width)] if self.width > limit else []
        found = []
        for part in self.parts:
            if isinstance(part, Recorded):
                found += part.wider_than(limit)
            elif part[0] > limit:
                found.append((part[1], part[0]))
        return found

    def overfull(self) -> list[tuple[str, float]]:
        """Parts that were given less than they show: their texts and how much less."""
        found = []
        for part in self.parts:
            if isinstance(part, Recorded):
                found += part.overfull()
        if self.ui_units_x and self.needed > UNIT * self.ui_units_x + 0.5:
            found.append((" | ".join(self.texts), self.needed - UNIT * self.ui_units_x))
        return found

    def _child(self, across: bool) -> Recorded:
        child = Recorded(across)
        child.use_property_split = self.use_property_split
        self.parts.append(child)
        return child

    def _add(self, width: float, what: str) -> None:
        self.parts.append((width, what))


def drawn(panel: type, context) -> Recorded:
    """What a panel draws there."""
    shown = _stand_in(panel, Recorded())
    shown.draw(context)
    return shown.layout


def _stand_in(kind: type, layout: Recorded) -> SimpleNamespace:
    """A panel or a list, which cannot be made from Python."""
    shown = SimpleNamespace(layout=layout)
    for name in dir(kind):
        if name.startswith(("draw", "bl_")):
            own = getattr(kind, name)
            setattr(shown, name, MethodType(own, shown) if callable(own) else own)
    return shown


def _labelled(text: str, icon: str, margin: float = MARGIN) -> float:
    beside = UNIT if icon != "NONE" else 0.0
    return beside + (text_width(text) + margin if text else 0.0)
