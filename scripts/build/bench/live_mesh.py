# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what moving a whole face in Blender costs: medians in ms, and over a floor.

The floor is one `foreach_set` of the mesh's positions, as many numbers as the face has.
"""

from __future__ import annotations

import importlib.util
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np

HEADLESS = Path(__file__).resolve().parents[3] / "blender_addon" / "headless_bake.py"
ROUNDS = 101


def median_ms(work: Callable[[int], object]) -> float:
    """Median time of a call, after a few that warm up; work: takes the number of the round."""
    times = []
    for i in range(ROUNDS + 5):
        start = time.perf_counter()
        work(i)
        times.append(1000 * (time.perf_counter() - start))
    return statistics.median(times[5:])


def load_extension() -> str:
    """Imports it by its file: a folder beside it has the package's name and stays off sys.path."""
    spec = importlib.util.spec_from_file_location("headless_bake", HEADLESS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.load_extension()


def main() -> None:
    extension = load_extension()
    sliders = importlib.import_module(f"{extension}.scene_out.sliders")
    live = importlib.import_module(f"{extension}.overlay.live")
    native = importlib.import_module(f"{extension}.native")
    contact = importlib.import_module(f"{extension}.scene_out.contact")
    bpy.ops.mimetic.add_face()
    face = bpy.context.active_object
    modifier = face.modifiers["Subdivision"]
    names = [shape.name for shape in face.mimetic.shapes]
    rounds = random_values(names)
    rest = contact.points_of(face.data.shape_keys.reference_key)
    positions = rest.ravel()
    attribute = face.data.attributes["position"].data
    view_layer = bpy.context.view_layer

    def set_and_evaluate(i: int) -> None:
        sliders.set_values(face, rounds[i])
        view_layer.update()
        evaluated_face = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert len(evaluated_face.data.vertices)  # asked for: subdivision waits until then

    def each_by_property(i: int) -> None:
        blocks = face.data.shape_keys.key_blocks
        for name, value in rounds[i].items():
            blocks[name].value = value

    def draw(i: int) -> None:
        sliders.set_values(face, rounds[i])
        view = live.look(face)
        view.face.strokes(view.pose)
        view.face.nodes(view.pose)
        view.face.strain_patch(view.pose, view.face.strain(view.pose, "area"), 0.2)

    def follow_contact(press: float) -> None:
        values = {"oris_close_upper": press, "oris_close_lower": press, "jaw_open": 1 - press}
        correction = live_contact.correction(sliders.moves(face, values, rest))
        contact.place(face, live_contact.moved, correction)

    face.mimetic.use_contact = False
    floor = median_ms(lambda i: attribute.foreach_set("vector", positions))
    rows = [("positions written once (floor)", floor)]
    at_once = median_ms(lambda i: sliders.set_values(face, rounds[i]))
    rows.append((f"{len(names)} sliders set at once", at_once))
    rows.append((f"{len(names)} sliders set one by one", median_ms(each_by_property)))
    modifier.show_viewport = False
    rows.append(("sliders set, face evaluated", median_ms(set_and_evaluate)))
    rows.append(("a live state shown and evaluated", median_ms(live_states(extension, face))))
    contact.ensure_key(face)
    live_contact = native.live_contact().live_contact(rest)
    rows.append(("contact looked for, lips apart", median_ms(lambda i: follow_contact(0.01))))
    rows.append(("contact solved, lips pressed", median_ms(lambda i: follow_contact(0.9))))
    contact.place(face, None, None)
    modifier.show_viewport = True
    rows.append(("the same with one subdivision", median_ms(set_and_evaluate)))
    rows.append(("both overlays made", median_ms(draw)))
    print(f"Blender {bpy.app.version_string}, {len(positions) // 3} vertices, {len(names)} shapes")
    print_rows(rows, floor)


def live_states(extension: str, face: bpy.types.Object) -> Callable[[int], None]:
    """Shows a live session's states, sliders and head, and has Blender evaluate the face."""
    from mimetic._core import LidFollowing
    from mimetic.puppet.live_face import live_names

    parts = importlib.import_module(f"{extension}.scene_out.live")
    puppet = parts.Puppet(bpy.context.scene, face)
    names = live_names()
    followed = SimpleNamespace(lids=[LidFollowing(0.03, 0.0)] * 2)
    random = np.random.default_rng(1)
    values = random.uniform(0, 0.5, (ROUNDS + 5, len(names)))
    pose = np.diag([1.0, -1.0, -1.0, 1.0])

    def show(i: int) -> None:
        puppet.show(names, SimpleNamespace(values=values[i], head_pose=pose), followed)
        bpy.context.view_layer.update()
        evaluated_face = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert len(evaluated_face.data.vertices)

    return show


def random_values(names: list[str]) -> list[dict[str, float]]:
    random = np.random.default_rng(0)
    return [
        dict(zip(names, random.uniform(0, 1, len(names)).tolist(), strict=True))
        for _ in range(ROUNDS + 5)
    ]


def print_rows(rows: list[tuple[str, float]], floor: float) -> None:
    for name, ms in rows:
        print(f"{name:34} {ms:8.3f} ms {ms / floor:8.1f} x")


if __name__ == "__main__":
    main()
