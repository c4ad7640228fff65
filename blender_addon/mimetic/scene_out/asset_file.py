# SPDX-License-Identifier: GPL-3.0-or-later
"""A library's expressions as a .blend of assets, which Blender's Asset Browser shows."""

from __future__ import annotations

from pathlib import Path

import bpy

from .. import native
from . import expressions, new_file

RATE = 24.0  # frames a second that keys are laid at; a strip in another scene keeps the seconds


def write(folder: str, out: str) -> str:
    """Makes the assets in the file that is open, which must be empty, and writes it.

    Returns what was written; raises what the package raises for bad input, and OSError.
    """
    library = native.library("folder").Library(Path(folder))
    names = library.names()
    if not names:
        raise native.invalid_input(f"{folder} has no expression: `mimetic library keep` makes one")
    bpy.context.scene.render.fps = round(RATE)
    for name in names:
        document = library.load(name)
        expressions.new_asset(name, document, RATE, expressions.picture_of(document))
    new_file.save(out, None)
    return f"{len(names)} assets: {', '.join(names)}"
