# SPDX-License-Identifier: GPL-3.0-or-later
"""Drivers by which a control object's bones set a face's shape keys.

Sums, and expressions that Blender evaluates by itself: no script has to be allowed.
"""

from __future__ import annotations

import bpy

from .. import native
from . import by_hand, control_bones

CONTROL, YAW, PITCH = "control", "yaw", "pitch"  # variables, which say whose a driver is
OURS = {CONTROL, YAW, PITCH}


def drive(face: bpy.types.Object, control: bpy.types.Object, layout) -> None:
    """Sets all keys that the layout's bones move by them, instead of by our drivers of before."""
    parts = native.control_object()
    release(face)
    names = by_hand.keys_now(face)
    keys = face.data.shape_keys
    lids = _carried_lids(face) if layout.kind == "turns" else {}
    for channel in layout.channels:
        driver = _new(keys, names[channel.shape])
        path = control_bones.path_of(channel)
        is_place = channel.path == parts.LOCATION
        _read(driver, control, f"{path}[{channel.index}]" if is_place else path)
        expression = channel.expression
        if channel.shape in lids:
            _turn(driver, control, channel.shape[-1], PITCH)
            expression = lids[channel.shape]
        _compute(driver, expression)
    for side in layout.eyes:
        for shape, expression in parts.gaze_expressions(layout.kind, side).items():
            driver = _new(keys, names[shape])
            for angle in (YAW, PITCH):
                if angle in expression:
                    _turn(driver, control, side, angle)
            _compute(driver, expression)


def release(face: bpy.types.Object) -> None:
    """Takes our drivers away; keys keep the values that they have."""
    keys = face.data.shape_keys
    if keys is None or keys.animation_data is None:
        return
    for curve in [curve for curve in keys.animation_data.drivers if _is_ours(curve)]:
        keys.animation_data.drivers.remove(curve)


def keys_driven(face: bpy.types.Object) -> set[str]:
    """Names of the keys that our drivers set."""
    keys = face.data.shape_keys
    if keys is None or keys.animation_data is None:
        return set()
    paths = {curve.data_path for curve in keys.animation_data.drivers if _is_ours(curve)}
    return {key.name for key in keys.key_blocks if key.path_from_id("value") in paths}


def _is_ours(curve: bpy.types.FCurve) -> bool:
    names = {variable.name for variable in curve.driver.variables}
    return bool(names) and names <= OURS


def _carried_lids(face: bpy.types.Object) -> dict[str, str]:
    """Expressions of the upper lids that go along with their eyes."""
    rows = tuple(face.mimetic.lid_following)
    following = {"L": rows[:2], "R": rows[2:]}
    return {
        f"lid_upper.{side}": native.control_object().lid_expression(*row)
        for side, row in following.items()
        if row[0]
    }


def _new(keys: bpy.types.Key, name: str) -> bpy.types.Driver:
    return keys.driver_add(f'key_blocks["{bpy.utils.escape_identifier(name)}"].value').driver


def _read(driver: bpy.types.Driver, control: bpy.types.Object, path: str) -> None:
    variable = driver.variables.new()
    variable.name = CONTROL
    variable.targets[0].id = control
    variable.targets[0].data_path = path


def _turn(driver: bpy.types.Driver, control: bpy.types.Object, side: str, angle: str) -> None:
    variable = driver.variables.new()
    variable.name, variable.type = angle, "TRANSFORMS"
    target = variable.targets[0]
    target.id, target.bone_target = control, f"eye.{side}"
    target.transform_type = "ROT_Z" if angle == YAW else "ROT_X"
    target.rotation_mode, target.transform_space = "XYZ", "LOCAL_SPACE"


def _compute(driver: bpy.types.Driver, expression: str) -> None:
    if expression:
        driver.type, driver.expression = "SCRIPTED", expression
    else:
        driver.type = "SUM"
