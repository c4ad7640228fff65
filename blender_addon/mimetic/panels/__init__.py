# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab Mimetic in the sidebars of the clip editor, the 3D view and the Graph Editor."""

import bpy

from . import (
    capture,
    captured_takes,
    clip_overlays,
    controls,
    corrections,
    curves,
    error_bars,
    expressions,
    head,
    live,
    live_looks,
    muscles,
    takes,
)

CLASSES = (
    *capture.CLASSES,
    *captured_takes.CLASSES,
    *clip_overlays.CLASSES,
    *corrections.CLASSES,
    *head.CLASSES,
    *live.CLASSES,
    *live_looks.CLASSES,
    *muscles.CLASSES,
    *takes.CLASSES,
    *curves.CLASSES,
    *controls.CLASSES,
    *error_bars.CLASSES,
    *expressions.CLASSES,
)


def register() -> None:
    for panel in CLASSES:
        bpy.utils.register_class(panel)


def unregister() -> None:
    for panel in reversed(CLASSES):
        bpy.utils.unregister_class(panel)
