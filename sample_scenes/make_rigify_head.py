# SPDX-License-Identifier: GPL-3.0-or-later
"""Build a .blend in which a Rigify character turns its head as the actor does; film both."""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import blender_module  # noqa: E402

HEAD, NECK, CHEST = "DEF-spine.006", "DEF-spine.005", "DEF-spine.003"
EARS = (0.0, -0.015, 1.845)  # where Rigify's human has midway between them
PICTURE = 300  # pixels, the film's height


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("performance", type=Path, help="performance.npz of capture or head")
    parser.add_argument("--footage", type=Path, required=True, help="the clip it is from")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--frames", type=int, nargs=2, metavar=("A", "B"), default=(1, 100000))
    parser.add_argument("--neck-share", type=float, default=0.3)
    arguments = parser.parse_args()
    return blender_module.run("make_rigify_head", lambda folder: build(arguments, folder))


def build(arguments: argparse.Namespace, folder: Path) -> None:
    import bpy
    from mimetic.performance.document import Performance
    from rigify_rig import generate_rig

    scene = bpy.context.scene
    performance = Performance.load(arguments.performance)
    first = max(arguments.frames[0], int(performance.frame[0]))
    last = min(arguments.frames[1], int(performance.frame[-1]))
    rig = generate_rig()
    bpy.ops.mimetic.add_face(subdivision=0)
    bind(bpy.context.active_object, rig)
    add_chest(rig)
    scene.render.fps = round(performance.fps)
    scene.render.fps_base = scene.render.fps / performance.fps
    scene.frame_start, scene.frame_end = first, last
    scene.mimetic.performance_path = str(arguments.performance.resolve())
    scene.mimetic.head.target = rig  # chooses the bones head and neck
    scene.mimetic.head.neck_share = arguments.neck_share
    bpy.ops.mimetic.bake_head()
    film(scene, arguments, folder, first, last)


def bind(face, rig) -> None:
    """Puts the head on the rig's deform bones; its neck bends between them."""
    face.location = EARS
    groups = {name: face.vertex_groups.new(name=name) for name in (HEAD, NECK, CHEST)}
    for vertex in face.data.vertices:
        _, y, z = vertex.co
        height = z - 0.6 * y  # the jaw belongs to the head, the nape at its height to the neck
        of_head = min(max((height + 0.14) / 0.065, 0.0), 1.0)
        of_neck = min(max((z + 0.26) / 0.08, 0.0), 1.0)
        groups[HEAD].add([vertex.index], of_head, "REPLACE")
        groups[NECK].add([vertex.index], (1 - of_head) * of_neck, "REPLACE")
        groups[CHEST].add([vertex.index], (1 - of_head) * (1 - of_neck), "REPLACE")
    modifier = face.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    while face.modifiers[0] != modifier:
        face.modifiers.move(len(face.modifiers) - 1, 0)


def add_chest(rig) -> None:
    """Something that stays where it is, to see the head turn against."""
    import bpy

    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    chest = bpy.context.object
    chest.name = "Chest"
    chest.location, chest.scale = (0.0, 0.03, 1.49), (0.21, 0.11, 0.22)
    bpy.ops.object.shade_smooth()
    cloth = bpy.data.materials.new("Cloth")
    cloth.diffuse_color = (0.09, 0.13, 0.22, 1.0)
    chest.data.materials.append(cloth)


def film(scene, arguments, folder: Path, first: int, last: int) -> None:
    """Writes rigify_head.blend and rigify_head.mp4, the footage beside the character."""
    import bpy
    from mimetic.media.ffmpeg import ffmpeg_program
    from mimetic.media.footage import Footage

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (0.0, -1.0, 1.8), (math.radians(90), 0, 0)
    camera.data.lens = 60
    scene.camera = camera
    width, height = Footage(arguments.footage).size
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.shading.light = "STUDIO"
    scene.display.shading.color_type = "TEXTURE"
    scene.display.shading.show_cavity = True
    scene.display.render_aa = "FXAA"
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.35, 0.35, 0.33)
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x = scene.render.resolution_y = PICTURE
    scene.render.filepath = str(folder / "frame_")
    arguments.out.mkdir(parents=True, exist_ok=True)
    blend = arguments.out / "rigify_head.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend.resolve()), compress=True)
    bpy.ops.render.render(animation=True)
    out = arguments.out / "rigify_head.mp4"
    aside = folder / out.name
    chosen = f"[0:v]trim=start_frame={first - 1}:end_frame={last},setpts=PTS-STARTPTS"
    scaled = f"scale={2 * round(width * PICTURE / height / 2)}:{PICTURE}"
    rate = str(scene.render.fps / scene.render.fps_base)
    subprocess.run(
        [
            *(ffmpeg_program(), "-y", "-loglevel", "error", "-i", os.fspath(arguments.footage)),
            *("-framerate", rate, "-start_number", str(first), "-i", f"{folder}/frame_%04d.png"),
            *("-filter_complex", f"{chosen},{scaled}[a];[a][1:v]hstack", "-pix_fmt", "yuv420p"),
            *("-r", rate, os.fspath(aside)),
        ],
        check=True,
    )
    out.write_bytes(aside.read_bytes())
    print(f"{blend} and {out}: frames {first} to {last}")


if __name__ == "__main__":
    sys.exit(main())
