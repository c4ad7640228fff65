# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender goes from frame to frame by itself; and whether it played when jobs last heard of
anything.

Blender passes on an Esc that has ended the playback, and nothing plays by then.
"""

import bpy

was_on = False  # by the last `note`


def is_on() -> bool:
    """Whether a window plays the animation."""
    windows = bpy.context.window_manager.windows
    return any(window.screen.is_animation_playing for window in windows)


def is_rendering() -> bool:
    return bpy.app.is_job_running("RENDER")


def has_the_playhead() -> bool:
    """A render counts in the scene's frame: whoever else sets it makes it leave frames out."""
    return is_on() or is_rendering()


def note() -> None:
    """Of each event that a job hears, before Blender acts on it."""
    global was_on
    was_on = is_on()
