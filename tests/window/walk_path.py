# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole way in a window: load the clip, find the face, capture, stop, capture, bake, export."""

import importlib
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import (
    Steps,
    Walk,
    area_of,
    install,
    invoke,
    open_sidebar,
    override,
    press,
    split_view,
    start,
)

PACKAGE = "bl_ext.user_default.mimetic"
STOPPED = (1, 720)  # frames of a capture that takes longer than the walk until Esc


def is_idle() -> bool:
    return importlib.import_module(f"{PACKAGE}.jobs").running is None


def progress() -> float:
    running = importlib.import_module(f"{PACKAGE}.jobs").running
    return running.fraction if running else 0.0


def captured_frames() -> list[int]:
    performance = importlib.import_module("mimetic.performance").Performance
    path = bpy.path.abspath(kept_of_clip().performance_path)
    return [int(frame) for frame in performance.load(path).frame] if path else []


def lay_out(walk: Walk) -> Steps:
    """The clip editor beside the 3D view, the Graph Editor below: what an animator looks at."""
    yield from split_view("CLIP_EDITOR")
    area_of("CLIP_EDITOR")[1].spaces.active.show_region_toolbar = False
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    yield from open_sidebar(walk, "CLIP_EDITOR", "Mimetic")


def find_the_face(walk: Walk) -> Steps:
    clip = str(walk.folder / walk.settings["clip"])
    answer = bpy.ops.mimetic.load_clip(filepath=clip)
    scene = bpy.context.scene
    walk.check("the clip is loaded", answer == {"FINISHED"} and scene.mimetic.clip is not None)
    yield 0.5
    _, editor = area_of("CLIP_EDITOR")
    walk.check("the clip editor shows it", editor.spaces.active.clip == scene.mimetic.clip)
    yield from pick_the_face(walk)
    walk.check("finding the face does not block the window", not is_idle())
    yield from walk.until(is_idle, 120, "finding the face ends")
    walk.check("a face was found", kept_of_clip().face_fit != "")
    walk.check("the found frame is on show", scene.frame_current == stored_fit().frame)
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    yield from walk.picture("face-found")


def pick_the_face(walk: Walk) -> Steps:
    """By a click beside the footage, which finds nothing, and one in its middle."""
    window, area = area_of("CLIP_EDITOR")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    yield 0.5
    for place in ((0.5, 1.02), (0.5, 0.5)):
        walk.check("nothing was looked for yet", is_idle())
        invoke("CLIP_EDITOR", bpy.ops.mimetic.pick_face)
        yield 0.2
        x, y = region.view2d.view_to_region(*place, clip=False)
        for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS")):
            window.event_simulate(type=kind, value=value, x=region.x + x, y=region.y + y)
        window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=region.x + x, y=region.y + y)
        yield 0.3


def kept_of_clip():
    """What belongs to the clip."""
    clips = importlib.import_module(f"{PACKAGE}.clips")
    return clips.ensure(bpy.context.scene.mimetic.clip)


def stored_fit():
    return importlib.import_module(f"{PACKAGE}.scene_out.face_fit").of_clip(
        bpy.context.scene.mimetic.clip
    )


def drag_a_landmark(walk: Walk) -> Steps:
    """With the mouse; the fit follows before the button is released, and one undo takes it back."""
    frame, name = stored_fit().frame, "mouth_corner.L"
    window, area = area_of("CLIP_EDITOR")
    region = next(region for region in area.regions if region.type == "WINDOW")

    def marker() -> bpy.types.MovieTrackingMarker:
        tracks = bpy.context.scene.mimetic.clip.tracking.objects["Face"].tracks
        return tracks[name].markers.find_frame(frame, exact=True)

    before = tuple(marker().co)
    x, y = region.view2d.view_to_region(*before, clip=False)
    x, y = region.x + x, region.y + y

    def mouse(kind: str, value: str, steps: int) -> None:
        window.event_simulate(type=kind, value=value, x=x + 2 * steps, y=y - steps)

    mouse("MOUSEMOVE", "NOTHING", 0)
    yield 0.2
    mouse("LEFTMOUSE", "PRESS", 0)
    for step in range(1, 9):
        mouse("MOUSEMOVE", "NOTHING", step)
        yield 0.1
    yield from walk.until(
        lambda: name in stored_fit().pins.get(frame, {}), 10, "the fit follows a dragged landmark"
    )
    yield from walk.picture("landmark-dragged")
    mouse("LEFTMOUSE", "RELEASE", 8)
    yield 0.5
    took = importlib.import_module(f"{PACKAGE}.pins").last_ms
    walk.check("the landmark is where it was dragged to", marker().co[0] > before[0], f"{took} ms")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.ed.undo()
    yield 0.5
    walk.check("one undo takes the pin back", not stored_fit().pins)
    walk.check("and the landmark", tuple(marker().co) == before)


def stop_once(walk: Walk) -> Steps:
    settings = bpy.context.scene.mimetic
    settings.use_frame_range = True
    settings.frame_first, settings.frame_last = STOPPED  # the fitted frame among them
    path = str(walk.folder / "stopped.npz")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture, filepath=path)
    # The first sixth is the muscles' attaching, in which there is nothing to keep yet
    yield from walk.until(lambda: progress() > 0.25, 240, "the capture tells its progress")
    yield from walk.picture("capturing")
    yield from work_meanwhile(walk)
    walk.check("the capture still runs when Esc is pressed", not is_idle())
    press("CLIP_EDITOR", "ESC")
    yield from walk.until(is_idle, 30, "Esc stops the capture")
    frames = captured_frames()
    wanted = STOPPED[1] - STOPPED[0] + 1
    walk.check("what was captured is kept", 0 < len(frames) < wanted, f"{len(frames)} of {wanted}")
    walk.check("a marked file", Path(path).exists() and kept_of_clip().performance_path == path)


