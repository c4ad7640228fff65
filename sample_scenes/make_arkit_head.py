# SPDX-License-Identifier: GPL-3.0-or-later
"""Build a .blend of a head with 52 shape keys of its own that plays a performance; picture both."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

import blender_module

IDENTITY = {"sex_male": 1.0, "age_old": 0.6, "weight": 0.5, "nose_hump": 0.8}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("--footage", type=Path, required=True, help="the clip it is from")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--frames", type=int, nargs="+", help="frames of the sheet")
    parser.add_argument(
        "--known-names",
        action="store_true",
        help="leave ARKit's names and attach no muscles: names alone decide",
    )
    arguments = parser.parse_args()
    return blender_module.run("make_arkit_head", lambda folder: build(arguments, folder))


def build(arguments: argparse.Namespace, folder: Path) -> None:
    import bpy
    import head_scene
    from contact_sheet import PICTURE, character_row, clip_row, spread
    from mimetic.performance.document import Performance
    from mimetic.shared.png import png_bytes

    scene = bpy.context.scene
    head = new_character(arguments.known_names)
    bpy.context.view_layer.objects.active = head
    performance = Performance.load(arguments.performance)
    scene.render.fps = round(performance.fps)
    scene.render.fps_base = scene.render.fps / performance.fps
    scene.frame_start, scene.frame_end = int(performance.frame[0]), int(performance.frame[-1])
    scene.mimetic.performance_path = str(arguments.performance.resolve())
    bpy.ops.mimetic.bake_controls()
    arguments.out.mkdir(parents=True, exist_ok=True)
    blend = arguments.out / "arkit_head.blend"
    head_scene.set_up_studio(scene, PICTURE, PICTURE, 16)
    head_scene.look_from(scene, *head_scene.VIEWS["front"])
    blender_module.arrange_screens(scene, head)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend.resolve()), compress=True)
    sheet = arguments.out / "arkit_head.png"
    frames = arguments.frames or spread(performance.frame, 6)
    rows = clip_row(arguments.footage, frames), character_row(scene, frames, folder)
    sheet.write_bytes(png_bytes(np.vstack(rows)))
    print(f"{blend} and {sheet}: frames {', '.join(map(str, frames))}")


def new_character(has_known_names: bool):
    """The head with its 52 keys; with muscles, unless the keys' names are known."""
    import bpy
    import head_scene
    from mimetic.character.foreign_mesh import REQUIRED
    from mimetic.template.face_template import load_template

    template = load_template()
    head = head_scene.new_head(template, template.neutral(IDENTITY))
    names = template.unit_names if has_known_names else _plain_names(template.unit_names)
    head_scene.add_shape_keys(head, names, np.asarray(template.unit_modes))
    for name in REQUIRED:
        group = head.vertex_groups.new(name=name)
        group.add([template.landmark(name)], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    if not has_known_names:
        bpy.ops.mimetic.attach_muscles()
    return head


def _plain_names(units: list[str]) -> list[str]:
    """Names that say nothing, and in another order than the units'."""
    order = np.random.default_rng(0).permutation(len(units))
    return [f"Key {number + 1:02d}" for number in order]


if __name__ == "__main__":
    sys.exit(main())
