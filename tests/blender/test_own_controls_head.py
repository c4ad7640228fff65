# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on characters without muscles, however mesh, object and scene stand."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from test_head import world_at

pytestmark = pytest.mark.newest

UNITS = ("jawOpen", "browInnerUp")
FRAMES = (1, 9, 24, 40)


def make_character(parts, turn=None, scale=(0.01,) * 3, has_landmarks=False):
    """A head of two keys whose mesh is turned in its object, which stands upright."""
    from mimetic.character.placement import to_object
    from mimetic.template.face_template import load_template

    template, turn = load_template(), np.array(turn or Matrix.Identity(3))
    points, faces, marks = parts
    mesh = bpy.data.meshes.new("Hero")
    mesh.from_pydata(points @ turn.T, [], faces.tolist())
    head = bpy.data.objects.new("Hero", mesh)
    bpy.context.scene.collection.objects.link(head)
    head.scale, head.location = scale, (0.3, -0.2, 0.1)
    head.rotation_euler = Matrix(turn.T.tolist()).to_euler()
    head.shape_key_add(name="Basis")
    for unit in UNITS:
        offsets = to_object(template.unit_modes[template.unit_names.index(unit)]) / 0.01
        key = head.shape_key_add(name=unit, from_mix=False)
        key.points.foreach_set("co", ((points + offsets) @ turn.T).astype(np.float32).reshape(-1))
    for name, vertex in marks.items() if has_landmarks else ():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    return head


def moved(extension, performance, head) -> list[np.ndarray]:
    """4 x 4 of some frames, in metres: how a bake moves what it finds in the world."""
    scene = bpy.context.scene
    scene.render.fps = 25
    own_controls = extension("scene_out.own_controls")
    before = np.array(extension("world").matrix(head))
    own_controls.bake(scene, performance, "hero", head, own_controls.play(performance, head))
    shown = [world_at(head, frame) @ np.linalg.inv(before) for frame in FRAMES]
    for matrix in shown:
        matrix[:3, 3] *= scene.unit_settings.scale_length
    return shown


KINDS = {
    "y up": {"turn": Matrix.Rotation(-np.pi / 2, 3, "X")},
    "mirrored": {"scale": (-0.01, 0.01, 0.01)},
}


@pytest.mark.parametrize("has_landmarks", [False, True], ids=["by keys", "by landmarks"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_head_moves_alike_however_its_mesh_stands(
    extension, scene, parts, acted, kind, has_landmarks
):
    expected = moved(extension, acted[0], make_character(parts, has_landmarks=has_landmarks))
    head = make_character(parts, **KINDS[kind], has_landmarks=has_landmarks)
    actual = moved(extension, acted[0], head)
    # By landmarks a mirrored head is found by its keys, whose middle lies elsewhere
    atol = 0.03 if (kind, has_landmarks) == ("mirrored", True) else 2e-3
    np.testing.assert_allclose(actual, expected, atol=atol)
    assert max(np.abs(matrix - np.eye(4)).max() for matrix in expected) > 0.1


def test_a_scene_of_centimetres_moves_it_as_far(extension, scene, parts, acted):
    expected = moved(extension, acted[0], make_character(parts))
    scene.unit_settings.scale_length = 0.01
    head = make_character(parts, scale=(1.0,) * 3)
    head.location *= 100
    bpy.context.view_layer.update()
    np.testing.assert_allclose(moved(extension, acted[0], head), expected, atol=1e-4)


@pytest.mark.parametrize("has_landmarks", [False, True], ids=["by keys", "by landmarks"])
def test_a_bake_over_strips_starts_where_theirs_did(scene, parts, acted, has_landmarks):
    head = make_character(parts, has_landmarks=has_landmarks)
    scene.render.fps = 25
    assert bpy.ops.mimetic.load_performance(filepath=acted[1]) == {"FINISHED"}
    bpy.context.view_layer.objects.active = head
    assert bpy.ops.mimetic.bake_controls(use_strips=True) == {"FINISHED"}
    expected = [world_at(head, frame) for frame in FRAMES]
    scene.frame_set(25)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert not head.animation_data.nla_tracks
    np.testing.assert_allclose([world_at(head, frame) for frame in FRAMES], expected, atol=1e-5)
