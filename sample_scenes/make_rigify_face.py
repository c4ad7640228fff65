# SPDX-License-Identifier: GPL-3.0-or-later
"""Build a .blend of the canonical head on the face that Rigify generates, with muscles attached.

`mimetic bake --target OUT.blend:rig --controls own` then plays a performance on its bones.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

import blender_module
from rigify_body import SKULL

EYES = ("ORG-eye.L", "ORG-eye.R")
IDLE = 1, 240  # frames in which the body moves
# Parts that are stiff, and the deform bones that carry them: of the new face, else of the legacy
STIFF = {
    "eye.L": ("DEF-eye.L", "ORG-eye.L"),
    "eye.R": ("DEF-eye.R", "ORG-eye.R"),
    "teeth_upper": ("DEF-teeth.T", SKULL),
    "teeth_lower": ("DEF-teeth.B", "DEF-jaw"),
    "tongue": ("DEF-tongue",),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="write this .blend")
    parser.add_argument(
        "--new-face", action="store_true", help="Rigify's face of skin chains, not the legacy one"
    )
    parser.add_argument(
        "--body", action="store_true", help="with a body, arms and legs, which move by hand"
    )
    arguments = parser.parse_args()
    return blender_module.run(
        "make_rigify_face",
        lambda _folder: build(arguments.out, arguments.new_face, arguments.body),
    )


def build(out: Path, has_new_face: bool, has_body: bool) -> None:
    import bpy
    from rigify_body import animate

    head, rig = new_character(has_new_face, has_body)
    if has_body:
        animate(rig, *IDLE)
    out.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(out.resolve()), compress=True)
    print(f"{out}: {len(head.vertex_groups)} groups of {head.name} on {rig.name}")


def new_character(has_new_face: bool, has_body: bool = False):
    """The head with muscles, and its rig, which is active."""
    import bpy
    import head_scene
    from mimetic.character.foreign_mesh import REQUIRED
    from mimetic.template.face_template import load_template
    from rigify_body import add_body, deformed_by, is_limb
    from rigify_rig import generate_rig

    rig = generate_rig(with_face=True, has_new_face=has_new_face, with_body=has_body)
    if has_body:
        add_body(rig)
    template = load_template()
    eyes = np.array([rig.data.bones[name].head_local for name in EYES])
    head = head_scene.new_head(template, _onto(template, eyes))
    head.modifiers.clear()
    for name in REQUIRED:
        head.vertex_groups.new(name=name).add([template.landmark(name)], 1.0, "REPLACE")
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    bpy.context.view_layer.objects.active = head
    bpy.ops.mimetic.attach_muscles()
    head.select_set(True)
    rig.select_set(True)
    bpy.context.view_layer.objects.active = rig
    with deformed_by(rig, lambda name: not is_limb(name)):
        bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    _stiffen(head, rig, template)
    return head, rig


def _stiffen(head, rig, template) -> None:
    """Each stiff part on one bone: automatic weights give eyes to lids and teeth to lips."""
    deforming = [group for group in head.vertex_groups if group.name in rig.data.bones]
    for part, bones in STIFF.items():
        vertices = [int(vertex) for vertex in template.part_vertices(part)]
        for group in deforming:
            group.remove(vertices)
        name = next(bone for bone in bones if bone in rig.data.bones)
        rig.data.bones[name].use_deform = True  # what turns an eye of the legacy face does not
        group = head.vertex_groups.get(name) or head.vertex_groups.new(name=name)
        group.add(vertices, 1.0, "REPLACE")


def _onto(template, eyes: np.ndarray) -> np.ndarray:
    """V x 3, head frame: the head moved and scaled so that its eyes are at these (object frame)."""
    own = np.asarray(template.eye_centers)
    there = np.stack([eyes[:, 0], eyes[:, 2], -eyes[:, 1]], axis=1)
    scale = np.linalg.norm(there[0] - there[1]) / np.linalg.norm(own[0] - own[1])
    return scale * (template.vertices - own.mean(axis=0)) + there.mean(axis=0)


if __name__ == "__main__":
    sys.exit(main())
