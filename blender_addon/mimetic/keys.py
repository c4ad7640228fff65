# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys that the extension brings; Preferences > Keymap changes them. None is one of Blender's own
in these modes, and where a button is grey its key goes on to whoever else has it. Esc reaches the
window's keymap where no editor has a use for it."""

import bpy

# Keymap, its kind of space, operator, key
KEYS = (
    ("Object Mode", "EMPTY", "mimetic.face_as_lines", "Y"),
    ("Pose", "EMPTY", "mimetic.face_as_lines", "Y"),
    ("Window", "EMPTY", "mimetic.stop", "ESC"),  # its own window's a job hears by itself
)
_items = []  # (keymap, item) that are registered


def register() -> None:
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:  # Blender without a window may have none
        return
    for name, space, operator, key in KEYS:
        keymap = config.keymaps.new(name=name, space_type=space)
        _items.append((keymap, keymap.keymap_items.new(operator, key, "PRESS")))


def unregister() -> None:
    while _items:
        keymap, item = _items.pop()
        keymap.keymap_items.remove(item)
