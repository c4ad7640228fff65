# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy.types import Operator
from bpy_extras.io_utils import ExportHelper

from .. import native, outcome, scene_in, scene_out, targets
from ..greyed import Greyed
from ..named_file import named_file


class MIMETIC_OT_export_gltf(Greyed, Operator, ExportHelper):
    """Write the face with its muscles and motion as a .glb file, for game engines and viewers"""

    bl_idname = "mimetic.export_gltf"
    bl_label = "Export glTF"

    filename_ext = ".glb"
    filter_glob: StringProperty(default="*.glb", options={"HIDDEN"})

    obstacle = staticmethod(targets.no_export)

    def execute(self, context):
        try:
            path = named_file(self.filepath, ".glb")
            left_out = scene_out.gltf.export(context.scene, path, scene_in.face_of(context))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        text = rpt_("Wrote {path}").format(path=path)
        text = "; ".join(filter(None, (text, left_out)))
        return outcome.finished(self, context, text, file=path)
