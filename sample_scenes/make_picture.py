# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the README's picture: the canonical head at rest and moved by its muscles."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import head_scene
from mimetic.muscles.anatomy import attach
from mimetic.template.face_template import load_template

SIZE = (220, 268)
# Degrees the camera goes to the subject's left, and what moves; one name moves both sides.
POSES = (
    (0, {}),
    (-24, {"zygomaticus_major": 1.0, "orbicularis_oculi_inferior": 0.8, "jaw_open": 0.08}),
    (
        24,
        {
            "frontalis_medial": 1.0,
            "frontalis_middle": 1.0,
            "frontalis_lateral": 0.9,
            "lid_upper": -0.3,
            "jaw_open": 0.45,
        },
    ),
    (
        -12,
        {
            "corrugator_supercilii": 1.0,
            "procerus": 0.6,
            "levator_labii_superioris_alaeque_nasi": 0.7,
            "depressor_anguli_oris": 0.8,
            "mentalis": 0.5,
        },
    ),
)


def pose(keys: bpy.types.Key, values: dict[str, float]) -> None:
    for key in keys.key_blocks[1:]:
        value = values.get(key.name, values.get(key.name.rpartition(".")[0], 0.0))
        key.slider_min, key.slider_max = min(value, 0), max(value, 1)
        key.value = value


def read_pixels(path: Path) -> np.ndarray:
    """H x W x 4, first row at the bottom."""
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)


def write_pixels(pixels: np.ndarray, path: Path) -> None:
    """Writes a PNG of 64 levels a channel: half the size of 256, and no eye sees it."""
    image = bpy.data.images.new("Picture", pixels.shape[1], pixels.shape[0], alpha=False)
    pixels = np.round(pixels * 63) / 63
    image.pixels.foreach_set(pixels.ravel())
    image.file_format = "PNG"
    image.filepath_raw = str(path.resolve())
    image.save(quality=100)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/images/head.png"))
    parser.add_argument("--samples", type=int, default=96)
    arguments = parser.parse_args()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    template = load_template()
    anatomy = attach(template.vertices, template)
    head = head_scene.new_head(template, template.vertices)
    names = [*anatomy.muscle_names, *anatomy.articulator_names]
    modes = np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes])
    head_scene.add_shape_keys(head, names, modes)
    head_scene.set_up_studio(scene, *SIZE, arguments.samples)
    scene.camera.data.lens = 98
    scene.cycles.use_denoising = True
    views = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (side, values) in enumerate(POSES):
            pose(head.data.shape_keys, values)
            head_scene.look_from(scene, side, 2)
            path = Path(folder) / f"{number}.png"
            head_scene.render(scene, path)
            views.append(read_pixels(path))
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    write_pixels(np.concatenate(views, axis=1), arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
