# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Bake Action on the face of a Rigify character that plays a performance: the face moves
as before, and the take stays."""

import bpy
import numpy as np
import pytest
from test_exports import cut
from test_rigify_character import face, points

pytestmark = pytest.mark.oldest_and_newest

ROWS = [0, 8, 13, 24, 29, 39]  # frames apart: what is baked takes Blender long, frame by frame
FRAMES = range(1, 1 + len(ROWS))
ROUNDED = 1e-5  # metres, where matrices went through single precision; a performance moves 160 mm
DOUBLED = 1e-3  # metres, and more: what a constraint does is keyed, and done once more


@pytest.fixture(scope="module")
def few_frames(acted, tmp_path_factory) -> str:
    """A performance that moves far from each frame to the next; its file."""
    path = tmp_path_factory.mktemp("few") / "hero.npz"
    cut(acted[0], ROWS).save(path)
    return str(path)


def test_the_face_moves_as_before_and_the_take_stays(extension, rigify_file, few_frames):
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    rig = bpy.data.objects["rig"]
    bpy.context.scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=few_frames)
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    take, curves = rig.animation_data.action, extension("compat").curves_in
    before, keyed = shown(), keys_of(curves(take))
    moved = [np.linalg.norm(now - before[0], axis=1).max() for now in before]
    assert max(moved) > 0.1
    select_bones(rig, {path.split('"')[1] for path, _ in keyed if path.startswith("pose.bones")})

    bake_action()
    assert rig.animation_data.action != take
    assert farthest(before) < ROUNDED
    # What the guide warns of: constraints that stay act on keys that hold what they do
    play(rig, take)
    bake_action(visual_keying=True)
    assert farthest(before) > DOUBLED
    play(rig, take)
    bake_action(visual_keying=True, clear_constraints=True)
    assert farthest(before) < ROUNDED

    assert len(bpy.data.actions) == 4  # the take, and one of each bake
    assert keys_of(curves(take)) == keyed
    play(rig, take)


def play(rig, take) -> None:
    """By the button of the list of takes."""
    (row,) = rig.mimetic.takes
    assert bpy.ops.mimetic.play_take(take=row.name) == {"FINISHED"}
    assert rig.animation_data.action == take


def select_bones(rig, names: set[str]) -> None:
    bpy.ops.object.mode_set(mode="POSE")
    for bone in rig.pose.bones:
        holder = bone if hasattr(bone, "select") else bone.bone  # before Blender 5.0 the bone's
        holder.select = bone.name in names


def bake_action(**options) -> None:
    """Pose > Animation > Bake Action, of the selected bones, into a new action."""
    span = {"frame_start": FRAMES[0], "frame_end": FRAMES[-1]}
    answer = bpy.ops.nla.bake(**span, only_selected=True, bake_types={"POSE"}, **options)
    assert answer == {"FINISHED"}


def shown() -> list[np.ndarray]:
    """The face's points as its bones have them, of each frame."""
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found.append(points(face().evaluated_get(bpy.context.evaluated_depsgraph_get())))
    return found


def farthest(before: list[np.ndarray]) -> float:
    """Metres between what is shown and what was."""
    return max(
        np.linalg.norm(now - then, axis=1).max() for now, then in zip(shown(), before, strict=True)
    )


def keys_of(curves) -> dict[tuple[str, int], list]:
    return {
        (curve.data_path, curve.array_index): [tuple(key.co) for key in curve.keyframe_points]
        for curve in curves
    }
