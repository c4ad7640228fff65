# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the canonical head as a .blend with materials, and render it from three sides."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="write this .blend")
    parser.add_argument("--render", type=Path, metavar="FOLDER", help="write a PNG of each view")
    parser.add_argument("--view", nargs="*", help="front, three_quarter, profile (default: all)")
    parser.add_argument("--size", type=int, nargs=2, default=(400, 480), metavar=("W", "H"))
    parser.add_argument("--samples", type=int, default=64)
    setting = {"nargs": "*", "default": [], "metavar": "NAME=VALUE", "type": read_setting}
    parser.add_argument(
        "--shape", **setting, help="muscles, jaw, lids or face units, such as jaw_open=0.4"
    )
    parser.add_argument("--identity", **setting, help="head shape, such as sex_male=1")
    return parser.parse_args()


def read_setting(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    try:
        if equals:
            return name, float(value)
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")


def main() -> int:
    arguments = parse_arguments()
    try:
        import bpy
    except ImportError:
        print("make_head needs Blender's module: pip install bpy==4.5.15", file=sys.stderr)
        return 2
    import head_scene
    from mimetic import InvalidInput
    from mimetic.muscles.anatomy import attach
    from mimetic.template.face_template import load_template

    views = arguments.view or list(head_scene.VIEWS)
    shapes, identity = dict(arguments.shape), dict(arguments.identity)
    template = load_template()
    try:
        neutral = template.neutral(identity)
        anatomy = attach(neutral, template)
    except InvalidInput as error:
        print(f"make_head: {error}", file=sys.stderr)
        return 2
    names = [*anatomy.muscle_names, *anatomy.articulator_names, *template.unit_names]
    modes = [anatomy.muscle_modes, anatomy.articulator_modes, template.unit_modes]
    if unknown := set(shapes) - set(names) | set(views) - set(head_scene.VIEWS):
        print(f"make_head: there is no {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    head = head_scene.new_head(template, neutral)
    head_scene.add_shape_keys(head, names, np.concatenate(modes))
    for name, value in shapes.items():
        key = head.data.shape_keys.key_blocks[name]
        key.slider_min, key.slider_max = min(value, 0), max(value, 1)
        key.value = value
    head_scene.set_up_studio(scene, *arguments.size, arguments.samples)
    if arguments.out:
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(arguments.out.resolve()), compress=True)
    if arguments.render:
        arguments.render.mkdir(parents=True, exist_ok=True)
        for view in views:
            head_scene.look_from(scene, *head_scene.VIEWS[view])
            head_scene.render(scene, (arguments.render / f"{view}.png").resolve())
    return 0


if __name__ == "__main__":
    sys.exit(main())
