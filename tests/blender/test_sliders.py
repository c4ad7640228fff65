# SPDX-License-Identifier: GPL-3.0-or-later
"""A face without footage, and sliders that move it beside its curves."""

import bpy
import numpy as np
import pytest
from panel_texts import drawn

METRES = 2e-6


@pytest.fixture(scope="session")
def head():
    from mimetic.character.canonical_head import make_head

    return make_head()


@pytest.fixture
def added():
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return bpy.context.active_object


def evaluated(face) -> np.ndarray:
    """V x 3 in the object's frame, as Blender evaluates the shape keys."""
    for modifier in face.modifiers:
        modifier.show_viewport = False
    shown = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(face.data.vertices), dtype=np.float32)
    shown.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def shape_sum(head, values) -> np.ndarray:
    from mimetic.character.placement import to_object

    by_name = {shape.name: shape for shape in (*head.shapes, *head.groups)}
    offsets = sum(value * by_name[name].offsets for name, value in values.items())
    return to_object(head.vertices + offsets)


def test_a_face_comes_without_footage(scene, added, head):
    scene.cursor.location = (1, 2, 3)
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    face = bpy.context.active_object
    assert face != added
    assert tuple(face.location) == (1, 2, 3)
    assert [o for o in scene.objects if o.select_get()] == [face]
    assert scene.mimetic.face is None  # the person who was captured gets a face of their own
    names = [shape.name for shape in (*head.shapes, *head.groups)]
    keys = face.data.shape_keys
    assert [key.name for key in keys.key_blocks] == ["Basis", *names, "contact"]
    assert keys.key_blocks["lid_upper.L"].slider_min == -1.0
    assert len(face.data.materials) > 5
    np.testing.assert_allclose(evaluated(face), shape_sum(head, {"jaw_open": 0}), atol=METRES)


def test_adding_a_face_is_one_undo_step():
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.add_face("EXEC_DEFAULT", True) == {"FINISHED"}
    assert "Face" in bpy.data.objects
    bpy.ops.ed.undo()
    assert len(bpy.data.objects) == 0
    assert len(bpy.data.shape_keys) == 0
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["Face"].mimetic.shapes) == 60


def test_no_face_is_added_in_edit_mode(added):
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.mimetic.add_face.poll()
    assert not bpy.ops.mimetic.rest_face.poll()


def test_contact_is_not_switched_in_edit_mode_which_would_bring_it_back(added):
    leave = f"Leave {added.name}'s edit mode first"
    assert leave not in drawn("MIMETIC_PT_muscles")
    bpy.ops.object.mode_set(mode="EDIT")
    assert leave in drawn("MIMETIC_PT_muscles")
    bpy.ops.object.mode_set(mode="OBJECT")


def test_muscles_jaw_and_groups_add_up(added, head):
    added.mimetic.use_contact = False
    values = {"zygomaticus_major.L": 0.8, "jaw_open": 0.4, "Brow Raisers": 0.5, "Eye Ring.R": -0.3}
    for name, value in values.items():
        added.data.shape_keys.key_blocks[name].value = value
    np.testing.assert_allclose(evaluated(added), shape_sum(head, values), atol=METRES)


def test_a_group_adds_to_baked_curves_and_leaves_them(extension, scene, performance):
    """The layer is keyed on its own; the muscles' curves stay what was captured."""
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, performance, "take")
    face = scene.mimetic.face
    holder = extension("compat").curves(face.data.shape_keys)
    before = [[tuple(p.co) for p in c.keyframe_points] for c in holder.fcurves]
    frame = 8
    scene.frame_set(frame)
    plain = evaluated(face)
    layer = face.data.shape_keys.key_blocks["Lip Corners.L"]
    layer.value = 0.5
    layer.keyframe_insert("value", frame=frame)
    layer.value = 0.0
    layer.keyframe_insert("value", frame=frame + 10)
    scene.frame_set(frame)
    assert layer.value == pytest.approx(0.5)
    members = [
        mode
        for name, group, mode in zip(
            performance.muscles, performance.groups, performance.muscle_modes, strict=True
        )
        if group == 1 and name.endswith(".L")
    ]
    from mimetic.character.placement import to_object

    added = 0.5 * to_object(np.sum(members, axis=0, dtype=np.float64))
    np.testing.assert_allclose(evaluated(face) - plain, added, atol=METRES)
    curves = {curve.data_path: curve for curve in holder.fcurves}
    own = curves.pop(layer.path_from_id("value"))
    assert len(own.keyframe_points) == 2
    assert [[tuple(p.co) for p in c.keyframe_points] for c in curves.values()] == before


