# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are dropped on the clip editor or a 3D view: footage, and takes."""

import bpy
from bpy.types import FileHandler

EDITORS = ("CLIP_EDITOR", "VIEW_3D")


def _is_ours(context) -> bool:
    return context.area is not None and context.area.type in EDITORS


class MIMETIC_FH_clip(FileHandler):
    bl_idname = "MIMETIC_FH_clip"
    bl_label = "Footage of a Face"
    bl_import_operator = "mimetic.load_clip"
    bl_file_extensions = ".mp4;.mov;.avi;.mkv;.webm;.m4v"

    @classmethod
    def poll_drop(cls, context):
        return _is_ours(context)


class MIMETIC_FH_pictures(FileHandler):
    bl_idname = "MIMETIC_FH_pictures"
    bl_label = "Pictures of a Face, Numbered"
    bl_import_operator = "mimetic.load_clip"
    bl_file_extensions = ".png;.jpg;.jpeg;.exr;.tif;.tiff;.dpx;.bmp;.tga"

    @classmethod
    def poll_drop(cls, context):
        # In a 3D view a picture is a reference, by Blender's own drop
        return context.area is not None and context.area.type == "CLIP_EDITOR"


class MIMETIC_FH_performance(FileHandler):
    bl_idname = "MIMETIC_FH_performance"
    bl_label = "Captured Performance"
    bl_import_operator = "mimetic.load_performance"
    bl_file_extensions = ".npz"

    @classmethod
    def poll_drop(cls, context):
        return _is_ours(context)


CLASSES = (MIMETIC_FH_clip, MIMETIC_FH_pictures, MIMETIC_FH_performance)


def register() -> None:
    for handler in CLASSES:
        bpy.utils.register_class(handler)


def unregister() -> None:
    for handler in reversed(CLASSES):
        bpy.utils.unregister_class(handler)
