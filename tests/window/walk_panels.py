# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel by itself, in a state that shows what it is for, and the window around them.

Of each the place on the screen is noted, so that pictures can be cut out (scripts/panel_pictures).
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
WIDTH = 300  # pixels of the sidebar
TABS = 22  # pixels at its right edge
SHOWN = 25  # frame of the footage: brows raised
at_first: dict[type, dict[str, object]] = {}  # panels, and what each said of itself at first


def is_idle() -> bool:
    return sys.modules[f"{PACKAGE}.jobs"].running is None


def panel_classes() -> list[type]:
    return list(sys.modules[f"{PACKAGE}.panels"].CLASSES)


def only(*names: str) -> None:
    """Show these panels alone and open: the sidebar is not as high as all of them.

    Under names of their own, as a sidebar remembers which panels are closed.
    """
    take_away()
    for panel in panel_classes():
        if panel.__name__ in names:
            parent = getattr(panel, "bl_parent_id", "")
            panel.bl_parent_id = f"{parent}_shown" if parent in names else ""
            panel.bl_idname, panel.bl_options = f"{panel.__name__}_shown", set()
            bpy.utils.register_class(panel)


def take_away() -> None:
    for panel in reversed(panel_classes()):
        if panel.is_registered and issubclass(panel, bpy.types.Panel):
            bpy.utils.unregister_class(panel)
            for name in ("bl_parent_id", "bl_options"):
                if name in vars(panel):
                    delattr(panel, name)
            for name, own in at_first[panel].items():
                setattr(panel, name, own)


def bring_the_panels_back() -> None:
    """The extension takes all of them away when it ends."""
    take_away()
    for panel in panel_classes():
        if not panel.is_registered:
            bpy.utils.register_class(panel)


def remember_panels() -> None:
    names = ("bl_idname", "bl_parent_id", "bl_options")
    for panel in panel_classes():
        if issubclass(panel, bpy.types.Panel):
            own = {name: vars(panel)[name] for name in names if name in vars(panel)}
            at_first[panel] = own


def sidebar(area: bpy.types.Area) -> bpy.types.Region:
    return next(region for region in area.regions if region.type == "UI")


def mouse(*events: tuple[str, str], x: int, y: int) -> None:
    window = bpy.context.window_manager.windows[0]
    for kind, value in events:
        window.event_simulate(type=kind, value=value, x=x, y=y)


