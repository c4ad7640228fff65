# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character's own head, which has muscles by landmarks."""

import dataclasses

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix
from panel_texts import drawn

pytestmark = pytest.mark.newest

UNIT = 0.01  # metres in the object's unit: modelled in centimetres
FRAMES = (1, 9, 24, 40)


@pytest.fixture
def hero(parts, scene):
    """Modelled looking along x, below its origin, standing turned in the scene; bound, active."""
    points, faces, marks = parts
    turned = points @ np.array(Euler((0, 0, np.pi / 2)).to_matrix()).T - [0, 0, 20]
    mesh = bpy.data.meshes.new("Hero")
    mesh.from_pydata(turned, [], faces.tolist())
    head = bpy.data.objects.new("Hero", mesh)
    scene.collection.objects.link(head)
    head.scale = (UNIT,) * 3
    head.location = (0.3, -0.2, 1.5)
    head.rotation_euler = (0.1, 0.2, 0.7)
    for name, vertex in marks.items():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    scene.render.fps = 25
    return head


@pytest.fixture
def loaded(acted, hero):
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    return acted[0]


def curves_of(extension, block) -> dict[str, np.ndarray]:
    return {
        f"{curve.data_path}[{curve.array_index}]": np.array(
            [p.co[:] for p in curve.keyframe_points]
        )
        for curve in extension("compat").curves(block).fcurves
    }


def world_at(shown, frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    return np.array(shown.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)


def slider(name: str) -> str:
    return f'key_blocks["{name}"].value[0]'


def test_the_performance_goes_on_the_active_head(extension, scene, hero, loaded, capfd):
    before = [*bpy.data.objects], hero.data.shape_keys.key_blocks.keys()
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert ([*bpy.data.objects], hero.data.shape_keys.key_blocks.keys()) == before
    assert scene.mimetic.face is None
    assert scene.camera is None
    assert bpy.context.view_layer.objects.active == hero
    curves = curves_of(extension, hero.data.shape_keys)
    values = dict(zip(loaded.muscles, loaded.activations.T, strict=True))
    values |= zip(loaded.articulators, loaded.articulator_values.T, strict=True)
    assert curves.keys() == {slider(name) for name in values}
    for name, expected in values.items():
        np.testing.assert_array_equal(curves[slider(name)][:, 0], loaded.frame)
        np.testing.assert_allclose(curves[slider(name)][:, 1], expected, atol=1e-6)
    output = capfd.readouterr().out
    assert "47 curves from frame 1 to 40 on Hero" in output
    # What it has beyond the performance is named
    beyond = {shape.name for shape in hero.mimetic.shapes} - values.keys()
    (named,) = [line for line in output.splitlines() if "leaves alone" in line]
    assert len(beyond) == 19
    assert all(name in named for name in beyond)


def test_the_skin_moves_as_by_hand(hero, loaded):
    bpy.ops.mimetic.bake(use_head_motion=False)
    bpy.context.scene.frame_set(17)
    played = evaluated(hero)
    hero.data.shape_keys.animation_data_clear()
    for name, value in zip(loaded.muscles, loaded.activations[16], strict=True):
        hero.data.shape_keys.key_blocks[name].value = value
    for name, value in zip(loaded.articulators, loaded.articulator_values[16], strict=True):
        hero.data.shape_keys.key_blocks[name].value = value
    np.testing.assert_allclose(evaluated(hero), played, atol=1e-4)  # a micrometre
    assert np.ptp(played - rest_of(hero), axis=0).max() > 0.5


def test_few_keys_with_handles_are_as_near_as_asked_for(extension, scene, hero, loaded):
    bpy.ops.mimetic.bake(use_few_keys=True, tolerance=0.04, use_phases=True)
    assert hero.mimetic.takes[-1].settings == "few keys within 0.04, at phases"
    curves = extension("compat").curves(hero.data.shape_keys).fcurves
    assert sum(len(curve.keyframe_points) for curve in curves) < 0.4 * 40 * len(curves)
    for name, expected in zip(loaded.muscles, loaded.activations.T, strict=True):
        curve = next(c for c in curves if c.data_path == slider(name)[:-3])
        actual = [curve.evaluate(frame) for frame in loaded.frame]
        np.testing.assert_allclose(actual, expected, atol=0.05)


def evaluated(face) -> np.ndarray:
    shown = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(face.data.vertices), dtype=np.float32)
    shown.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def rest_of(face) -> np.ndarray:
    basis = face.data.shape_keys.reference_key
    points = np.empty(3 * len(basis.points), dtype=np.float32)
    basis.points.foreach_get("co", points)
    return points.reshape(-1, 3)


