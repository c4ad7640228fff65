# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene remembers of its capture: `scene.mimetic`."""

import bpy
from bpy.props import BoolProperty, IntProperty, PointerProperty, StringProperty


def _is_mesh(self, candidate) -> bool:
    return candidate.type == "MESH"


class MimeticScene(bpy.types.PropertyGroup):
    clip: PointerProperty(
        name="Footage", type=bpy.types.MovieClip, description="Movie clip with the face"
    )
    face_fit: PointerProperty(
        name="Face Fit",
        type=bpy.types.Text,
        description="The person found in the footage: head shape, pose and camera, as JSON",
    )
    use_frame_range: BoolProperty(
        name="Part of the Clip", description="Capture only some of the footage's frames"
    )
    frame_first: IntProperty(
        name="First", default=1, min=1, description="First footage frame to capture"
    )
    frame_last: IntProperty(
        name="Last", default=100, min=1, description="Last footage frame to capture"
    )
    performance_path: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        description="Captured performance (.npz) to bake",
    )
    face: PointerProperty(
        name="Face",
        type=bpy.types.Object,
        poll=_is_mesh,
        description="The baked face; baking again updates it",
    )
    camera: PointerProperty(
        name="Camera", type=bpy.types.Object, description="The footage's camera in the scene"
    )


def register() -> None:
    bpy.utils.register_class(MimeticScene)
    bpy.types.Scene.mimetic = PointerProperty(type=MimeticScene)


def unregister() -> None:
    del bpy.types.Scene.mimetic
    bpy.utils.unregister_class(MimeticScene)
