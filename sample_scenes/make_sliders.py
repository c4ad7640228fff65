# SPDX-License-Identifier: GPL-3.0-or-later
"""Build a .blend of a face animated by hand: sliders of muscles and groups, overlays on."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import blender_module  # noqa: E402

FRAMES_PER_SECOND = 24
# Frame -> sliders; what is not named is at 0. Groups move both sides, .L and .R one.
POSES = {
    1: {},
    14: {"Brow Raisers": 0.9, "lid_upper.L": -0.3, "lid_upper.R": -0.3, "jaw_open": 0.35},
    30: {"Brow Raisers": 0.8, "jaw_open": 0.4, "look_up.L": 0.6, "look_up.R": 0.6},
    44: {"Lip Corners": 0.35, "orbicularis_oculi_inferior.L": 0.5, "jaw_open": 0.05},
    52: {"Lip Corners.L": 0.6, "zygomaticus_major.R": 0.9, "orbicularis_oculi_inferior.L": 0.7},
    56: {"Lip Corners": 0.4, "lid_upper.L": 1.0, "lid_lower.L": 1.0},  # a wink
    60: {"Lip Corners": 0.4},
    66: {"lid_upper.L": 1.0, "lid_upper.R": 1.0, "lid_lower.L": 0.6, "lid_lower.R": 0.6},
    70: {"look_down.L": 0.5, "look_down.R": 0.5},
    76: {"corrugator_supercilii.L": 1.0, "corrugator_supercilii.R": 1.0, "mentalis.L": 0.7},
    86: {  # lips pressed on each other, and a look aside
        "Brow Lowerers": 0.6,
        "mentalis.L": 0.6,
        "mentalis.R": 0.6,
        "oris_close_upper": 0.9,
        "oris_close_lower": 0.9,
        "look_out.L": 0.7,
        "look_in.R": 0.7,
    },
    96: {},
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="write this .blend")
    parser.add_argument("--render", type=Path, metavar="PNG", help="render a frame with Cycles")
    parser.add_argument("--frame", type=int, default=52, help="the frame to render")
    arguments = parser.parse_args()
    return blender_module.run("make_sliders", lambda _folder: build(arguments))


def build(arguments: argparse.Namespace) -> None:
    import bpy
    import head_scene

    scene = bpy.context.scene
    bpy.ops.mimetic.add_face()
    face = bpy.context.active_object
    animate(face)
    scene.render.fps = FRAMES_PER_SECOND
    scene.frame_start, scene.frame_end = min(POSES), max(POSES)
    head_scene.set_up_studio(scene, 400, 480, samples=32)
    head_scene.look_from(scene, 25, 4)
    scene.mimetic.show_muscles = scene.mimetic.show_strain = True
    show_in_views()
    scene.frame_set(arguments.frame)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(arguments.out.resolve()), compress=True)
    if arguments.render:
        head_scene.render(scene, arguments.render.resolve())


def animate(face) -> None:
    """Keys every slider that a pose names, in every pose, so that poses do not run into another."""
    blocks = face.data.shape_keys.key_blocks
    used = sorted({name for pose in POSES.values() for name in pose})
    for frame, pose in POSES.items():
        for name in used:
            blocks[name].value = pose.get(name, 0.0)
            blocks[name].keyframe_insert("value", frame=frame, group="Muscles")


def show_in_views() -> None:
    """Every 3D view looks through the camera, with its sidebar open."""
    import bpy

    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
                area.spaces.active.region_3d.view_camera_zoom = 20
                area.spaces.active.show_region_ui = True


if __name__ == "__main__":
    sys.exit(main())
