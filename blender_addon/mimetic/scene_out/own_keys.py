# SPDX-License-Identifier: GPL-3.0-or-later
"""A character's own controls as plain values: shape keys that are not ours, of the head and of
what else it is made of."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_

from .. import native
from . import actions, by_hand, companions, sliders
from .contact import KEY


def own_keys(head: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """Shape keys that the character's maker gave it and that a curve can move.

    Keys of ours, muted keys and keys that drivers set are none.
    """
    keys = head.data.shape_keys if head.type == "MESH" else None
    if keys is None:
        return []
    others = {keys.reference_key.name, KEY, *driven_keys(keys)}
    if len(head.mimetic.shapes):
        others |= set(by_hand.keys_now(head).values())
    return [key for key in keys.key_blocks if key.name not in others and not key.mute]


def holders(
    head: bpy.types.Object,
) -> list[tuple[bpy.types.Object, dict[str, bpy.types.ShapeKey]]]:
    """The head and its companions that have own keys of the same names, or of known names that the
    head has not; each with these keys."""
    own = {key.name: key for key in own_keys(head)}
    found = [(head, own)]
    others = [(obj, own_keys(obj)) for obj in companions.of(head)]
    blocks = head.data.shape_keys.key_blocks if head.data.shape_keys else {}
    strangers = {key.name for _, keys in others for key in keys if key.name not in blocks}
    played = own.keys() | (native.control_names().known_names(strangers) if strangers else set())
    for obj, keys in others:
        if shared := {key.name: key for key in keys if key.name in played}:
            found.append((obj, shared))
    return found


def _control_keys(head: bpy.types.Object) -> dict[str, bpy.types.ShapeKey]:
    """One key for each name, the head's where it has one."""
    keys: dict[str, bpy.types.ShapeKey] = {}
    for _, own in holders(head):
        for name, key in own.items():
            keys.setdefault(name, key)
    return keys


def driven_keys(keys: bpy.types.Key) -> set[str]:
    """Names of the shape keys that drivers set: they take no curve."""
    paths = actions.driver_paths(keys)
    return {key.name for key in keys.key_blocks if key.path_from_id("value") in paths}


def driven_remark(head: bpy.types.Object, names: Sequence[str]) -> str:
    """What to say of shape keys that a bake leaves to drivers; nothing of none."""
    if not names:
        return ""
    return iface_("drivers of {head} set {names}").format(head=head.name, names=", ".join(names))


def no_own_keys(head: bpy.types.Object | None) -> str:
    """Why nothing can be put on an object's own shape keys, or nothing."""
    if head is None or head.type != "MESH":
        return "Select the character's mesh first"
    keys = head.data.shape_keys
    if keys is not None and not keys.use_relative:
        return iface_(
            "{name}'s shape keys are absolute: only relative ones can be combined"
        ).format(name=head.name)
    if not own_keys(head):
        return iface_("{head} has no shape keys of its own that are free to move").format(
            head=head.name
        )
    return ""


def surface(head: bpy.types.Object):
    """A `mimetic.retarget.ControlSurface`: own shape keys, and muscles where there are some.

    Keys that companions alone have move nothing of it.
    """
    keys, mesh = _control_keys(head), head.data
    own = {key.name for key in own_keys(head)}
    reference = mesh.shape_keys.reference_key
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.loops.foreach_get("vertex_index", corners)
    sources = _muscles(head)
    return native.controls().ControlSurface(
        points=_points(reference),
        starts=starts,
        corners=corners,
        control_names=list(keys),
        controls=_stack(
            [
                offsets_of(head, key) if name in own else np.zeros((len(mesh.vertices), 3))
                for name, key in keys.items()
            ],
            mesh,
        ),
        control_range=_ranges(keys.values()),
        source_names=list(sources),
        sources=_stack([offsets_of(head, key) for key in sources.values()], mesh),
        source_range=_ranges(sources.values()),
    )


def ranges(head: bpy.types.Object) -> dict[str, list[float]]:
    """Least and greatest value of each own shape key, by name."""
    keys = _control_keys(head)
    return dict(zip(keys, _ranges(keys.values()).tolist(), strict=True))


def _muscles(head: bpy.types.Object) -> dict[str, bpy.types.ShapeKey]:
    """The keys of muscles, jaw, lids, lips and gaze, by the names that performances have."""
    if not len(head.mimetic.shapes):
        return {}
    blocks = head.data.shape_keys.key_blocks
    parts = native.shapes()
    left_out = (parts.DETAIL, parts.CONTACT, parts.ACTION_UNITS)
    wanted = {
        entry.shape or entry.name for entry in head.mimetic.shapes if entry.group not in left_out
    }
    return {
        shape: blocks[name] for shape, name in by_hand.keys_now(head).items() if shape in wanted
    }


def _ranges(keys) -> np.ndarray:
    """K x 2; a slider whose range does not hold 0 reaches to it."""
    rows = [(min(key.slider_min, 0.0), max(key.slider_max, 0.0)) for key in keys]
    return np.array(rows, dtype=np.float64).reshape(-1, 2)


def offsets_of(head: bpy.types.Object, key: bpy.types.ShapeKey) -> np.ndarray:
    """V x 3: what a key adds at value 1, to the key that it is relative to."""
    offsets = _points(key) - _points(key.relative_key)
    weights = sliders.group_weights(head, key.vertex_group)
    return offsets if weights is None else offsets * weights[:, None]


def rest_points(head: bpy.types.Object) -> np.ndarray:
    """V x 3: the head's mesh without its shape keys."""
    return _points(head.data.shape_keys.reference_key)


def _points(key: bpy.types.ShapeKey) -> np.ndarray:
    points = np.empty(3 * len(key.points), dtype=np.float32)
    key.points.foreach_get("co", points)
    return points.reshape(-1, 3).astype(np.float64)


def _stack(rows: list[np.ndarray], mesh: bpy.types.Mesh) -> np.ndarray:
    return np.stack(rows) if rows else np.zeros((0, len(mesh.vertices), 3))
