# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a head moves in a scene of centimetres: a face of our own mesh, and the user's own."""

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.newest

FRAMES = (1, 9, 24, 40)
CENTIMETRES = 0.01  # Unit Scale
HEAD = frozenset({"head_position", "head_rotation"})


@pytest.fixture(autouse=True)
def rate(scene):
    scene.render.fps, scene.render.fps_base = 25, 1.0


def ways_of(obj) -> np.ndarray:
    """How far from its first place an object is in the world's units."""
    places = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        places.append(shown.matrix_world.translation[:])
    return np.linalg.norm(np.subtract(places, places[0]), axis=1)


def added_face(*_):
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return bpy.context.active_object


def enlarged_face(*_):
    """Made as large as the scene's units, as an animator does who works in them."""
    face = added_face()
    face.scale = (1 / bpy.context.scene.unit_settings.scale_length,) * 3
    bpy.context.view_layer.update()
    return face


def baked_face(_, path, **options):
    bpy.context.scene.mimetic.performance_path = path
    options = {"use_texture": False, "use_contact": False, **options}
    assert bpy.ops.mimetic.bake(**options) == {"FINISHED"}
    return bpy.context.scene.mimetic.face


def own_head(parts, _):
    """Modelled in centimetres; as large as the scene says."""
    points, faces, marks = parts
    mesh = bpy.data.meshes.new("Hero")
    mesh.from_pydata(points, [], faces.tolist())
    head = bpy.data.objects.new("Hero", mesh)
    bpy.context.scene.collection.objects.link(head)
    head.scale = (0.01 / bpy.context.scene.unit_settings.scale_length,) * 3
    for name, vertex in marks.items():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    return head


def bake(_, head, acted):
    bpy.context.view_layer.objects.active = head
    bpy.context.scene.mimetic.performance_path = acted[1]
    assert bpy.ops.mimetic.bake() == {"FINISHED"}


def bake_on_controls(_, head, acted):
    bpy.context.view_layer.objects.active = head
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}  # our own face hangs on it
    bpy.context.view_layer.objects.active = head
    bpy.context.scene.mimetic.performance_path = acted[1]
    assert bpy.ops.mimetic.bake(to="CONTROLS") == {"FINISHED"}


def record_live(extension, head, acted):
    live = extension("scene_out.live")
    puppet = live.Puppet(bpy.context.scene, head)
    puppet.record(bpy.context.scene, acted[0], "take", live.Place(1, 0), HEAD)


def ways_in(scale, extension, parts, acted, make, play) -> np.ndarray:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.unit_settings.scale_length, scene.render.fps = scale, 25
    head = make(parts, acted[1])
    play(extension, head, acted)
    return ways_of(head)


@pytest.mark.parametrize("play", [bake, bake_on_controls, record_live])
@pytest.mark.parametrize(
    ("make", "units"),
    [(added_face, 1), (enlarged_face, 100), (own_head, 100)],
    ids=["ours", "ours, enlarged", "the user's"],
)
def test_a_head_moves_as_large_as_it_is_built(extension, parts, acted, make, units, play):
    what = extension, parts, acted, make, play
    expected = ways_in(1.0, *what)
    assert 0.005 < expected.max() < 0.3  # metres
    np.testing.assert_allclose(ways_in(CENTIMETRES, *what), units * expected, atol=units * 1e-5)


def test_a_baked_face_moves_live_as_far_as_by_its_bake(extension, parts, acted):
    expected = ways_in(1.0, extension, parts, acted, baked_face, record_live)
    actual = ways_in(CENTIMETRES, extension, parts, acted, baked_face, record_live)
    np.testing.assert_allclose(actual, expected, atol=1e-5)


def test_a_live_head_is_shown_where_it_is_recorded(extension, scene, acted):
    scene.unit_settings.scale_length = CENTIMETRES
    face = added_face()
    head = extension("scene_out.live").LiveHead(scene, face)
    for pose in (acted[0].head_pose[0], acted[0].head_pose[23]):
        head.show(face, pose)
    shown = face.location.copy()
    head.restore(face)
    record_live(extension, face, acted)
    scene.frame_set(24)
    np.testing.assert_allclose(shown, face.location, atol=1e-6)


@pytest.mark.parametrize("scale", [1.0, CENTIMETRES])
def test_a_face_beside_its_copy_is_a_quarter_of_a_metre_off(extension, scene, parts, acted, scale):
    scene.unit_settings.scale_length = scale
    face = added_face()
    for _ in range(2):
        bake(extension, face, acted)
    comparison = extension("scene_out.take_comparison")
    twin = comparison.stand_beside(scene, face, face.mimetic.takes[0])
    bpy.context.view_layer.update()
    beside = (twin.matrix_world.translation - face.matrix_world.translation).length
    assert beside == pytest.approx(comparison.BESIDE, abs=1e-4)


def test_a_character_without_muscles_is_as_large_as_the_scene_says(extension, scene):
    scene.unit_settings.scale_length = CENTIMETRES
    bpy.ops.mesh.primitive_cube_add()
    units = extension("scene_out.bound").units_of(scene, bpy.context.active_object)
    assert units == pytest.approx(1 / CENTIMETRES)
