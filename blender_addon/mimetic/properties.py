# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene remembers of its capture, and a face of its shapes: `scene.mimetic`,
`object.mimetic`."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

STRAIN_MEASURES = (
    ("AREA", "Area", "Growth of the skin's area"),
    ("STRETCH", "Stretch", "Strain along the direction in which the skin gets longest"),
    ("COMPRESSION", "Compression", "Strain along the direction in which the skin gets shortest"),
)


def _is_mesh(self, candidate) -> bool:
    return candidate.type == "MESH"


def _redraw(self, context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class MimeticShape(bpy.types.PropertyGroup):
    """A shape key of a face, by its name."""

    group: StringProperty(name="Group", description="What its slider is listed under")


class MimeticFace(bpy.types.PropertyGroup):
    shapes: CollectionProperty(type=MimeticShape, description="Shape keys that the face was given")
    groups: CollectionProperty(type=MimeticShape, description="Shape keys that move whole groups")


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
    show_muscles: BoolProperty(
        name="Muscles",
        description="Draw the muscles and their insertions over the face",
        update=_redraw,
    )
    show_strain: BoolProperty(
        name="Skin Strain",
        description="Colour the skin by how it is stretched from rest",
        update=_redraw,
    )
    strain_measure: EnumProperty(name="Strain", items=STRAIN_MEASURES, update=_redraw)
    strain_limit: FloatProperty(
        name="Scale",
        description="Strain at which the colours end",
        default=30.0,
        min=0.1,
        soft_max=100.0,
        subtype="PERCENTAGE",
        update=_redraw,
    )


CLASSES = (MimeticShape, MimeticFace, MimeticScene)


def register() -> None:
    for group in CLASSES:
        bpy.utils.register_class(group)
    bpy.types.Scene.mimetic = PointerProperty(type=MimeticScene)
    bpy.types.Object.mimetic = PointerProperty(type=MimeticFace)


def unregister() -> None:
    del bpy.types.Object.mimetic
    del bpy.types.Scene.mimetic
    for group in reversed(CLASSES):
        bpy.utils.unregister_class(group)
