# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import StringProperty
from bpy.types import Operator
from bpy_extras.io_utils import ImportHelper

from .. import native, scene_in


class MIMETIC_OT_load_performance(Operator, ImportHelper):
    """Choose a captured performance to bake"""

    bl_idname = "mimetic.load_performance"
    bl_label = "Load Performance"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".npz"
    filter_glob: StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_start():
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context):
        path = bpy.path.abspath(self.filepath)
        try:
            performance = native.part("performance").Performance.load(path)
        except native.known_errors() as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.scene.mimetic.performance_path = path
        first, last = performance.frame[0], performance.frame[-1]
        told = [f"Frames {first} to {last} at {performance.fps:.6g} frames/s"]
        told += performance.notes or []
        self.report({"WARNING" if performance.notes else "INFO"}, "; ".join(told))
        return {"FINISHED"}
