# SPDX-License-Identifier: GPL-3.0-or-later
"""Build a .blend of each kind of character that plays a performance, and a contact sheet of all.

canonical: our head; far: a person far from the mean; foreign: another's, decimated, turned and 1.3
times as large; both with landmarks that place themselves; mask: MediaPipe's canonical face, cut
open, eyeballs as objects of their own (scripts/fetch_foreign_face); arkit: 52 keys of other names;
suzanne: Blender's monkey; rigify, rigify_new: the bones of Rigify's faces, legacy and new;
rigify_body: face, head and neck of a Rigify human whose body moves by hand.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import blender_module
import rigify_body

MARGIN = 1.15  # of the pictures about the face
FAR = {"sex_male": -0.6, "age_old": 0.9, "weight": 0.9, "nose_hump": -0.8}
FOREIGN = {"sex_male": 1.0, "age_old": 0.5, "weight": -0.4, "nose_hump": 0.8}
# Places on Blender's monkey of size .25, from the middle of its bounding box: metres to its left,
# and up. Landmarks that place themselves take its long upper lip for the mouth.
MONKEY = {
    **{"eye_inner": (0.0215, 0.031), "eye_outer": (0.069, 0.033)},
    **{
        "brow_inner": (0.028, 0.074),
        "brow_outer": (0.074, 0.062),
        "mouth_corner": (0.0125, -0.093),
    },
    **{"nose_bridge": (0, 0.02), "nose_tip": (0, -0.024), "chin": (0, -0.112)},
    **{"lip_upper_inner": (0, -0.093), "lip_lower_inner": (0, -0.104)},
}
WELD = 1e-5  # m: the mask's skull ends in vertices at one place
MASK_PERSON = 0  # seed of its proportions
MORE_MARKS = {"nose_bridge": 168, "lip_upper_inner": 13, "lip_lower_inner": 14}  # on the mask
NEAR = 0.004  # m in the front view, of the vertices that a place may mean: the foremost is


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("--footage", type=Path, required=True, help="the clip it is from")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--frames", type=int, nargs="+", help="frames of the sheet")
    parser.add_argument("--only", choices=CHARACTERS, nargs="+", default=at_hand())
    arguments = parser.parse_args()
    if len(arguments.only) == 1:
        return blender_module.run("make_characters", lambda folder: build(arguments, folder))
    # A process each: Blender does not forget a Rigify that was in it
    for name in arguments.only:
        command = [sys.executable, __file__, arguments.performance, "--footage", arguments.footage]
        command += ["--out", arguments.out, "--only", name]
        frames = ["--frames", *map(str, arguments.frames)] if arguments.frames else []
        if status := subprocess.run([*map(str, command), *frames], check=False).returncode:
            return status
    return _join(arguments)


def at_hand() -> list[str]:
    """All of them, the mask only where it was fetched."""
    from evaluation.synthetic.characters import FETCHED

    return [name for name in CHARACTERS if name != "mask" or (FETCHED / "face.obj").is_file()]


def build(arguments: argparse.Namespace, folder: Path) -> None:
    import bpy
    import contact_sheet
    from mimetic.performance.document import Performance
    from mimetic.shared.png import png_bytes

    (name,) = arguments.only
    scene = bpy.context.scene
    performance = Performance.load(arguments.performance)
    scene.render.fps = round(performance.fps)
    scene.render.fps_base = scene.render.fps / performance.fps
    scene.frame_start, scene.frame_end = int(performance.frame[0]), int(performance.frame[-1])
    scene.mimetic.performance_path = str(arguments.performance.resolve())
    mesh = CHARACTERS[name]()
    has_body = name == "rigify_body"
    if has_body:
        rigify_body.animate(mesh.parent, scene.frame_start, scene.frame_end)
    is_own = name in ("arkit", "rigify", "rigify_new", "rigify_body")
    (bpy.ops.mimetic.bake_controls if is_own else bpy.ops.mimetic.bake)(use_head_motion=has_body)
    _frame(scene, mesh, 2.2 if has_body else MARGIN)
    arguments.out.mkdir(parents=True, exist_ok=True)
    blend = (arguments.out / f"{name}.blend").resolve()
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)
    frames = arguments.frames or contact_sheet.spread(performance.frame, 6)
    row = contact_sheet.character_row(scene, frames, folder)
    (arguments.out / f"{name}.png").write_bytes(png_bytes(row))
    np.save(_row_file(arguments.out, name), row)
    print(f"{blend}: frames {', '.join(map(str, frames))} in {name}.png")


def _canonical():
    import bpy

    bpy.ops.mimetic.add_face()
    return bpy.context.active_object


def _person(identity):
    import head_scene
    from mimetic.template.face_template import load_template

    template = load_template()
    head = head_scene.new_head(template, template.neutral(identity))
    head.modifiers.clear()
    return head


def _foreign():
    import bpy

    head = _person(FOREIGN)
    head.modifiers.new("Half", "DECIMATE").ratio = 0.6
    bpy.context.view_layer.objects.active = head
    bpy.ops.object.modifier_apply(modifier="Half")
    head.scale = (1.3,) * 3
    return _bound(head)


def _suzanne():
    import bpy

    bpy.ops.mesh.primitive_monkey_add(size=0.25)
    monkey = bpy.context.active_object
    monkey.modifiers.new("Smooth", "SUBSURF").levels = 2
    bpy.ops.object.modifier_apply(modifier="Smooth")
    bpy.ops.object.shade_smooth()
    points = np.array([vertex.co for vertex in monkey.data.vertices])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    for name, (x, z) in MONKEY.items():
        for side, sign in ((".L", 1), (".R", -1)) if x else (("", 1),):
            apart = np.hypot(points[:, 0] - middle[0] - sign * x, points[:, 2] - middle[2] - z)
            near = np.flatnonzero(apart < max(NEAR, apart.min() + 1e-6))
            foremost = int(near[points[near, 1].argmin()])
            monkey.vertex_groups.new(name=name + side).add([foremost], 1.0, "REPLACE")
    bpy.ops.mimetic.attach_muscles()
    return monkey


def _welded(points, faces):
    """Triangles whose corners at one place are one vertex, without those that are lines then."""
    _, first, label = np.unique(
        np.round(points / WELD), axis=0, return_index=True, return_inverse=True
    )
    faces = first[label.reshape(-1)][faces]
    return faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]


def _mask():
    """Vertices and triangles of another package's make, with a skull, without a mouth inside."""
    import bpy
    from mimetic.character.foreign_mesh import REQUIRED
    from mimetic.character.placement import to_object

    from evaluation.synthetic.foreign.head_mesh import LANDMARKS, PARTS, person

    whole = person(MASK_PERSON)
    points = to_object(whole.vertices)
    head = None
    for name, parts in (
        ("Mask", ("skin", "scalp")),
        ("Eye.L", PARTS[-2:-1]),
        ("Eye.R", PARTS[-1:]),
    ):
        faces = whole.triangles[np.isin(whole.part, [PARTS.index(part) for part in parts])]
        own, corners = np.unique(_welded(points, faces), return_inverse=True)
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points[own], [], corners.reshape(-1, 3).tolist())
        mesh.shade_smooth()
        obj = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(obj)
        if head is None:
            head = obj
            for mark in REQUIRED:
                vertex = {**LANDMARKS, **MORE_MARKS}[mark]
                place = int(np.searchsorted(own, vertex))
                head.vertex_groups.new(name=mark).add([place], 1.0, "REPLACE")
        else:
            obj.parent = head
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    bpy.ops.mimetic.attach_muscles()
    return head


