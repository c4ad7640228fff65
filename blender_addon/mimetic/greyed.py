# SPDX-License-Identifier: GPL-3.0-or-later
"""Buttons that are grey, and say why."""


class Greyed:
    """Mixin of operators. Subclasses give `obstacle(context)`: why it cannot run, or nothing."""

    @classmethod
    def poll(cls, context):
        if reason := cls.obstacle(context):
            cls.poll_message_set(reason)
        return not reason
