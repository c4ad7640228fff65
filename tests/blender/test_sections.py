# SPDX-License-Identifier: GPL-3.0-or-later
"""Redo panels with headings hold every setting, and fit into a clip editor as they are at first."""

import bpy

MOST_ROWS = 13  # of the clip editor in the workspace Mimetic, in a window of 1280 by 800


def in_sections(extension) -> list:
    kinds = extension("operators").CLASSES
    found = [kind for kind in kinds if issubclass(kind, extension("operators.sections").InSections)]
    assert len(found) == 2
    return found


def test_every_setting_stands_under_one_heading(extension):
    blenders = {"rna_type", *bpy.types.Operator.bl_rna.properties.keys()}
    for kind in in_sections(extension):
        shown = getattr(bpy.ops.mimetic, kind.bl_idname.partition(".")[2]).get_rna_type().properties
        settings = [p.identifier for p in shown if not (p.is_hidden or p.identifier in blenders)]
        assert sorted(name for _, names, _ in kind.sections for name in names) == sorted(settings)


def test_what_is_open_at_first_fits(extension):
    for kind in in_sections(extension):
        rows = len(kind.sections)
        rows += sum(len(names) for _, names, is_shut in kind.sections if not is_shut)
        assert rows <= MOST_ROWS