def test_its_head_turns_about_its_own_centre_as_the_actors(hero, loaded):
    """From where it stands, whatever its axes, origin and unit are."""
    from mimetic.performance.projection import reference_index

    stands = np.array(hero.matrix_world)
    at_rest = reference_index(loaded)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    np.testing.assert_allclose(world_at(hero, int(loaded.frame[at_rest])), stands, atol=1e-5)
    # The template's head: x left, y up, z out of the face, from midway between the ears
    modelled = Matrix.Translation((0, 0, -20)) @ Euler((0, 0, np.pi / 2)).to_matrix().to_4x4()
    axes = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    in_metres = np.diag([1 / UNIT, 1 / UNIT, 1 / UNIT, 1])
    world_from_head = stands @ np.array(modelled) @ in_metres @ axes
    for frame in FRAMES:
        since = np.linalg.inv(loaded.head_pose[at_rest]) @ loaded.head_pose[frame - 1]
        expected = world_from_head @ since @ np.linalg.inv(world_from_head) @ stands
        np.testing.assert_allclose(world_at(hero, frame), expected, atol=2e-5)


def test_a_second_bake_starts_from_where_the_first_did(scene, hero, loaded):
    bpy.ops.mimetic.bake()
    first = [world_at(hero, frame) for frame in FRAMES]
    scene.frame_set(31)
    bpy.ops.mimetic.bake()
    assert scene.frame_current == 31
    for frame, expected in zip(FRAMES, first, strict=True):
        np.testing.assert_allclose(world_at(hero, frame), expected, atol=1e-5)


def test_a_second_head_bake_starts_from_where_the_first_did(scene, hero, loaded):
    scene.mimetic.head.target = hero
    bpy.ops.mimetic.bake_head()
    first = [world_at(hero, frame) for frame in FRAMES]
    scene.frame_set(31)
    bpy.ops.mimetic.bake_head()
    for frame, expected in zip(FRAMES, first, strict=True):
        np.testing.assert_allclose(world_at(hero, frame), expected, atol=1e-5)
    scene.mimetic.head.mode = "ABSOLUTE"
    bpy.ops.mimetic.bake_head()
    scene.mimetic.head.mode = "RELATIVE"
    scene.frame_set(12)
    stands = world_at(hero, 12)
    scene.mimetic.head.rest_frame = 12
    bpy.ops.mimetic.bake_head()  # as filmed is where it stands now
    np.testing.assert_allclose(world_at(hero, 12), stands, atol=1e-5)


def parent(hero, scene):
    rig = bpy.data.objects.new("Body", None)
    scene.collection.objects.link(rig)
    hero.parent = rig
    return "Body"


def armature(hero, scene):
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(rig)
    hero.modifiers.new("Armature", "ARMATURE").object = rig
    return "Rig"


def constraint(hero, scene):
    return hero.constraints.new("COPY_LOCATION").name


def driver(hero, scene):
    hero.driver_add("rotation_euler", 2)
    return "drivers"


def deltas(hero, scene):
    hero.delta_location.x = 1
    return "delta"


@pytest.mark.parametrize("rigged", [parent, armature, constraint, driver, deltas])
def test_a_head_that_a_rig_moves_stays_on_it(scene, hero, loaded, capfd, rigged):
    mover = rigged(hero, scene)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    output = capfd.readouterr().out
    assert mover in output
    assert "Bake Head" in output
    assert "41 curves" in output
    assert not (hero.animation_data and hero.animation_data.action)


def test_the_heads_motion_can_be_left_out(hero, loaded):
    bpy.ops.mimetic.bake(use_head_motion=False)
    assert hero.animation_data is None