def drag_sidebar(walk: Walk, kind: str) -> Steps:
    """To the width that the pictures have; a script cannot set it."""
    _, area = area_of(kind)
    edge, y = sidebar(area).x, area.y + area.height // 3
    target = edge + sidebar(area).width - WIDTH
    mouse(("MOUSEMOVE", "NOTHING"), x=edge, y=y)
    yield 0.2
    mouse(("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), x=edge, y=y)
    yield 0.2
    for step in range(1, 6):
        mouse(("MOUSEMOVE", "NOTHING"), x=edge + (target - edge) * step // 5, y=y)
        yield 0.05
    mouse(("LEFTMOUSE", "RELEASE"), x=target, y=y)
    yield 0.3
    width = sidebar(area).width
    walk.check(f"the sidebar of {kind} is {WIDTH} pixels wide", abs(width - WIDTH) < 8, width)
    mouse(("MOUSEMOVE", "NOTHING"), x=area.x + area.width // 4, y=area.y + 2)


def picture(walk: Walk, kind: str, panel: str, name: str = "") -> Steps:
    """A panel by itself, as `panel-NAME`; NAME is its class's, unless one is given."""
    only(f"MIMETIC_PT_{panel}")
    yield 0.4
    yield from keep(walk, kind, name or panel)


def keep(walk: Walk, kind: str, name: str) -> Steps:
    _, area = area_of(kind)
    region = sidebar(area)
    region.tag_redraw()
    window = bpy.context.window_manager.windows[0]
    top = window.height - (region.y + region.height)
    walk.arrays[f"panel-{name}"] = [region.x, top, region.width - TABS, region.height]
    yield from walk.picture(f"panel-{name}")


def one_editor(walk: Walk) -> Steps:
    """An editor as high as the window, whose sidebar lets nothing shine through."""
    bpy.context.preferences.system.use_region_overlap = False
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.screen.screen_full_area()
    yield 0.5
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    yield from become(walk, "VIEW_3D", "CLIP_EDITOR")


def become(walk: Walk, old: str, new: str) -> Steps:
    _, area = area_of(old)
    area.type = new
    yield 0.5
    if new == "CLIP_EDITOR":
        area.spaces.active.show_region_toolbar = False
    bring_the_panels_back()
    yield from open_sidebar(walk, new, "Mimetic")
    yield from drag_sidebar(walk, new)


def of_the_footage(walk: Walk) -> Steps:
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    bpy.ops.mimetic.scene_as_clip()
    only("MIMETIC_PT_capture_clip")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.find_face)
    yield 0.7
    yield from keep(walk, "CLIP_EDITOR", "at_work")
    yield from walk.until(is_idle, 120, "finding the face ends")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    yield from picture(walk, "CLIP_EDITOR", "capture_clip")
    for take in reversed(walk.settings["takes"]):
        bpy.ops.mimetic.load_performance(filepath=str(walk.folder / take))
    go_to(SHOWN)
    yield from picture(walk, "CLIP_EDITOR", "captured_takes")
    yield from picture(walk, "CLIP_EDITOR", "clip_overlays")
    only("MIMETIC_PT_capture_clip", "MIMETIC_PT_clip_overlays")
    yield from walk.picture("window-captured")
    yield from corrected(walk)
    invoke("CLIP_EDITOR", bpy.ops.mimetic.hold_head_still)
    yield from walk.until(is_idle, 60, "holding the head still ends")
    yield from picture(walk, "CLIP_EDITOR", "head_clip")
    bpy.ops.mimetic.release_head()


def go_to(frame: int) -> None:
    """As keys and the timeline do it: `frame_set` leaves the editor's picture behind."""
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.screen.frame_offset(delta=frame - bpy.context.scene.frame_current)


def corrected(walk: Walk) -> Steps:
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.mimetic.correct_value(frame=SHOWN, value_name="jaw_open", value=0.2)
        bpy.ops.mimetic.correct_pose(frame=SHOWN + 15, turn=(0.0, 2.0, 0.0))
    yield from picture(walk, "CLIP_EDITOR", "corrections")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        for frame in (SHOWN, SHOWN + 15):
            bpy.ops.mimetic.delete_correction(frame=frame)


def bake(walk: Walk, take: str) -> Steps:
    bpy.ops.mimetic.load_performance(filepath=str(walk.folder / take))
    invoke("VIEW_3D", bpy.ops.mimetic.bake)
    yield from walk.until(is_idle, 120, f"the bake of {take} ends")


def of_the_face(walk: Walk) -> Steps:
    for take in reversed(walk.settings["takes"]):
        yield from bake(walk, take)
        bpy.ops.mimetic.smooth_curves(seconds=0.1)
    yield from picture(walk, "VIEW_3D", "capture_view")
    yield from picture(walk, "VIEW_3D", "takes")
    yield from picture(walk, "VIEW_3D", "curves")
    bpy.context.scene.frame_set(SHOWN)
    only("MIMETIC_PT_muscles")
    yield 0.5
    yield from open_first_group()
    yield from keep(walk, "VIEW_3D", "muscles")
    settings = bpy.context.scene.mimetic
    settings.show_muscles = settings.show_strain = True
    yield from picture(walk, "VIEW_3D", "overlays")
    only("MIMETIC_PT_muscles", "MIMETIC_PT_overlays")
    yield from walk.picture("window-muscles")
    settings.show_muscles = settings.show_strain = False
    bpy.ops.mimetic.keep_expression(name="Brows", kind="MOTION", frame_first=10, frame_last=45)
    yield from picture(walk, "VIEW_3D", "expressions")


def of_the_curves(walk: Walk) -> Steps:
    face = bpy.context.scene.mimetic.face
    bpy.context.view_layer.objects.active = face
    rows = sys.modules[f"{PACKAGE}.scene_out"].face_curves.of(face)
    keys = {row.shape: max(key.co.y for key in row.curve.keyframe_points) for row in rows}
    strongest = max(rows[:36], key=lambda row: keys[row.shape])  # of the muscles
    members = [row.shape for row in rows[:36] if row.group == strongest.group]
    selected = sorted(members, key=lambda name: -keys[name])[:2]
    for row in rows:
        row.curve.select = row.shape in selected
        row.curve.hide = row.shape not in members
    for curve in sys.modules[f"{PACKAGE}.scene_out"].face_curves.head_curves(face):
        curve.hide = True
    yield from become(walk, "VIEW_3D", "GRAPH_EDITOR")
    with bpy.context.temp_override(**override("GRAPH_EDITOR")):
        bpy.ops.graph.view_selected()
    yield from picture(walk, "GRAPH_EDITOR", "error_bars")
    yield from walk.picture("window-error-bars")
    yield from become(walk, "GRAPH_EDITOR", "VIEW_3D")


def open_first_group() -> Steps:
    """By a click on its arrow; what is open is no setting that a script reaches."""
    region = sidebar(area_of("VIEW_3D")[1])
    x, y = region.x + 36, region.y + region.height - 99
    mouse(("MOUSEMOVE", "NOTHING"), x=x, y=y)
    yield 0.2
    mouse(("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE"), x=x, y=y)
    yield 0.3


def of_characters(walk: Walk) -> Steps:
    """An armature whose head the performance turns, a mesh with shape keys of its own."""
    rig = bpy.data.objects.new("Hero Rig", bpy.data.armatures.new("Hero Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, bottom, top in (("neck", 1.4, 1.5), ("head", 1.5, 1.7)):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, bottom), (0, 0, top)
        bone.parent = rig.data.edit_bones.get("neck") if name == "head" else None
    bpy.ops.object.mode_set(mode="OBJECT")
    head = bpy.context.scene.mimetic.head
    head.target = rig
    bpy.ops.mimetic.find_head_bones()
    yield from picture(walk, "VIEW_3D", "head_view")
    face = bpy.context.scene.mimetic.face
    bpy.context.view_layer.objects.active = face
    bpy.ops.mimetic.add_arkit_shapes()
    bpy.ops.mimetic.fit_controls()
    yield from walk.until(is_idle, 120, "fitting the controls ends")
    face.mimetic.active_control = 24
    yield from picture(walk, "VIEW_3D", "controls")


def of_a_camera(walk: Walk) -> Steps:
    live = bpy.context.scene.mimetic.live
    live.source, live.clip_path = "CLIP", f"//{walk.settings['clip']}"
    yield from picture(walk, "VIEW_3D", "live")
    bpy.ops.mimetic.add_usual_looks()
    yield from picture(walk, "VIEW_3D", "live_looks")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    remember_panels()
    yield from one_editor(walk)
    yield from of_the_footage(walk)
    yield from become(walk, "CLIP_EDITOR", "VIEW_3D")
    yield from of_the_face(walk)
    yield from of_the_curves(walk)
    yield from of_characters(walk)
    yield from of_a_camera(walk)
    names = {panel.__name__ for panel in panel_classes() if issubclass(panel, bpy.types.Panel)}
    walk.arrays["panels"] = sorted(names)
    bring_the_panels_back()


start(steps)
