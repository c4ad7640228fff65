# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels and menus draw, without a window: a layout that writes down what it is given."""

import bpy

ICONS = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys()


class Layout:
    """Stands for a UILayout; rows, columns and panels write into the same list. What a real one
    refuses fails here too: icons, operators and properties that do not exist."""

    def __init__(self, texts: list[str], lit: list[str] | None = None):
        self.texts = texts
        self.lit = [] if lit is None else lit  # operators whose buttons stand out

    def operator(self, name, text="", icon="NONE", depress=False):
        assert icon in ICONS
        self.lit += [name] if depress else []
        kind = getattr(bpy.ops.mimetic, name.removeprefix("mimetic.")).get_rna_type()
        self.texts += [name, text]
        return type("Properties", (), dict.fromkeys(kind.properties.keys()))()

    def label(self, text="", icon="NONE"):
        assert icon in ICONS
        self.texts.append(text)

    def menu(self, name):
        assert hasattr(bpy.types, name)
        self.texts.append(name)

    def operator_menu_enum(self, name, property, text="", icon="NONE"):
        self.operator(name, text, icon)
        kind = getattr(bpy.ops.mimetic, name.removeprefix("mimetic.")).get_rna_type()
        assert property in kind.properties

    def prop(self, owner, name, text=None, icon="NONE", slider=False, expand=False):
        assert icon in ICONS
        assert name in owner.bl_rna.properties
        self.texts.append(text or name)

    def prop_search(self, owner, name, *_, **__):
        assert name in owner.bl_rna.properties
        self.texts.append(name)

    def template_list(self, list_type, _, owner, name, active_owner, active, rows=5):
        assert hasattr(bpy.types, list_type)
        assert name in owner.bl_rna.properties
        assert active in active_owner.bl_rna.properties
        self.texts.append(list_type)

    def panel(self, name, default_closed=False):
        return self.row(), self.row()

    def row(self, align=False):
        return Layout(self.texts, self.lit)

    column = row

    def separator(self):
        pass

    def progress(self, factor=0.0, text=""):
        self.texts.append(text)


def drawn(name: str) -> str:
    """All that a panel or a menu of ours draws now, in one line."""
    return " ".join(_layout_of(name).texts)


def lit_buttons(name: str) -> list[str]:
    """The operators whose buttons stand out in a panel of ours now."""
    return _layout_of(name).lit


def _layout_of(name: str) -> Layout:
    shown = _stand_in(getattr(bpy.types, name))()
    shown.layout = Layout([])
    shown.draw(bpy.context)
    return shown.layout


def _stand_in(kind: type) -> type:
    """The class without Blender's own base, which cannot be made from Python."""
    members = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("bl_ext"):
            members |= {n: v for n, v in vars(base).items() if not n.startswith("__")}
    members.pop("bl_rna", None)
    return type("StandIn", (), members)
