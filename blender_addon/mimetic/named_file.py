# SPDX-License-Identifier: GPL-3.0-or-later
"""The file that was named in Blender's file browser, to be written."""

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from . import native


def named_file(filepath: str, suffix: str) -> str:
    """Its absolute path, with the suffix; raises InvalidInput where a folder alone is named."""
    path = bpy.path.ensure_ext(bpy.path.abspath(filepath), suffix)
    if Path(path).name == suffix:
        raise native.invalid_input(
            rpt_("{folder}: the file has no name; give it one").format(folder=Path(path).parent)
        )
    return path
