# SPDX-License-Identifier: GPL-3.0-or-later
"""What F12 renders: the face over its footage.

Blender renders no background of a camera: the footage comes in by compositor nodes, behind a film
that is transparent where nothing is. Whoever has nodes of their own keeps the scene as it is.
"""

from __future__ import annotations

import re

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix

from .. import compat, native, scene_in
from . import face_lights
from .camera import SOLID_TYPES

NAME = "Footage behind the Face"
MADE = "mimetic_made"  # property of the nodes' tree that we made
# Names of its nodes
SOURCE, FRAMING, IN_REGION = "Footage", "Footage in the Picture", "Footage in the Render Region"
AS_FILMED = "Standard"
# Formulas of the picture's pixels along an axis, and of those at which the render region begins
# and ends there, rounded as Blender does. Its floats are coarser than a formula's numbers, hence
# the factor: .7 of 1000 is a little less than 700 here, and 700 there
WHOLE = "floor(side*percent/100)"
FIRST, END = (f"floor({edge}*1.00000004*{WHOLE})" for edge in ("first", "end"))


def set_up(scene: bpy.types.Scene, face: bpy.types.Object, performance, with_lights=True) -> str:
    """Puts the footage behind the scene's camera behind the face in renders too.

    Returns what the user should know, or nothing. What was changed on nodes that an earlier bake
    made stays: only the footage is put in anew.
    """
    images = scene.camera.data.background_images
    if not images:
        return ""
    tree = compat.compositor(scene)
    if tree is not None and tree.nodes and MADE not in tree:
        return rpt_(
            "renders are composed by nodes of your own: put the footage behind the face there "
            "(Film > Transparent, Alpha Over)"
        )
    remarks = []
    if tree is None or not tree.nodes:
        tree = _new_tree(scene)
        scene.render.film_transparent = True
        scene.render.use_compositing = True
        remarks = [_clear_the_way(scene, face), _show_as_filmed(scene, face)]
    _put_in(tree, scene.camera.data)
    _frame(tree, scene, performance)
    if with_lights:
        face_lights.ensure(scene, face)
    return "; ".join(filter(None, remarks))


def _new_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    tree, result = compat.new_compositor(scene, NAME)
    tree[MADE] = True
    nodes, links = tree.nodes, tree.links
    stretch, framing = nodes.new("CompositorNodeScale"), nodes.new("CompositorNodeScale")
    compat.stretch_to_render(stretch)
    framing.name = framing.label = FRAMING
    in_region = nodes.new("CompositorNodeTranslate")
    in_region.name = in_region.label = IN_REGION
    source = _new_source(tree, "CompositorNodeMovieClip")
    rendered, over = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeAlphaOver")
    behind, before = compat.alpha_over(over)
    links.new(source.outputs["Image"], stretch.inputs["Image"])
    links.new(stretch.outputs["Image"], framing.inputs["Image"])
    links.new(framing.outputs["Image"], in_region.inputs["Image"])
    links.new(in_region.outputs["Image"], behind)
    links.new(rendered.outputs["Image"], before)
    links.new(over.outputs["Image"], result)
    places = ((source, 0, 0), (stretch, 250, 0), (framing, 450, 0), (in_region, 650, 0))
    places += ((rendered, 350, 400), (over, 850, 150), (result.node, 1050, 150))
    for node, x, y in places:
        node.location = (x, y)
    return tree


def _new_source(tree: bpy.types.NodeTree, kind: str) -> bpy.types.Node:
    source = tree.nodes.new(kind)
    source.name = source.label = SOURCE
    return source


def _put_in(tree: bpy.types.NodeTree, camera: bpy.types.Camera) -> None:
    """The picture that the camera's view shows behind the face, frame by frame."""
    source = tree.nodes.get(SOURCE)
    if source is None:
        return  # taken out by hand
    behind = camera.background_images[0]
    is_clip = behind.source == "MOVIE_CLIP"
    kind = "CompositorNodeMovieClip" if is_clip else "CompositorNodeImage"
    tree.driver_remove(f'nodes["{SOURCE}"].frame_offset')
    if source.bl_idname != kind:
        takers = [link.to_socket for link in source.outputs["Image"].links]
        place = source.location[:]
        tree.nodes.remove(source)
        source = _new_source(tree, kind)
        source.location = place
        for taker in takers:
            tree.links.new(source.outputs["Image"], taker)
    if is_clip:
        source.clip = behind.clip
        return
    source.image = behind.image
    user = behind.image_user
    source.frame_start, source.frame_duration = user.frame_start, user.frame_duration
    source.use_auto_refresh = True
    path = "background_images[0].image_user.frame_offset"
    compat.follow(tree, f'nodes["{SOURCE}"].frame_offset', camera, "CAMERA", path)


