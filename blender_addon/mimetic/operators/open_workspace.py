# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import outcome, workspace
from ..greyed import Greyed


class MIMETIC_OT_open_workspace(Greyed, Operator):
    """Go to the workspace Mimetic: footage left, face right, curves below. It is made if there is
    none; your own workspaces stay as they are"""

    bl_idname = "mimetic.open_workspace"
    bl_label = "Mimetic Workspace"

    @classmethod
    def obstacle(cls, context):
        return workspace.no_workspace()

    def execute(self, context):
        workspace.open_in(context.window or context.window_manager.windows[0])
        return outcome.finished(self, context, "", workspace=workspace.NAME)


CLASSES = (MIMETIC_OT_open_workspace,)
