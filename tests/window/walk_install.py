# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the zip in a new Blender and looks at its panels."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, install, open_sidebar, start


def steps(walk: Walk) -> Steps:
    yield from install(walk, "bl_ext.user_default.mimetic")
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    yield from walk.picture("panel")


start(steps)
