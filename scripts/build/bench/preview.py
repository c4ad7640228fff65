# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what a frame of the preview of a character's own 52 keys costs: ms of processor time, of
all threads, and over a floor; and how many a second one processor shows.

The floor is the same frame of the same head, played by Blender from the curves that a bake of what
is previewed keys. Both go to a frame and have the mesh evaluated, lips and lids kept apart; what
draws it comes on top.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from bind import person
from live_mesh import load_extension
from mimetic.character.canonical_head import make_head
from mimetic.character.placement import to_object
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

SIZES = (10_000, 50_000, 100_000)
FRAMES = 240
FPS = 25


def acted() -> Performance:
    """Muscles, jaw and lids that move all the time, on the canonical head."""
    template, random = load_template(), np.random.default_rng(0)
    shapes = {shape.name: shape for shape in make_head().shapes}
    names = list(shapes)[:36]
    t = np.linspace(0, 1, FRAMES)[:, None]
    waves = 0.5 + 0.5 * np.sin(2 * np.pi * (t * np.linspace(4, 12, 43) + random.random(43)))
    lowest, highest = np.array(list(ARTICULATORS.values())).T
    return Performance(
        frame=np.arange(1, FRAMES + 1),
        fps=FPS,
        image_size=np.array([640, 480]),
        intrinsics=np.array([[800.0, 0, 320], [0, 800, 240], [0, 0, 1]]),
        head_pose=np.tile(np.diag([1.0, -1, -1, 1]), (FRAMES, 1, 1)),
        head_pose_cov=np.tile(np.eye(6) * 1e-6, (FRAMES, 1, 1)),
        muscles=names,
        muscle_modes=np.stack([shapes[name].offsets for name in names]).astype(np.float32),
        groups=np.arange(36) % 7 + 1,
        activations=waves[:, :36],
        activations_std=np.full((FRAMES, 36), 0.02),
        articulators=list(ARTICULATORS),
        articulator_values=np.clip(waves[:, 36:], lowest, highest),
        articulator_modes=np.stack([shapes[name].offsets for name in ARTICULATORS]).astype(
            np.float32
        ),
        neutral_vertices=template.vertices,
        faces=template.faces,
        quality=np.ones(FRAMES),
    )


def character(size: int) -> bpy.types.Object:
    """A head with as many vertices, muscles, and ARKit's 52 keys made for it."""
    template = load_template()
    vertices, triangles = person(template, size)
    mesh = bpy.data.meshes.new(f"Head {size}")
    mesh.from_pydata(to_object(vertices), [], triangles.tolist())
    head = bpy.data.objects.new(mesh.name, mesh)
    bpy.context.scene.collection.objects.link(head)
    for name in importlib.import_module("mimetic.character.self_landmarks").REQUIRED:
        group = head.vertex_groups.new(name=name)
        group.add([int(template.landmark(name))], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    return head


def median_ms(show: Callable[[int], None]) -> float:
    times = []
    for frame in range(1, FRAMES + 1):
        start = time.process_time()
        show(frame)
        times.append(1000 * (time.process_time() - start))
    return statistics.median(times[FRAMES // 10 :])


def measure(extension: str, size: int, performance_path: str) -> None:
    head = character(size)
    scene = bpy.context.scene
    scene.render.fps = FPS
    scene.mimetic.performance_path = performance_path
    keys = head.data.shape_keys

    def show(frame: int) -> None:
        scene.frame_set(frame)
        evaluated = head.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert len(evaluated.data.vertices) == len(head.data.vertices)

    assert bpy.ops.mimetic.bake_controls(use_head_motion=False) == {"FINISHED"}
    baked = keys.animation_data.action
    floor = median_ms(show)
    keys.animation_data.action = None
    start = time.process_time()
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    begun = time.process_time() - start
    preview = importlib.import_module(f"{extension}.control_preview")
    assert preview.is_of(head)
    shown = median_ms(show)
    row = head.mimetic.controls[0]
    start = time.process_time()
    row.gain = 0.9
    changed = 1000 * (time.process_time() - start)
    bpy.ops.mimetic.preview_controls()
    bpy.data.actions.remove(baked)
    bpy.data.objects.remove(head)
    print(
        f"{len(keys.reference_key.points):10,d} {begun:9.2f} {shown:9.2f} {floor:9.2f} "
        f"{shown / floor:9.2f} {1000 / shown:9.0f} {changed:9.2f}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="vertices")
    sizes = parser.parse_args().sizes
    extension = load_extension()
    path = Path(bpy.app.tempdir, "acted.performance.npz")
    acted().save(path)
    print(f"Blender {bpy.app.version_string}, 52 keys, {FRAMES} frames")
    names = ("begun, s", "frame, ms", "floor, ms", "times", "a second", "row, ms")
    print(f"{'vertices':>10s}" + "".join(f" {name:>9s}" for name in names), flush=True)
    for size in sizes:
        measure(extension, size, str(path))


if __name__ == "__main__":
    main()
