# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as a Python module, with the extension of this checkout and nothing of the user's."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

HEADLESS = Path(__file__).resolve().parent.parent / "blender_addon" / "headless_bake.py"


def run(program: str, build: Callable[[Path], None]) -> int:
    """The exit status of `program`; build: runs in Blender, given a folder for the while."""
    with tempfile.TemporaryDirectory() as folder:
        # Read by bpy as it is imported: no settings or add-ons of the user's
        os.environ["BLENDER_USER_RESOURCES"] = folder
        try:
            headless = _headless()
            headless.load_extension()
            build(Path(folder))
        except ImportError as error:
            print(f"{program}: {error}; pip install bpy==4.5.15 gives Blender", file=sys.stderr)
            return 2
    # Blender 4.5 as a module does not come to its end once Rigify has been in it
    headless.leave()
    return 0


def repository() -> str:
    """Of extensions, that the extension was loaded into."""
    return _headless().REPOSITORY


def arrange_screens(scene, shown) -> None:
    """As a baked file opens: through the camera, with the object's curves and sliders beside."""
    extension = f"bl_ext.{repository()}.mimetic"
    importlib.import_module(f"{extension}.scene_out.opened_view").arrange(scene, shown)


def _headless() -> ModuleType:
    """By its file: the folder beside it has the package's name, so stays off the path."""
    spec = importlib.util.spec_from_file_location("headless_bake", HEADLESS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
