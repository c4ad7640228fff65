# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a .blend with a rig that Rigify has generated: spine, neck and head of its human.

    python make_rig.py OUT.blend

A process of its own: Blender 4.5 as a module does not come to its end once Rigify has been in it.
"""

import os
import sys
import tempfile

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="mimetic-rigify-")

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="rigify")
bpy.ops.object.armature_human_metarig_add()
metarig = bpy.context.object
bpy.ops.object.mode_set(mode="EDIT")
bones = metarig.data.edit_bones
for bone in [bone for bone in bones if not bone.name.startswith("spine")]:
    bones.remove(bone)
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.pose.rigify_generate()
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
sys.stdout.flush()
os._exit(0)
