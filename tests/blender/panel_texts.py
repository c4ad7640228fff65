# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels and menus draw, without a window: a layout that writes down what it is given."""

import bpy


class Layout:
    """Stands for a UILayout; rows, columns and panels write into the same list."""

    def __init__(self, told: list[str]):
        self.told = told

    def operator(self, name, text=None, **_):
        shown = text if text is not None else getattr(bpy.ops.mimetic, name.split(".")[1])
        self.told += [name, shown if isinstance(shown, str) else ""]
        return type("Properties", (), {})()

    def label(self, text="", **_):
        self.told.append(text)

    def menu(self, name, **_):
        self.told.append(name)

    def prop(self, owner, name, text=None, **_):
        self.told.append(text or name)

    def prop_search(self, owner, name, *_, **__):
        self.told.append(name)

    def panel(self, name, **_):
        return Layout(self.told), Layout(self.told)

    def row(self, **_):
        return Layout(self.told)

    column = row

    def separator(self, **_):
        pass

    def progress(self, **_):
        pass


def drawn(name: str) -> str:
    """All that a panel or a menu of ours draws now, in one line."""
    told: list[str] = []
    shown = _stand_in(getattr(bpy.types, name))()
    shown.layout = Layout(told)
    shown.draw(bpy.context)
    return " ".join(told)


def _stand_in(kind: type) -> type:
    """The class without Blender's own base, which cannot be made from Python."""
    members = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("bl_ext"):
            members |= {n: v for n, v in vars(base).items() if not n.startswith("__")}
    members.pop("bl_rna", None)
    return type("StandIn", (), members)