def _bound(head):
    """With muscles at landmarks that placed themselves."""
    import bpy

    bpy.context.view_layer.objects.active = head
    bpy.ops.mimetic.add_landmarks()
    bpy.context.view_layer.objects.active = head
    bpy.ops.mimetic.attach_muscles()
    return head


def _arkit():
    import make_arkit_head

    return make_arkit_head.new_character(False)


def _rigify(has_new_face: bool, has_body: bool = False):
    import make_rigify_face

    return make_rigify_face.new_character(has_new_face, has_body)[0]


CHARACTERS: dict[str, Callable] = {
    "canonical": _canonical,
    "far": lambda: _bound(_person(FAR)),
    "foreign": _foreign,
    "mask": _mask,
    "arkit": _arkit,
    "suzanne": _suzanne,
    "rigify": lambda: _rigify(False),
    "rigify_new": lambda: _rigify(True),
    "rigify_body": lambda: _rigify(False, True),
}


def _frame(scene, mesh, margin: float) -> None:
    """A camera before the middle of the mesh, which looks along -y, so many times as high."""
    import bpy
    import head_scene

    head_scene.set_up_studio(scene, 320, 320, 16)
    corners = np.array([mesh.matrix_world @ corner for corner in map(_vector, mesh.bound_box)])
    lowest, highest = corners.min(axis=0), corners.max(axis=0)
    middle, height = (lowest + highest) / 2, highest[2] - lowest[2]
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", margin * height
    camera.location = (middle[0], lowest[1] - 4 * height, middle[2])
    camera.rotation_euler = (np.pi / 2, 0, 0)
    camera.data.clip_end = 100
    for obj in scene.objects:
        obj.hide_render = obj.type in ("EMPTY", "ARMATURE")
    bpy.context.view_layer.update()


def _vector(corner):
    from mathutils import Vector

    return Vector(corner)


def _row_file(folder: Path, name: str) -> Path:
    return folder / f".{name}.npy"


def _join(arguments: argparse.Namespace) -> int:
    """The clip's row above all others, as characters.png."""
    import contact_sheet
    from mimetic.performance.document import Performance
    from mimetic.shared.png import png_bytes

    frames = arguments.frames or contact_sheet.spread(
        Performance.load(arguments.performance).frame, 6
    )
    rows = [contact_sheet.clip_row(arguments.footage, frames)]
    for name in arguments.only:
        rows.append(np.load(_row_file(arguments.out, name)))
        _row_file(arguments.out, name).unlink()
    sheet = arguments.out / "characters.png"
    sheet.write_bytes(png_bytes(np.vstack(rows)))
    print(f"{sheet}: the clip, {', '.join(arguments.only)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
