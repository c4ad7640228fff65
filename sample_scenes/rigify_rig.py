# SPDX-License-Identifier: GPL-3.0-or-later
"""A rig that Rigify has generated: of its human spine, neck and head, or all of it.

    python rigify_rig.py OUT.blend

A process of its own: Blender 4.5 as a module does not come to its end once Rigify has been in it.
"""

import os
import sys
import tempfile


def generate_rig(with_face: bool = False, has_new_face: bool = False, with_body: bool = False):
    """Rigify's human, from the hips to the head, generated in the open file.

    with_face: with the bones of its (legacy) face too; has_new_face: upgraded to the face of skin
    chains, as Rigify's own button does; with_body: with arms and legs.
    """
    import bpy

    def is_of_face(bone) -> bool:
        return any(parent.name == "spine.006" for parent in bone.parent_recursive)

    def stays(bone) -> bool:
        of_head = with_face and is_of_face(bone)
        return of_head or bone.name.startswith("spine") or (with_body and not is_of_face(bone))

    bpy.ops.preferences.addon_enable(module="rigify")
    bpy.ops.object.armature_human_metarig_add()
    metarig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bones = metarig.data.edit_bones
    for bone in [bone for bone in bones if not stays(bone)]:
        bones.remove(bone)
    if has_new_face:
        bpy.ops.object.mode_set(mode="POSE")
        bpy.ops.pose.rigify_upgrade_face()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.pose.rigify_generate()
    metarig.hide_render = True
    metarig.hide_set(True)
    return bpy.context.object


def write(path: str) -> None:
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    generate_rig()
    bpy.ops.wm.save_as_mainfile(filepath=path)


if __name__ == "__main__":
    # Read by bpy as it is imported: no settings or add-ons of the user's
    with tempfile.TemporaryDirectory() as folder:
        os.environ["BLENDER_USER_RESOURCES"] = folder
        write(sys.argv[1])
    sys.stdout.flush()
    os._exit(0)
