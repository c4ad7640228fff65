# SPDX-License-Identifier: GPL-3.0-or-later
"""What 3D views show of a scene's face: settings in `scene.mimetic`."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty

from . import editors
from .scene_out import cover

STRAIN_MEASURES = (
    ("AREA", "Area", "Growth of the skin's area"),
    ("STRETCH", "Stretch", "Strain along the direction in which the skin gets longest"),
    ("COMPRESSION", "Compression", "Strain along the direction in which the skin gets shortest"),
)


def _redraw(self, context) -> None:
    editors.redraw("VIEW_3D")


def _cover(self) -> float:
    return cover.of(self.camera.data) if self.camera else 1.0


def _set_cover(self, value: float) -> None:
    if self.camera:
        cover.set_to(self.camera.data, value)


class FaceViewSettings:
    """Mixin of `scene.mimetic`."""

    face_cover: FloatProperty(
        name="Face over Footage",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        get=_cover,
        set=_set_cover,
        options={"SKIP_SAVE"},
        description="In the camera's view, how much of the face covers the footage: 1 shows the "
        "face, 0 the footage alone",
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
    strain_measure: EnumProperty(
        name="Strain", items=STRAIN_MEASURES, update=_redraw, description="What the colours show"
    )
    strain_limit: FloatProperty(
        name="Scale",
        description="Strain at which the colours end",
        default=30.0,
        min=0.1,
        soft_max=100.0,
        subtype="PERCENTAGE",
        update=_redraw,
    )
