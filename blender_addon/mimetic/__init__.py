# SPDX-License-Identifier: GPL-3.0-or-later
"""Mimetic: facial performance capture, from video to muscle curves."""

from . import (
    contact,
    control_preview,
    dragged_landmarks,
    drops,
    jobs,
    keys,
    live_looks,
    menus,
    operators,
    outcome,
    overlay,
    panels,
    pins,
    preferences,
    properties,
    shown_again,
    takes,
    turned_views,
    workspace,
)

# In this order: panels and operators refer to the properties
PARTS = (
    preferences,
    properties,
    outcome,
    operators,
    keys,
    drops,
    menus,
    panels,
    overlay,
    contact,
    control_preview,
    pins,
    dragged_landmarks,
    takes,
    live_looks,
    workspace,
    shown_again,
    turned_views,  # local view is as it was by then
)


def register() -> None:
    for part in PARTS:
        part.register()


def unregister() -> None:
    jobs.stop_running()
    for part in reversed(PARTS):
        part.unregister()