def test_baking_again_keeps_the_level_of_a_group(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take")
    keys = scene.mimetic.face.data.shape_keys
    keys.key_blocks["Brow Raisers"].value = -0.25
    extension("scene_out").bake(scene, performance, "take")
    assert keys.key_blocks["Brow Raisers"].value == -0.25
    names = [key.name for key in keys.key_blocks]
    assert len(names) == len(set(names)) == 1 + 41 + 21
    assert names[-21] == "Lip Corners"


def test_rest_puts_every_slider_to_nothing(added, head):
    blocks = added.data.shape_keys.key_blocks
    for name in ("mentalis.L", "jaw_side", "Eye Ring"):
        blocks[name].value = 0.5
    assert bpy.ops.mimetic.rest_face() == {"FINISHED"}
    assert {key.value for key in blocks[1:-1]} == {0.0}
    np.testing.assert_allclose(evaluated(added), shape_sum(head, {"jaw_open": 0}), atol=METRES)


def test_setting_all_sliders_at_once_is_setting_each(extension, added, head):
    sliders = extension("scene_out.sliders")
    added.mimetic.use_contact = False
    random = np.random.default_rng(0)
    values = {shape.name: float(random.uniform(0, 1)) for shape in head.shapes}
    sliders.set_values(added, values)
    read = sliders.values_of(added)
    assert {name: read[name] for name in values} == pytest.approx(values)
    np.testing.assert_allclose(evaluated(added), shape_sum(head, values), atol=METRES)
    sliders.set_values(added, {"jaw_open": 7.0})
    assert sliders.values_of(added)["jaw_open"] == 1.0
    added.data.shape_keys.key_blocks["jaw_open"].mute = True
    assert sliders.values_of(added)["jaw_open"] == 0.0


def test_panels_mean_the_selected_face(extension, scene, added, performance):
    scene_in = extension("scene_in")
    assert scene_in.face_of(bpy.context) == added
    extension("scene_out").bake(scene, performance, "take")
    assert scene_in.face_of(bpy.context) == added
    bpy.context.view_layer.objects.active = None
    assert scene_in.face_of(bpy.context) == scene.mimetic.face


def test_an_added_face_is_exported(added, tmp_path):
    from mimetic.character import gltf

    added.data.shape_keys.key_blocks["jaw_open"].keyframe_insert("value", frame=1)
    added.data.shape_keys.key_blocks["jaw_open"].value = 1.0
    added.data.shape_keys.key_blocks["jaw_open"].keyframe_insert("value", frame=11)
    path = tmp_path / "face.glb"
    assert bpy.ops.mimetic.export_gltf(filepath=str(path)) == {"FINISHED"}
    _, weights, names = gltf.read_weights(path.read_bytes())
    assert weights[-1, names.index("jaw_open")] == pytest.approx(1.0)
    assert "Lip Corners" not in names


def test_only_groups_that_do_something_are_exported(extension, scene, performance, tmp_path):
    from mimetic.character import gltf

    extension("scene_out").bake(scene, performance, "take")
    blocks = scene.mimetic.face.data.shape_keys.key_blocks
    export = extension("scene_out.gltf").export
    export(scene, tmp_path / "idle.glb")
    _, _, idle = gltf.read_weights((tmp_path / "idle.glb").read_bytes())
    assert not any(name.startswith("Brow Raisers") for name in idle)
    blocks["Brow Raisers"].value = 0.5
    export(scene, tmp_path / "used.glb")
    _, weights, used = gltf.read_weights((tmp_path / "used.glb").read_bytes())
    assert set(used) - set(idle) == {"Brow Raisers"}
    assert weights[:, used.index("Brow Raisers")] == pytest.approx(0.5)
    muscle = performance.muscles[4]
    assert np.ptp(weights[:, used.index(muscle)]) > 0.5
    assert not any(key.mute for key in blocks)
