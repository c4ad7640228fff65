# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.props import StringProperty
from bpy_extras.io_utils import ImportHelper


class Opened(ImportHelper):
    """Mixin of operators that open a file: chosen in the file browser, or dropped on an editor."""

    filepath: StringProperty(
        name="File",
        subtype="FILE_PATH",
        options={"SKIP_SAVE", "HIDDEN"},  # or the button would open the last one again
        description="File to open",
    )

    is_by_hand = False  # from a button, a menu or a drop, not by a script's call

    def invoke(self, context, event):
        self.is_by_hand = True
        if self.filepath:
            return self.execute(context)
        return ImportHelper.invoke(self, context, event)
