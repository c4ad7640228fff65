# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty
from bpy.types import Operator
from bpy_extras.io_utils import ExportHelper

from .. import native, outcome, scene_in, scene_out, targets
from ..greyed import Greyed
from ..named_file import named_file

SUFFIXES = {"FBX": ".fbx", "USD": ".usdc", "ALEMBIC": ".abc"}


class MIMETIC_OT_export_character(Greyed, Operator, ExportHelper):
    """Write the face, with its rig if it has one, for other programs, by Blender's own exporters"""

    bl_idname = "mimetic.export_character"
    bl_label = "Export FBX, USD, Alembic"

    format: EnumProperty(
        name="Format",
        items=(
            ("FBX", "FBX", "Shape keys, bones and their curves, a key every frame"),
            ("USD", "USD", "Blend shapes and skeletons"),
            ("ALEMBIC", "Alembic", "The vertices of every frame, for renderers"),
        ),
        description="What the file is read by",
    )
    filter_glob: StringProperty(default="*.fbx;*.usdc;*.abc", options={"HIDDEN"})

    obstacle = staticmethod(targets.no_export)

    @property
    def filename_ext(self):
        return SUFFIXES[self.format]

    def execute(self, context):
        try:
            path = named_file(self.filepath, self.filename_ext)
            loses = scene_out.exports.export(context.scene, path, scene_in.face_of(context))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        return outcome.finished(
            self, context, rpt_("Wrote {path}; {loses}").format(path=path, loses=loses), file=path
        )
