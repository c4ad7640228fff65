# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's page in the preferences: says whether the native module works."""

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import native


class MimeticPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, context):
        if reason := native.problem():
            self.layout.label(text=reason, icon="ERROR")
        else:
            self.layout.label(
                text=iface_("Native module {version}").format(version=native.status().text),
                icon="CHECKMARK",
            )


def register() -> None:
    bpy.utils.register_class(MimeticPreferences)


def unregister() -> None:
    bpy.utils.unregister_class(MimeticPreferences)
