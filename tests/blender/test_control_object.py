# SPDX-License-Identifier: GPL-3.0-or-later
"""The control object of a face drives it as its shape keys' own curves do."""

from dataclasses import replace

import bmesh
import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from test_bake import METRES, evaluated_vertices
from test_bake_bound import curves_of, hero, loaded, slider, world_at  # noqa: F401
from test_gaze import looking  # noqa: F401

FRAMES = (1, 9, 24, 40)
CLOSE = 2e-6  # metres, where both ways round single precision


@pytest.fixture
def face(extension, scene, sheet):
    """The performance's face with a control object that plays it."""
    return baked(extension, scene, sheet, use_controls=True)


def baked(extension, scene, performance, **options):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, performance, "take", subdivision=0, **options)
    return scene.mimetic.face


def test_a_button_beside_the_faces_name_adds_and_removes_it(face):
    assert "mimetic.remove_control_object" in drawn("MIMETIC_PT_muscles")
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}
    assert "mimetic.add_control_object" in drawn("MIMETIC_PT_muscles")


def shown(face) -> list[np.ndarray]:
    return [evaluated_vertices(face, frame) for frame in FRAMES]


def control_of(face) -> bpy.types.Object:
    return face.mimetic.control_object


def of_the_muscles(control) -> str:
    """A bone of a muscle."""
    return next(bone.name for bone in control.pose.bones if "activation" in bone)


def test_the_face_does_what_it_does_by_its_shape_keys(extension, scene, looking):  # noqa: F811
    from mimetic.character.contact_shapes import contact_shapes

    options = {"contact_shapes": contact_shapes(looking)}
    expected = shown(baked(extension, scene, looking, **options))
    bpy.data.objects.remove(scene.mimetic.face)
    face = baked(extension, scene, looking, use_controls=True, **options)
    for one, other in zip(shown(face), expected, strict=True):
        assert np.abs(one - other).max() < METRES
    assert np.ptp(np.array(expected), axis=0).max() > 0.05


def test_a_take_is_one_action_with_the_clips_name(extension, face):
    control = control_of(face)
    action = control.animation_data.action
    assert action.name == "take"
    paths = {path.split("[")[0] for path in curves_of(extension, control)}
    assert paths == {"pose.bones"}
    if extension("compat").ACTIONS_HAVE_SLOTS:
        assert {slot.target_id_type for slot in action.slots} <= {"OBJECT", "KEY"}
    assert face.animation_data is None or face.animation_data.action is None


def test_an_existing_action_is_not_touched(extension, scene, sheet):
    face = baked(extension, scene, sheet)
    before = curves_of(extension, face.data.shape_keys)
    own = face.data.shape_keys.animation_data.action, face.animation_data.action
    baked(extension, scene, sheet, use_controls=True)
    assert all(action.name in bpy.data.actions and action.use_fake_user for action in own)
    first = control_of(face).animation_data.action
    count = len(extension("compat").curves_in(first))
    baked(extension, scene, sheet, use_controls=True)  # a second take beside the first
    assert control_of(face).animation_data.action != first
    assert len(extension("compat").curves_in(first)) == count
    face.mimetic.control_object.animation_data.action = None
    curves = extension("compat").curves_in(own[0])
    assert len(curves) == len(before)
    for curve in curves:
        points = np.array([p.co[:] for p in curve.keyframe_points])
        np.testing.assert_array_equal(points, before[f"{curve.data_path}[0]"])


def test_bones_are_mirrored_pairs_with_ranges_and_tips(face):
    control = control_of(face)
    bones = control.pose.bones
    for bone in bones:
        if bone.name.endswith(".L"):
            other = bones[bone.name[:-2] + ".R"]
            assert [*other.keys()] == [*bone.keys()]
    name = of_the_muscles(control)
    ui = bones[name].id_properties_ui("activation").as_dict()
    assert (ui["min"], ui["max"]) == (0.0, 1.0)
    assert ui["description"]
    assert bones[name].parent.name.endswith(name[-2:])  # its side's group
    assert {"head", "jaw"} <= set(bones.keys())


def test_groups_add_to_their_muscles(scene, face):
    control = control_of(face)
    scene.frame_set(9)
    group = next(bone for bone in control.pose.bones if "strength" in bone)
    keys = face.data.shape_keys
    control.animation_data.action = None
    group["strength"] = 0.5
    control.update_tag()
    bpy.context.view_layer.update()
    assert keys.key_blocks[group.name].value == pytest.approx(0.5)


