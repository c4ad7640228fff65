# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts are told that the last operator made."""

import json

import bpy


def result() -> dict:
    return json.loads(bpy.context.window_manager.mimetic_result)
