# SPDX-License-Identifier: GPL-3.0-or-later
"""How a written file looks when it is opened: the face over its footage, curves, sliders."""

import bpy

FULL_ZOOM = 29.0  # the camera's picture fills the view
LIFTED = ("show_floor", "show_axis_x", "show_axis_y", "show_cursor", "show_relationship_lines")
CURVES = "GRAPH_EDITOR"


def arrange(scene: bpy.types.Scene, shown: bpy.types.Object) -> None:
    """Sets every screen of the file, and makes the object active: its curves are what editors show.

    In Blender as a module, without a window, screens cannot be cut or changed for another, nor the
    editors of those not on show: the outliner of the one on show makes room for the curves.
    """
    for other in bpy.context.view_layer.objects:
        other.select_set(other == shown)
    bpy.context.view_layer.objects.active = shown
    scene.sync_mode = "FRAME_DROP"  # plays at the clip's speed
    for screen in bpy.data.screens:
        views = [area for area in screen.areas if area.type == "VIEW_3D"]
        for area in views:
            _look_through_camera(area.spaces.active)
        for area in screen.areas:
            if area.type == "PROPERTIES":
                _show_sliders(area.spaces.active)
    for screen in {window.screen for window in bpy.context.window_manager.windows}:
        for area in [area for area in screen.areas if area.type == "OUTLINER"]:
            _show_curves(area)


def _look_through_camera(space: bpy.types.SpaceView3D) -> None:
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_zoom = FULL_ZOOM
    space.shading.type = "SOLID"  # at once, without waiting for shaders to be built
    _show_as_filmed(space.shading)
    for name in LIFTED:
        setattr(space.overlay, name, False)
    space.overlay.show_outline_selected = False


def show_textures(shading: bpy.types.View3DShading) -> None:
    """In solid mode too, which shows a colour for each material: eyes would have no irises.

    Its studio light goes along where nothing was chosen by hand.
    """
    if shading.type != "SOLID" or shading.color_type != "MATERIAL":
        return
    if shading.light == "STUDIO":
        _show_as_filmed(shading)
    shading.color_type = "TEXTURE"


def _show_as_filmed(shading: bpy.types.View3DShading) -> None:
    """The skin wears the footage's colours, whose light is in them: a lamp more would darken it.
    Its form shows by cavities, in which it is darker; ridges would make lips and teeth glare."""
    shading.light = "FLAT"
    shading.color_type = "TEXTURE"
    shading.show_cavity = True
    shading.cavity_type = "BOTH"
    shading.cavity_ridge_factor = shading.curvature_ridge_factor = 0.0


def _show_sliders(space: bpy.types.SpaceProperties) -> None:
    space.context = "DATA"


def _show_curves(area: bpy.types.Area) -> None:
    area.type = CURVES
    space = area.spaces.active
    space.dopesheet.show_only_selected = True
    space.show_region_ui = False
    space.show_region_channels = False
    space.use_normalization = True  # sliders and the head's metres and angles in one picture