def test_a_gaze_without_a_target_changes_nothing(extension, scene, looking):  # noqa: F811
    from mimetic import InvalidInput

    keys = baked(extension, scene, looking).data.shape_keys
    action = keys.animation_data.action
    values = looking.articulator_values.copy()
    values[-1, looking.articulators.index("gaze_yaw.L")] = 80
    with pytest.raises(InvalidInput, match="75"):
        baked(extension, scene, replace(looking, articulator_values=values), use_controls=True)
    assert keys.animation_data.action == action and not scene.mimetic.face.mimetic.has_controls


def test_the_gaze_follows_its_target(extension, scene, looking):  # noqa: F811
    face = baked(extension, scene, looking, use_controls=True)
    control = control_of(face)
    control.animation_data.action = None
    for bone in control.pose.bones:
        bone.location = (0, 0, 0)
    target = control.pose.bones["gaze"]
    distance = 0.5
    control.pose.bones["gaze"].location = (distance * np.tan(0.3), 0, 0)
    bpy.context.view_layer.update()
    assert target.bone.head_local.y < -0.4
    for side in "left", "right":
        assert getattr(face.mimetic, f"gaze_yaw_{side}") == pytest.approx(0.3, abs=2e-3)
        assert getattr(face.mimetic, f"gaze_pitch_{side}") == pytest.approx(0, abs=2e-3)


def test_removing_it_keeps_the_motion(extension, scene, face):
    expected = shown(face)
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}
    assert result()["num_curves"] > 40
    assert control_of(face) is None
    assert not face.data.shape_keys.animation_data.drivers
    for one, other in zip(shown(face), expected, strict=True):
        assert np.abs(one - other).max() < CLOSE
    assert "take" in bpy.data.actions


@pytest.fixture
def duplicate(face):
    """Of the face alone, as Shift D makes it."""
    bpy.context.view_layer.objects.active = face
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == face)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    return bpy.context.view_layer.objects.active


@pytest.mark.parametrize("use_curves", [True, False])
def test_a_duplicate_is_released_and_the_original_goes_on(scene, face, duplicate, use_curves):
    control, expected = control_of(face), shown(face)
    assert control_of(duplicate) == control
    scene.frame_set(20)
    now = evaluated_vertices(duplicate, 20)
    assert bpy.ops.mimetic.remove_control_object(use_curves=use_curves) == {"FINISHED"}
    assert f"{control.name} stays: it drives {face.name}" in result()["message"]
    assert control_of(face) == control and control.animation_data.action.name == "take"
    assert control_of(duplicate) is None and duplicate.parent is None
    for frame, one, points in zip(FRAMES, shown(face), expected, strict=True):
        assert np.abs(one - points).max() < CLOSE
        stays = points if use_curves else now
        assert np.abs(evaluated_vertices(duplicate, frame) - stays).max() < CLOSE
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}
    assert "stays" not in result()["message"]
    assert not [obj for obj in bpy.data.objects if obj.type == "ARMATURE"]


def test_a_duplicate_of_the_same_mesh_is_not_released(face):
    twin = face.copy()
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.objects.active = twin
    with pytest.raises(RuntimeError, match="shares its mesh with 1 more"):
        bpy.ops.mimetic.remove_control_object()
    assert control_of(face) == control_of(twin) is not None
    assert face.data.shape_keys.animation_data.drivers


def test_a_deleted_one_is_told_and_the_face_bakes_again(scene, face, sheet_file, capfd):
    bpy.data.objects.remove(control_of(face))
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.bake(use_contact=False) == {"FINISHED"}
    assert "was deleted" in capfd.readouterr().out
    keys = face.data.shape_keys
    assert not keys.animation_data.drivers
    scene.frame_set(1)
    start = np.array([key.value for key in keys.key_blocks])
    scene.frame_set(20)
    assert np.abs(np.array([key.value for key in keys.key_blocks]) - start).max() > 0.1


def test_shape_keys_are_not_keyed_while_it_drives_them(scene, face, sheet_file):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.context.view_layer.objects.active = face
    with pytest.raises(RuntimeError, match="driven by Face Controls"):
        bpy.ops.mimetic.bake(to="KEYS", use_contact=False)
    assert bpy.ops.mimetic.bake(use_contact=False) == {"FINISHED"}  # on the control object
    assert control_of(face).animation_data.action.name.startswith("take")


def test_a_renamed_key_is_driven_on(extension, scene, face, sheet):
    control = control_of(face)
    name = of_the_muscles(control)
    face.data.shape_keys.key_blocks[name].name = "Mine"
    baked(extension, scene, sheet, use_controls=True)
    assert scene.mimetic.face == face
    assert "Mine" in extension("scene_out.control_drivers").keys_driven(face)
    scene.frame_set(9)
    value = sheet.activations[8, sheet.muscles.index(name)]
    assert face.data.shape_keys.key_blocks["Mine"].value == pytest.approx(value, abs=1e-5)


