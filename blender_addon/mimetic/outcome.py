# SPDX-License-Identifier: GPL-3.0-or-later
"""How an operator ended and what it made: a line for the user, and for scripts
`bpy.context.window_manager.mimetic_result`, a JSON object (docs/guide/scripting.md)."""

import json

import bpy
from bpy.app.translations import pgettext_rpt as rpt_


def finished(operator, context, message: str, level: str = "INFO", **facts) -> set[str]:
    """Reports and keeps what was made, values that JSON has; returns what `execute` returns."""
    return _told(operator, context, "FINISHED", level, message, facts)


def cancelled(operator, context, message: str, level: str = "ERROR") -> set[str]:
    """The same where nothing was made; of level ERROR, `bpy.ops` raises RuntimeError."""
    return _told(operator, context, "CANCELLED", level, message, {})


def readable(text: str) -> str:
    """As Blender takes it: names of files may have bytes that are no UTF-8."""
    return text.encode(errors="backslashreplace").decode()


def told_by(error: RuntimeError) -> str:
    """What an operator that was called has reported, of which `bpy.ops` makes an error."""
    return str(error).strip().removeprefix("Error: ")


def _told(operator, context, status: str, level: str, message: str, facts: dict) -> set[str]:
    message = readable(rpt_(message))
    if message:
        operator.report({level}, message)
    result = {
        "operator": ".".join(operator.bl_idname.split("_OT_", 1)).lower(),
        "status": status,
        "message": message,
        **facts,
    }
    context.window_manager.mimetic_result = json.dumps(result)
    return {status}


def register() -> None:
    bpy.types.WindowManager.mimetic_result = bpy.props.StringProperty(
        name="Mimetic's Result",
        options={"HIDDEN", "SKIP_SAVE"},
        description="How Mimetic's last operator ended and what it made, as JSON",
    )


def unregister() -> None:
    del bpy.types.WindowManager.mimetic_result