def test_what_it_cannot_play_is_named(extension, hero, loaded, capfd):
    blocks = hero.data.shape_keys.key_blocks
    hero.shape_key_remove(blocks["jaw_open"])
    blocks["mentalis.L"].driver_add("value")
    blocks["jaw_side"].slider_min = -0.25
    limits = {key.name: (key.slider_min, key.slider_max) for key in blocks}
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    output = capfd.readouterr().out
    assert "Warning: Hero has no slider jaw_open" in output
    assert "drivers of Hero set mentalis.L" in output
    assert "the limits of jaw_side" in output
    curves = curves_of(extension, hero.data.shape_keys)
    assert len(curves) == 39
    assert slider("mentalis.L") not in curves
    assert {key.name: (key.slider_min, key.slider_max) for key in blocks} == limits


def test_a_slider_that_was_renamed_plays_too(extension, hero, loaded, capfd):
    hero.data.shape_keys.key_blocks["jaw_open"].name = "Mouth Open"
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert "has no slider" not in capfd.readouterr().out
    curves = curves_of(extension, hero.data.shape_keys)
    expected = loaded.articulator_values[:, loaded.articulators.index("jaw_open")]
    np.testing.assert_allclose(curves[slider("Mouth Open")][:, 1], expected, atol=1e-6)


def test_a_head_with_no_slider_of_it_is_left_alone(hero, acted, tmp_path):
    other = dataclasses.replace(
        acted[0],
        muscles=[f"muscle_{i:02d}.L" for i in range(36)],
        articulators=[f"bone_{i}" for i in range(5)],
    )
    other.save(tmp_path / "other.npz")
    bpy.ops.mimetic.load_performance(filepath=str(tmp_path / "other.npz"))
    with pytest.raises(RuntimeError, match=r"Hero has no slider muscle_00\.L"):
        bpy.ops.mimetic.bake()
    assert hero.data.shape_keys.animation_data is None
    assert hero.animation_data is None


def test_detail_is_left_out_and_said(hero, acted, tmp_path, capfd):
    detailed = dataclasses.replace(
        acted[0],
        detail_modes=acted[0].muscle_modes[:2],
        detail_coefficients=np.ones((acted[0].num_frames, 2)),
    )
    detailed.save(tmp_path / "detail.npz")
    bpy.ops.mimetic.load_performance(filepath=str(tmp_path / "detail.npz"))
    capfd.readouterr()
    bpy.ops.mimetic.bake()
    assert "detail is" not in capfd.readouterr().out
    bpy.ops.mimetic.bake(use_detail=True)
    assert "detail is" in capfd.readouterr().out


def test_what_else_moves_the_head_goes_on(extension, hero, loaded):
    hero.shape_key_add(name="viseme", from_mix=False)
    viseme = hero.data.shape_keys.key_blocks["viseme"]
    for frame, value in ((1, 0.0), (30, 1.0)):
        viseme.value = value
        viseme.keyframe_insert("value", frame=frame)
    mine = hero.data.shape_keys.animation_data.action
    bpy.ops.mimetic.bake()
    curves = curves_of(extension, hero.data.shape_keys)
    assert len(curves[slider("viseme")]) == 2
    assert len(curves[slider("jaw_open")]) == 40
    assert hero.data.shape_keys.animation_data.action != mine
    assert mine.use_fake_user


def test_the_scenes_face_and_other_meshes_are_baked_as_before(scene, hero, loaded):
    """The active mesh decides: the face beside a bound head, and a mesh without sliders."""
    bpy.context.view_layer.objects.active = None
    bpy.ops.mimetic.bake(use_contact=False)
    face = scene.mimetic.face
    assert face.name == "Face"
    assert bpy.context.view_layer.objects.active == face
    bpy.ops.mimetic.bake(use_contact=False)  # the face is active now
    prop = bpy.data.objects.new("Hat", bpy.data.meshes.new("Hat"))
    scene.collection.objects.link(prop)
    bpy.context.view_layer.objects.active = prop
    bpy.ops.mimetic.bake(use_contact=False)
    assert scene.mimetic.face == face
    assert hero.data.shape_keys.animation_data is None
    bpy.context.view_layer.objects.active = hero
    bpy.ops.mimetic.bake()
    assert hero.data.shape_keys.animation_data.action


