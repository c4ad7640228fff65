# SPDX-License-Identifier: GPL-3.0-or-later
"""What was changed by hand on a face since its shape keys were written.

Beside each key's name the face keeps fingerprints of what the key was given. A key that was
renamed is known by its points, or by its place among the others.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from bpy.app.translations import pgettext_iface as iface_

from .. import mesh_frame, native
from .contact import KEY, points_of

NEAR = 1e-6  # of limits, which are single precision
MOST_TOLD = 6  # things in one line


@dataclass(frozen=True)
class KeyState:
    """A shape key that the face was given before, as it is now."""

    key: str  # its name now
    is_renamed: bool = False
    is_sculpted: bool = False
    has_own_limits: bool = False

    def is_changed(self) -> bool:
        return self.is_renamed or self.is_sculpted or self.has_own_limits


@dataclass
class HandChanges:
    """Changes made by hand that a face keeps, for a message."""

    things: list[str] = field(default_factory=list)

    def text(self) -> str:
        if not self.things:
            return ""
        return iface_("kept as changed by hand: {what}").format(what=told(self.things))

    def add(self, shape: str, state: KeyState) -> None:
        if state.is_renamed:
            self.things.append(
                iface_("the name {key} of {shape}").format(key=state.key, shape=shape)
            )
        if state.is_sculpted:
            self.things.append(iface_("the shape of {shape}").format(shape=shape))
        if state.has_own_limits:
            self.things.append(iface_("the limits of {shape}").format(shape=shape))


def told(things: list[str]) -> str:
    """The first of these things, and how many more there are."""
    more = len(things) - MOST_TOLD
    text = ", ".join(things[:MOST_TOLD])
    return text + (iface_(" and {count} more").format(count=more) if more > 0 else "")


def look(face) -> dict[str, KeyState]:
    """Shapes that the face has from before, by the name they were given; none of ARKit's."""
    return _states(face, entries_of(face))


def look_units(face) -> dict[str, KeyState]:
    """ARKit's shapes that the face was given before, by their names."""
    return _states(face, units_of(face))


def keys_now(face) -> dict[str, str]:
    """Name of the key that is each shape now, also of those that were renamed by hand."""
    return _keys_of(face, entries_of(face))


def all_keys_now(face) -> dict[str, str]:
    """As `keys_now`, with ARKit's shapes that the face was given."""
    return _keys_of(face, units_of(face)) | keys_now(face)


def shapes_by_name(face) -> dict[str, str]:
    """The shape, ARKit's too, by each name that its key has or is known to have had."""
    shapes = {key: shape for shape, key in all_keys_now(face).items()}
    known = {**units_of(face), **entries_of(face)}
    for shape, entry in known.items():
        shapes.setdefault(entry.name, shape)
    for shape in known:
        shapes.setdefault(shape, shape)
    return shapes


def entries_of(face) -> dict:
    """What is remembered of each shape, by the name it was given; groups last."""
    own = (*face.mimetic.shapes, *face.mimetic.groups)
    return {entry.shape or entry.name: entry for entry in own}


def units_of(face) -> dict:
    """What is remembered of each of ARKit's shapes that the face was given, by its name."""
    return {entry.shape: entry for entry in face.mimetic.units}


def remember(entry, key, basis, offsets: np.ndarray, lowest: float, highest: float) -> None:
    """Stores with an entry what we wrote to its key, even where the key keeps a change by hand."""
    fingerprint, face = native.fingerprint().fingerprint, entry.id_data
    noted = mesh_frame.noted_from_now(face.mimetic.mesh_frame, face)
    entry.name, entry.lowest, entry.highest = key.name, lowest, highest
    entry.offsets = fingerprint(_turned(offsets, noted))
    entry.points = fingerprint(_placed((basis + offsets).astype(np.float32), noted))
    entry.place = 0  # until all keys have theirs


def remember_names(face) -> None:
    """Stores the names that keys have now, by which they are known once they are renamed again."""
    for entries in (units_of(face), entries_of(face)):
        for shape, key in _keys_of(face, entries).items():
            if entries[shape].shape:  # else its name is all that is known of it
                entries[shape].name = key


def remember_places(face) -> None:
    """Stores each key's position among the others."""
    blocks, units = face.data.shape_keys.key_blocks, units_of(face)
    for shape, key in _keys_of(face, units).items():
        units[shape].name = key  # one that was renamed is not looked for by its old place any more
    places = {key.name: i for i, key in enumerate(blocks)}
    for entry in (*entries_of(face).values(), *units.values()):
        entry.place = places.get(entry.name, -1)
    face.mimetic.num_keys = _count(blocks)


