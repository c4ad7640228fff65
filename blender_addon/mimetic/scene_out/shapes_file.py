# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's 52 shapes on a head in a copy of a .blend, or as .glb: what `mimetic shapes` calls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from .. import heads, native, writable
from . import arkit, blend_file, gltf, part_keys, rig_file


def write(out: str, file: str, name: str, landmarks_path: str | None) -> str:
    """Opens `file`, gives its object `name` the shapes, and writes `out` whole.

    Landmarks are those of the file, else those that the head was attached by, empties and vertex
    groups with their names, else they place themselves. Returns what was written.
    """
    where = Path(file).name
    scene = rig_file.open_file(file, where)
    head = rig_file.find_object(scene, where, name)
    if head.type != "MESH" or head.mode == "EDIT":
        state = "was saved in edit mode; leave it and save" if head.type == "MESH" else "is no mesh"
        raise native.invalid_input(f"{where}:{name} {state}")
    writable.check(writable.no_shapes(head))
    own, remark = _marked(scene, head, landmarks_path)
    parts = native.foreign_face()
    face = parts.attach_face(*own.whole, own.landmarks, own.matrix)
    shapes, notes = face.unit_shapes()
    shapes, of_parts = part_keys.split(own, shapes)
    written = arkit.write(head, shapes)
    moved, part_notes = part_keys.add(head, own, of_parts, written.names)
    left_out = ""
    if Path(out).suffix == ".glb":
        left_out = gltf.export(scene, out, head, is_animated=False)
    else:
        blend_file.save_copy(Path(out).absolute(), with_paths_anew=True)
    text = f"{len(written.names)} of ARKit's shapes on {name}"
    if moved:
        text += f"; {', '.join(moved)} moved along"
    if worn := part_keys.of_worn(own):
        text += f"; {worn}"
    if written.kept:
        text += f"; {len(written.kept)} keys of such names stay as they were"
    if changes := written.hand_changes.text():
        text += f"; {changes}"
    return "; ".join(filter(None, (text, left_out, remark, *face.notes, *notes, *part_notes)))


def _marked(scene, head, landmarks_path: str | None) -> tuple[heads.ForeignHead, str]:
    """The head with its landmarks, and what to know of them."""
    own = heads.bound_head(scene, head)
    if landmarks_path:
        marks = native.landmarks_file().read_landmarks(Path(landmarks_path))
        return replace(own, landmarks=marks), ""
    if own.landmarks:
        return own, ""
    marks = native.self_landmarks().find_on_object(*own.whole, own.matrix)
    if marks.guess:
        raise native.invalid_input(f"{head.name}: {marks.guess}; give the places by --landmarks")
    doubtful = f"doubtful landmarks: {', '.join(marks.doubtful)}" if marks.doubtful else ""
    return replace(own, landmarks=marks.places), doubtful