def test_a_key_with_a_driver_of_ones_own_is_told(scene, sheet, extension):
    face = baked(extension, scene, sheet)
    face.data.shape_keys.animation_data.action = None
    name = sheet.muscles[0]
    face.data.shape_keys.driver_add(f'key_blocks["{name}"].value')
    bpy.context.view_layer.objects.active = face
    with pytest.raises(RuntimeError, match=f"Drivers of your own set {name} of Face"):
        bpy.ops.mimetic.add_control_object()
    with pytest.raises(ValueError, match=f"Drivers of your own set {name} of Face"):
        baked(extension, scene, sheet, use_controls=True)
    assert control_of(face) is None
    assert face.data.shape_keys.animation_data.action is None


def test_on_a_bound_head(extension, scene, hero, loaded):  # noqa: F811
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    keys = hero.data.shape_keys.key_blocks
    names = [*loaded.muscles, *loaded.articulators]
    expected, stands = {}, {}
    for frame in FRAMES:
        stands[frame] = world_at(hero, frame)
        expected[frame] = [keys[name].value for name in names]
    own = hero.data.shape_keys.animation_data.action
    assert bpy.ops.mimetic.bake(to="CONTROLS") == {"FINISHED"}
    control = control_of(hero)
    assert control.parent == hero
    for frame in FRAMES:
        np.testing.assert_allclose(world_at(hero, frame), stands[frame], atol=1e-5)
        actual = [keys[name].value for name in names]
        np.testing.assert_allclose(actual, expected[frame], atol=1e-5)
    assert own.name in bpy.data.actions
    # Bones stand before the skin, in the character's own size
    bone = control.matrix_world @ control.pose.bones["jaw"].head
    points = evaluated_vertices(hero, FRAMES[-1])
    assert np.linalg.norm(points - np.array(bone), axis=1).min() < 0.05


@pytest.mark.oldest_and_newest
def test_a_head_that_was_cut_is_driven_on(hero, loaded, scene):  # noqa: F811
    assert bpy.ops.mimetic.bake(to="CONTROLS") == {"FINISHED"}
    control, count = control_of(hero), len(hero.data.vertices)
    bpy.context.view_layer.objects.active = hero
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(hero.data)
    edited.verts.ensure_lookup_table()
    bmesh.ops.delete(edited, geom=edited.verts[count - 200 :], context="VERTS")
    bmesh.update_edit_mesh(hero.data)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert 0 < len(hero.data.vertices) < count
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert control_of(hero) == control
    scene.frame_set(9)
    name = loaded.muscles[0]
    value = hero.data.shape_keys.key_blocks[name].value
    assert value == pytest.approx(loaded.activations[8, 0], abs=1e-5)


def test_adding_one_keeps_the_look_and_one_undo_takes_it_back(scene):
    bpy.ops.mimetic.add_face()
    face = bpy.context.view_layer.objects.active
    expected = evaluated_vertices(face, 1)
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    control = control_of(face)
    assert bpy.context.view_layer.objects.active == control
    np.testing.assert_allclose(evaluated_vertices(face, 1), expected, atol=CLOSE)
    bpy.ops.mimetic.remove_control_object()
    assert control_of(face) is None
    np.testing.assert_allclose(evaluated_vertices(face, 1), expected, atol=CLOSE)


def test_what_would_not_be_seen_is_refused(scene, face, tmp_path):
    """Shape keys that are driven play no values of their own; a glTF would lose the motion."""
    bpy.context.view_layer.objects.active = face
    for name, options in (
        ("rest_face", {}),
        ("export_gltf", {"filepath": str(tmp_path / "face.glb")}),
        ("live", {}),
    ):
        operator = getattr(bpy.ops.mimetic, name)
        with pytest.raises(RuntimeError, match="driven by Face Controls"):
            operator(**options)
    bpy.ops.mimetic.remove_control_object()
    bpy.ops.mimetic.export_gltf(filepath=str(tmp_path / "face.glb"))
    assert (tmp_path / "face.glb").stat().st_size > 1e5


def test_each_step_is_one_undo_step(scene, sheet, extension):
    baked(extension, scene, sheet).data.shape_keys.animation_data.action = None
    bpy.context.view_layer.objects.active = scene.mimetic.face
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mimetic.add_control_object()
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    face = bpy.context.scene.mimetic.face
    assert control_of(face) is None
    assert not face.data.shape_keys.animation_data.drivers
    assert "Face Controls" not in bpy.data.objects
