# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings under headings that open and shut: a bake has more than an editor has rows."""

from __future__ import annotations


class InSections:
    """Mixin of operators.

    Subclasses give `sections`: heading, settings, whether it is shut at first. A setting is greyed
    where `is_in_use` says that it does nothing as the others stand.
    """

    sections: tuple[tuple[str, tuple[str, ...], bool], ...] = ()

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for heading, names, is_shut in self.sections:
            header, body = layout.panel(f"{self.bl_idname} {heading}", default_closed=is_shut)
            header.label(text=heading)
            if body is None:
                continue
            for name in names:
                row = body.row()
                row.active = self.is_in_use(name)
                row.prop(self, name)

    def is_in_use(self, name: str) -> bool:
        return True