def _frame(tree: bpy.types.NodeTree, scene: bpy.types.Scene, performance) -> None:
    """Fits the footage whole into the picture, as the camera's view does, of which a cropped render
    has its region.

    The camera goes on fitting the same side when the picture gets another size: so does this.
    """
    size, aspect = scene_in.picture_size(scene), scene_in.pixel_aspect(scene)
    lens = native.placement().lens(performance.intrinsics, performance.image_size, size, aspect)
    of_axes = zip(("xy", "yx"), lens.covered, performance.image_size, strict=True)
    for (beside, along), share, pixels in of_axes:
        times = ""
        if beside == ("x" if lens.fit == "VERTICAL" else "y"):
            share *= scene_in.side(scene, beside) / scene_in.side(scene, along)
            times = f"*{along}*pixel_{along}/{beside}/pixel_{beside}"
        factor, moved = f"{share:.9g}{times}", f"({WHOLE}-{FIRST}-{END})/2"
        if compat.RENDER_SIZE_IS_CROPPED:
            factor += f"*(1+region*crop*({WHOLE}/max({END}-{FIRST},1)-1))"
        else:  # pictures lie on whole pixels
            moved = f"ceil({moved})"
        if compat.PIXELS_ARE_ALIGNED:  # as it is in the whole picture
            half = (-0.5 if pixels % 2 else 0.5) / pixels * share / 100
            moved += f"+{half:.6g}{times}*side*percent*(fmod({END}-{FIRST},2)-fmod({WHOLE},2))"
        _drive(tree, scene, FRAMING, beside, factor)
        _drive(tree, scene, IN_REGION, beside, f"region*crop*({moved})")


def _drive(
    tree: bpy.types.NodeTree, scene: bpy.types.Scene, name: str, axis: str, formula: str
) -> None:
    """Has the input of a node for an axis follow a formula of the scene's render settings."""
    node = tree.nodes.get(name)
    if node is None:
        return  # taken out by hand
    path = node.inputs[axis.upper()].path_from_id("default_value")
    tree.driver_remove(path)
    settings = {
        "percent": "resolution_percentage",
        "region": "use_border",
        "crop": "use_crop_to_border",
        "side": f"resolution_{axis}",
        "first": f"border_min_{axis}",
        "end": f"border_max_{axis}",
    }
    for side in "xy":
        settings |= {side: f"resolution_{side}", f"pixel_{side}": f"pixel_aspect_{side}"}
    # A driver's formula has 255 characters at most
    short = {word: chr(ord("A") + i) for i, word in enumerate(settings)}
    formula = re.sub("|".join(rf"\b{word}\b" for word in short), lambda m: short[m[0]], formula)
    used = {short[w]: f"render.{settings[w]}" for w in settings if short[w] in formula}
    compat.compute(tree, path, scene, "SCENE", used, formula)


def _clear_the_way(scene: bpy.types.Scene, face: bpy.types.Object) -> str:
    """The start-up cube stands around the camera: rendered, its walls would hide the footage."""
    for other in scene.objects:
        if other != face and is_start_up_cube(other) and not other.hide_render:
            other.hide_render = True
            return rpt_("{other}, in which the camera stands, is left out of renders").format(
                other=other.name
            )
    return ""


def is_start_up_cube(candidate: bpy.types.Object) -> bool:
    """Whether an object is the cube of a new file, as it is there."""
    if candidate.type != "MESH" or candidate.name != "Cube" or candidate.modifiers:
        return False
    corners = {tuple(vertex.co) for vertex in candidate.data.vertices}
    is_whole = len(candidate.data.vertices) == len(corners) == 8
    is_cube = all(abs(abs(part) - 1) < 1e-6 for corner in corners for part in corner)
    at_start = candidate.matrix_basis == Matrix.Identity(4)
    return is_whole and is_cube and at_start and not candidate.animation_data


def _show_as_filmed(scene: bpy.types.Scene, face: bpy.types.Object) -> str:
    """Footage and skin have the footage's colours, which other transforms would change."""
    view = scene.view_settings
    if view.view_transform == AS_FILMED:
        return ""
    before = view.view_transform
    if any(o.type in SOLID_TYPES and o != face and not o.hide_render for o in scene.objects):
        return iface_(
            "renders change the footage's colours by {before} (View Transform, Color Management)"
        ).format(before=before)
    view.view_transform = AS_FILMED
    return iface_("View Transform is {now} instead of {before}: colours are as filmed").format(
        now=AS_FILMED, before=before
    )
