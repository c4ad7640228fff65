# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles follow a landmark that the mouse drags and lets go."""

import shutil


def test_muscles_follow_a_dragged_landmark(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    way = {"seconds": 240, "is_simulated": False}
    way["beside"] = ("undoing.py", "redo_scenes.py", "../blender/scene_state.py")
    settings = {"extension": extension.name}
    result = folder.walk(screen, "walk_dragged_landmarks.py", work, pictures, settings, **way)
    assert not result.failures()