def work_meanwhile(walk: Walk) -> Steps:
    """Scrubbing, a menu, playback and an undo, while a capture is at work."""
    scene = bpy.context.scene
    before = scene.frame_current
    press("CLIP_EDITOR", "RIGHT_ARROW")
    yield 0.5
    walk.check("an arrow key goes to the next frame", scene.frame_current == before + 1)
    press("CLIP_EDITOR", "RIGHTMOUSE")
    yield 0.5
    press("CLIP_EDITOR", "ESC")
    yield 0.5
    walk.check("a right-click and Esc in its menu stop nothing", not stopping())
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.screen.animation_play()
    yield 1.0
    walk.check("the animation plays", scene.frame_current != before + 1)
    press("CLIP_EDITOR", "ESC")
    yield 0.5
    walk.check("Esc ends the playback alone", not stopping() and not is_playing())
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.ed.undo()
    yield 0.5
    walk.check("an undo leaves it at work", not is_idle() and not stopping())
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.ed.redo()
    yield 0.5


def stopping() -> bool:
    running = importlib.import_module(f"{PACKAGE}.jobs").running
    return running is None or running.stop.is_set()


def is_playing() -> bool:
    return bpy.context.window_manager.windows[0].screen.is_animation_playing


def capture_again(walk: Walk) -> Steps:
    settings = bpy.context.scene.mimetic
    first, last = settings.frame_first, settings.frame_last = walk.settings["frames"]
    path = str(walk.folder / "whole.npz")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture, filepath=path)
    yield from walk.until(is_idle, 400, "the capture ends")
    walk.check("all frames are captured", captured_frames() == list(range(first, last + 1)))


def look_at_the_capture(walk: Walk) -> Steps:
    """Every captured frame shows the face over the footage."""
    overlay = importlib.import_module(f"{PACKAGE}.overlay.seen")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    frames = captured_frames()
    for frame in (frames[0], frames[-1]):
        # As keys and the timeline do it: a script's `frame_set` leaves the editor's picture behind
        with bpy.context.temp_override(**override("CLIP_EDITOR")):
            bpy.ops.screen.frame_offset(delta=frame - bpy.context.scene.frame_current)
        yield 0.5
        seen = overlay.last_take()
        row = seen.lines.row_of(frame)
        walk.check("the captured face is drawn", seen.drawn is not None and seen.drawn[0] == row)
    walk.check("the strip of quality is drawn", seen.strip is not None)
    yield from walk.picture("captured-face")


def hold_the_head_still(walk: Walk) -> Steps:
    invoke("CLIP_EDITOR", bpy.ops.mimetic.hold_head_still)
    yield from walk.until(is_idle, 60, "holding the head still ends")
    clip = bpy.context.scene.mimetic.clip
    walk.check("the clip is stabilised", len(clip.tracking.stabilization.tracks) == 1)
    _, editor = area_of("CLIP_EDITOR")
    walk.check("the clip editor shows it so", editor.spaces.active.show_stable)
    yield from walk.picture("head-held-still")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.release_head)
    walk.check("and lets go again", len(clip.tracking.stabilization.tracks) == 0)


def bake_and_export(walk: Walk) -> Steps:
    invoke("VIEW_3D", bpy.ops.mimetic.bake)
    yield from walk.until(is_idle, 120, "the bake ends")
    face = bpy.context.scene.mimetic.face
    walk.check("the scene has the face", face is not None and face.name == "Face")
    keys = face.data.shape_keys
    walk.check("its muscles are shape keys", "zygomaticus_major.L" in keys.key_blocks)
    walk.check("they are animated", keys.animation_data and keys.animation_data.action)
    # The start-up cube is two metres wide and stands around the footage's camera
    view = area_of("VIEW_3D")[1].spaces.active
    walk.check("the cube is there", "Cube" in bpy.context.scene.objects)
    cube = bpy.data.objects["Cube"]
    walk.check("it does not hide the footage", not cube.visible_in_viewport_get(view))
    walk.check("the face is in view", face.visible_in_viewport_get(view))
    walk.check("and active", bpy.context.view_layer.objects.active == face)
    yield from show_the_curves(walk, face)
    target = walk.folder / "face.glb"
    answer = bpy.ops.mimetic.export_gltf(filepath=str(target))
    walk.check("the glTF file is written", answer == {"FINISHED"} and target.exists())


def show_the_curves(walk: Walk, face: bpy.types.Object) -> Steps:
    """The face in the view and its muscles' curves beside it."""
    graph = area_of("CLIP_EDITOR")[1]
    graph.type = "GRAPH_EDITOR"
    graph.spaces.active.show_region_ui = False
    area_of("VIEW_3D")[1].spaces.active.show_region_ui = False
    for other in bpy.context.selected_objects:
        other.select_set(False)
    face.select_set(True)
    bpy.context.view_layer.objects.active = face
    bpy.context.scene.frame_set(walk.settings["scene_frame"])
    yield 1.0
    with bpy.context.temp_override(**override("GRAPH_EDITOR")):
        bpy.ops.graph.view_all()
    yield from walk.picture("baked")
    bpy.context.scene.mimetic.show_muscles = True
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.zoom(delta=4)
    yield from walk.picture("baked-muscles")
    bpy.context.scene.mimetic.show_muscles = False


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from lay_out(walk)
    yield from find_the_face(walk)
    yield from drag_a_landmark(walk)
    yield from stop_once(walk)
    yield from capture_again(walk)
    yield from look_at_the_capture(walk)
    yield from hold_the_head_still(walk)
    yield from bake_and_export(walk)


start(steps)