def test_a_copy_of_the_face_plays_nothing_of_the_take_before(extension, scene, acted, capfd):
    """Its detail and contact were of that take, and would play on beside the new one's muscles."""
    random = np.random.default_rng(5)
    before = dataclasses.replace(
        acted[0],
        detail_modes=acted[0].muscle_modes[:2],
        detail_coefficients=random.normal(size=(acted[0].num_frames, 2)),
    )
    scene.render.fps = 25
    extension("scene_out").bake(scene, before, "first")
    copy = scene.mimetic.face.copy()
    copy.data = copy.data.copy()
    scene.collection.objects.link(copy)
    bpy.context.view_layer.objects.active = copy
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert "an earlier take's detail" in capfd.readouterr().out
    curves = curves_of(extension, copy.data.shape_keys)
    assert len(curves) == 41
    blocks = copy.data.shape_keys.key_blocks
    assert [blocks[f"detail.{i:03d}"].value for i in range(2)] == [0, 0]
    # The face itself was not selected, and stays
    first = curves_of(extension, scene.mimetic.face.data.shape_keys)
    assert np.ptp(first[slider("detail.000")][:, 1]) > 0.1


def test_it_is_one_undo_step_and_the_same_again(extension, hero, loaded):
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.bake("EXEC_DEFAULT", True) == {"FINISHED"}
    first = curves_of(extension, bpy.data.objects["Hero"])
    bpy.ops.ed.undo()
    assert not bpy.data.actions
    # As the redo panel does: undone, then run at once
    assert bpy.ops.mimetic.bake("EXEC_DEFAULT", True) == {"FINISHED"}
    again = curves_of(extension, bpy.data.objects["Hero"])
    assert again.keys() == first.keys()
    for name, keys in first.items():
        np.testing.assert_allclose(again[name], keys, atol=1e-6)


def test_attach_muscles_is_offered_beside_a_face(scene, hero, loaded):
    """Also where the scene has a face, whose sliders the panel showed whatever was active."""
    bpy.context.view_layer.objects.active = None
    bpy.ops.mimetic.bake(use_contact=False)
    assert "mimetic.rest_face" in drawn("MIMETIC_PT_muscles")
    other = bpy.data.objects.new("Other", hero.data.copy())
    scene.collection.objects.link(other)
    other.shape_key_clear()
    bpy.context.view_layer.objects.active = other
    shown = drawn("MIMETIC_PT_muscles")
    assert "mimetic.attach_muscles" in shown and "Muscles on Other" in shown
    assert bpy.ops.mimetic.attach_muscles.poll()
    bpy.context.view_layer.objects.active = hero
    assert "mimetic.rest_face" in drawn("MIMETIC_PT_muscles")
    assert "Bake on Hero" in drawn("MIMETIC_PT_capture_view")


def test_a_bound_head_in_edit_mode_or_linked_is_refused(hero, loaded, tmp_path):
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.mimetic.bake.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    path = bpy.context.scene.mimetic.performance_path
    library = str(tmp_path / "hero.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(library, link=True) as (_, target):
        target.objects = ["Hero"]
    bpy.ops.mimetic.load_performance(filepath=path)
    for linked in (target.objects[0], target.objects[0].override_create(remap_local_usages=False)):
        bpy.context.scene.collection.objects.link(linked)
        bpy.context.view_layer.objects.active = linked
        with pytest.raises(RuntimeError, match="Make Local"):
            bpy.ops.mimetic.bake()
    # An override of the mesh as well keeps curves of its sliders
    linked.data = linked.data.override_create(remap_local_usages=False)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    bpy.context.scene.collection.objects.unlink(target.objects[0])
    for save_or_open in (bpy.ops.wm.save_as_mainfile, bpy.ops.wm.open_mainfile):
        save_or_open(filepath=str(tmp_path / "shot.blend"))
    kept = bpy.context.scene.objects["Hero"]
    assert kept.data.shape_keys.animation_data.action
    bpy.context.scene.frame_set(17)
    assert kept.data.shape_keys.key_blocks["frontalis_medial.L"].value > 0