def is_rest_sculpted(face) -> bool:
    """Whether the basis is not as we wrote it."""
    entry, basis = face.mimetic.rest, points_of(face.data.shape_keys.reference_key)
    parts = native.fingerprint()
    is_noted = entry.place >= 0
    return is_noted and not parts.is_same(parts.fingerprint(basis), entry.points, _largest(basis))


def _states(face, entries: dict) -> dict[str, KeyState]:
    if not entries:
        return {}
    keys = _keys_of(face, entries)
    return {shape: _compare(face, entries[shape], key) for shape, key in keys.items()}


def _compare(face, entry, name: str) -> KeyState:
    keys = face.data.shape_keys
    key, basis = keys.key_blocks[name], points_of(keys.reference_key)
    is_renamed = name != (entry.shape or entry.name)
    if entry.place < 0:
        return KeyState(name, is_renamed)
    limits = np.subtract((key.slider_min, key.slider_max), (entry.lowest, entry.highest))
    has_own_limits = bool(np.abs(limits).max() > NEAR)
    # With other vertices nothing can be compared, and a key kept then is one without its muscle
    is_cut = mesh_frame.is_cut(face.mimetic.mesh_frame, face)
    is_sculpted = not is_cut and not _is_as_given(entry, key, basis)
    return KeyState(name, is_renamed, is_sculpted, has_own_limits)


def _is_as_given(entry, key, basis) -> bool:
    """Unchanged, or moved with a basis that was sculpted, or with the whole mesh by Apply."""
    points, face = points_of(key), entry.id_data
    if _is_same(entry, points, points - basis, _largest(basis)):
        return True
    noted = mesh_frame.noted_from_now(face.mimetic.mesh_frame, face)
    if np.array_equal(noted, np.eye(4)):
        return False
    largest = float(np.abs(noted[:3, :3]).sum(axis=1).max()) * _largest(basis)
    return _is_same(entry, _placed(points, noted), _turned(points - basis, noted), largest)


def _is_same(entry, points: np.ndarray, offsets: np.ndarray, largest: float) -> bool:
    parts = native.fingerprint()
    return parts.is_same(parts.fingerprint(points), entry.points, largest) or parts.is_same(
        parts.fingerprint(offsets), entry.offsets, largest
    )


def _placed(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    return _turned(points, matrix) + matrix[:3, 3]


def _turned(offsets: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    return offsets @ matrix[:3, :3].T


def _largest(basis: np.ndarray) -> float:
    return float(np.abs(basis).max())


def _keys_of(face, entries: dict) -> dict[str, str]:
    """Name of the key that is each shape now; shapes whose key was deleted are left out."""
    blocks = face.data.shape_keys.key_blocks
    keys = {shape: entry.name for shape, entry in entries.items() if entry.name in blocks}
    missing = {shape: entry for shape, entry in entries.items() if shape not in keys}
    if not missing:
        return keys
    basis = points_of(face.data.shape_keys.reference_key)
    known = (*entries_of(face).values(), *units_of(face).values())
    used_names = {face.data.shape_keys.reference_key.name, KEY, *(entry.name for entry in known)}
    places = {blocks.find(keys[s]): entries[s].place for s in keys if entries[s].place >= 0}
    for shape, entry in missing.items():
        if entry.place < 0:
            continue
        free = [key for key in blocks if key.name not in used_names]
        key = next((key for key in free if _is_as_given(entry, key, basis)), None)
        if key is None:
            i = _place_now(entry.place, places, _count(blocks), face.mimetic.num_keys)
            key = blocks[i] if i is not None and blocks[i] in free else None
        if key is not None:
            keys[shape] = key.name
            used_names.add(key.name)
    return keys


def _count(blocks) -> int:
    """Of keys but for contact's, which comes and goes and is the last."""
    return len(blocks) - (KEY in blocks)


def _place_now(place: int, places: dict[int, int], num_keys: int, num_before: int) -> int | None:
    """Number of the key that was number `place`, if those around it are as far apart as before.

    places: of the keys that are known, now and before.
    """
    ends = {0: 0, **places, num_keys: num_before}
    below = max((now for now, before in ends.items() if before < place), default=0)
    above = min((now for now, before in ends.items() if before > place), default=num_keys)
    if above - below != ends[above] - ends[below]:
        return None
    return below + place - ends[below]
