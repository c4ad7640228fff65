# SPDX-License-Identifier: GPL-3.0-or-later
"""Buttons that are grey, and say why."""

from bpy.app.translations import pgettext_iface as iface_


class Greyed:
    """Mixin of operators. Subclasses give `obstacle(context)`: why it cannot run, or nothing."""

    @classmethod
    def poll(cls, context):
        if reason := cls.obstacle(context):
            cls.poll_message_set(iface_(reason))
        return not reason
