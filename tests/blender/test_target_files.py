# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake --target` for other programs: ARKit's names, and eyeballs as objects that turn."""

import dataclasses
import json
import subprocess

import bpy
import numpy as np
import pytest
from test_bake_command import run_bake
from test_exports import FPS
from test_gltf import VALIDATOR, furthest_from_nearest, world_vertices
from test_head_parts import rows, split  # noqa: F401

FRAMES = (1, 4, 8)
METRES = 1e-4


@pytest.fixture
def gazing(tmp_path):
    """Eight frames in which the jaw opens, the brows rise and the eyes look about; its file."""
    from acting import make_acting
    from mimetic.performance.gaze import GAZE
    from mimetic.template.face_template import load_template

    rise = np.linspace(0, 1, 8)
    values = {"jaw_open": 0.5 * rise, "lid_upper.L": 0.3 * rise, "frontalis_medial.R": rise}
    acting = make_acting(values | {"zygomaticus_major.L": rise[::-1]})
    template = load_template()
    centers, radius = template.eye_spheres(template.vertices)
    eye_of = np.zeros(len(template.vertices), int)
    for eye, side in enumerate("LR"):
        eye_of[template.part_vertices(f"eye.{side}")] = eye + 1
    t = np.linspace(0, 3, 8)
    angles = np.stack([18 * np.sin(t), 10 * np.cos(t), 16 * np.sin(t), 10 * np.cos(t)], axis=1)
    modes = acting.articulator_modes
    performance = dataclasses.replace(
        acting,
        articulators=[*acting.articulators, *GAZE],
        articulator_values=np.hstack([acting.articulator_values, angles]),
        articulator_modes=np.concatenate([modes, np.zeros_like(modes[:4])]),
        eye_centers=centers,
        iris_centers=centers + np.array([0, 0, radius]),
        eye_of_vertex=eye_of,
        lid_following=np.tile([0.02, 1.0], (2, 1)),
    )
    path = tmp_path / "hero.npz"
    performance.save(path)
    return performance, path


def saved(scene, tmp_path) -> str:
    scene.render.fps = FPS
    path = tmp_path / "character.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return str(path)


def baked(file, out, target, *options):
    ran = run_bake(file, "--out", out, "--target", target, *options)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def check_valid(path) -> None:
    ran = subprocess.run([VALIDATOR, path], capture_output=True, text=True, check=False)
    report = json.loads(ran.stdout)
    assert report["issues"]["numErrors"] == 0, report["issues"]["messages"][:5]


def read_glb(path) -> dict[str, bpy.types.Object]:
    """Objects of a file in an empty scene, by name; its first frame is 0."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    bpy.ops.import_scene.gltf(filepath=str(path))
    return dict(bpy.context.scene.objects.items())


@pytest.mark.newest
def test_a_head_with_muscles_gets_arkits_names(scene, gazing, tmp_path):
    from mimetic.character import gltf
    from mimetic.retarget.unit_fit import unit_order, unit_values

    performance, file = gazing
    bpy.ops.mimetic.add_face()
    target = f"{saved(scene, tmp_path)}:{bpy.context.active_object.name}"
    said = baked(file, tmp_path / "a.glb", target, "--names", "arkit")
    assert "52 shapes made of its muscles" in said
    check_valid(tmp_path / "a.glb")
    _, weights, names = gltf.read_weights((tmp_path / "a.glb").read_bytes())
    assert sorted(names) == sorted(unit_order())
    actual = weights[:, [names.index(name) for name in unit_order()]]
    np.testing.assert_allclose(actual, unit_values(performance), atol=2e-3)
    assert actual[:, unit_order().index("jawOpen")].max() > 0.3


@pytest.mark.oldest_and_newest
def test_shapes_of_other_spellings_get_arkits_and_what_lacks_is_said(scene, gazing, tmp_path):
    from mimetic.character import gltf
    from mimetic.retarget.unit_fit import unit_order, unit_values

    performance, file = gazing
    bpy.ops.mesh.primitive_uv_sphere_add()
    head = bpy.context.active_object
    head.shape_key_add(name="Basis")
    for number, name in enumerate(("jaw_open", "eyeBlink_L", "mouthSmile_R", "fat")):
        key = head.shape_key_add(name=name)
        key.points[number].co.z += 0.1
        key.value = 0  # some versions of Blender add keys that are fully on
    target = f"{saved(scene, tmp_path)}:{head.name}"
    said = baked(file, tmp_path / "a.glb", target, "--names", "arkit")
    assert "of 3 controls driven" in said
    assert "and 43 more: muscles attached to it would make them" in said
    _, weights, names = gltf.read_weights((tmp_path / "a.glb").read_bytes())
    assert names == ["jawOpen", "eyeBlinkLeft", "mouthSmileRight", "fat"]
    columns = [unit_order().index(name) for name in names[:3]]
    np.testing.assert_allclose(weights[:, :3], unit_values(performance)[:, columns], atol=2e-3)
    assert not weights[:, 3].any()


def looks_of(node) -> np.ndarray:
    return np.array(node.matrix_local.to_3x3())


def check_looks(performance, eyes, character_in_parent=None) -> None:
    """Each eye looks where the performance does, in the head's own axes."""
    axes = np.eye(3) if character_in_parent is None else character_in_parent
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame - 1)
        for number, eye in enumerate(eyes):
            yaw, pitch = np.radians(
                performance.articulator_values[frame - 1, -4:][2 * number :][:2]
            )
            ahead = [np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)]
            actual = axes.T @ looks_of(eye) @ axes @ [0, -1, 0]
            np.testing.assert_allclose(actual, ahead, atol=3e-3)


@pytest.mark.newest
def test_eyeballs_of_a_head_become_nodes(scene, gazing, tmp_path):
    """The head without eyes moves as with them; the eyes turn about their middles."""
    from mimetic.template.face_template import load_template

    performance, file = gazing
    bpy.ops.mimetic.add_face()
    name = bpy.context.active_object.name
    target = f"{saved(scene, tmp_path)}:{name}"
    baked(file, tmp_path / "shapes.glb", target)
    said = baked(file, tmp_path / "nodes.glb", target, "--eyes", "nodes")
    assert "Eye.L, Eye.R turn" in said
    check_valid(tmp_path / "nodes.glb")
    whole = read_glb(tmp_path / "shapes.glb")[name]
    expected = [world_vertices(whole, frame - 1) for frame in FRAMES]
    objects = read_glb(tmp_path / "nodes.glb")
    head, *eyes = (objects[each] for each in (name, "Eye.L", "Eye.R"))
    assert not any(key.name.startswith("look_in") for key in head.data.shape_keys.key_blocks)
    assert any(key.name.startswith("look_up") for key in head.data.shape_keys.key_blocks)  # lids
    template = load_template()
    centers, radius = template.eye_spheres(template.vertices)
    for frame, points in zip(FRAMES, expected, strict=True):
        skin = world_vertices(head, frame - 1)
        assert len(skin) < len(points)
        assert furthest_from_nearest(skin, points) < METRES
        for eye, centre in zip(eyes, centers, strict=True):
            middle = np.array(head.matrix_world) @ [centre[0], -centre[2], centre[1], 1]
            reach = np.linalg.norm(world_vertices(eye, frame - 1) - middle[:3], axis=1)
            assert np.median(reach) == pytest.approx(radius, rel=0.5)
            assert np.linalg.norm(np.array(eye.matrix_world.translation) - middle[:3]) < 1e-3
    check_looks(performance, eyes)


@pytest.mark.newest
def test_eyeballs_that_are_objects_become_nodes_and_arkits_names_stay(
    extension,
    scene,
    split,  # noqa: F811
    gazing,
    tmp_path,
):
    performance, file = gazing
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    axes = np.array(extension("scene_out.bound").object_from_character(scene, split))[:3, :3]
    axes = axes / np.cbrt(np.linalg.det(axes))
    target = f"{saved(scene, tmp_path)}:Bust"
    baked(file, tmp_path / "a.glb", target, "--eyes", "nodes", "--names", "arkit")
    check_valid(tmp_path / "a.glb")
    objects = read_glb(tmp_path / "a.glb")
    meshes = {name for name, obj in objects.items() if obj.type == "MESH"}
    assert meshes == {"Bust", "Eye.L", "Eye.R", "teeth_lower", "teeth_upper", "tongue"}
    names = objects["Bust"].data.shape_keys.key_blocks.keys()[1:]
    assert len(names) == 52 and "eyeLookInLeft" in names
    eyes = [objects["Eye.L"], objects["Eye.R"]]
    assert all(eye.parent == objects["Bust"] for eye in eyes)
    check_looks(performance, eyes, axes)
    jaw = objects["teeth_lower"].data.shape_keys.key_blocks
    heads = objects["Bust"].data.shape_keys.key_blocks
    values = []
    for frame in range(8):
        scene = bpy.context.scene
        scene.frame_set(frame)
        values.append((jaw["jawOpen"].value, heads["jawOpen"].value))
    np.testing.assert_allclose(*np.array(values).T, atol=1e-3)
    assert np.ptp(np.array(values)[:, 0]) > 0.02


def on_rig(obj, frame: int) -> np.ndarray:
    """Vertices in the world as the armature has them."""
    bpy.context.scene.frame_set(frame)
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([evaluated.matrix_world @ vertex.co for vertex in evaluated.data.vertices])


@pytest.mark.oldest_and_newest
def test_eyes_of_a_head_on_a_rig_go_with_its_bone(scene, gazing, tmp_path):
    """A skinned mesh carries no nodes: its eyes are below the bone."""
    _, file = gazing
    bpy.ops.mimetic.add_face()
    head = bpy.context.active_object
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("head")
    bone.head, bone.tail = (0, 0.02, -0.05), (0, 0.01, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    pose = armature.pose.bones["head"]
    pose.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (8, 0.6)):
        pose.rotation_euler = (0, angle, 0)
        pose.keyframe_insert("rotation_euler", frame=frame)
    head.vertex_groups.new(name="head").add(range(len(head.data.vertices)), 1.0, "REPLACE")
    head.modifiers.new("Armature", "ARMATURE").object = armature
    head.parent = armature
    name = head.name
    target = f"{saved(scene, tmp_path)}:{name}"
    baked(file, tmp_path / "shapes.glb", target)
    baked(file, tmp_path / "nodes.glb", target, "--eyes", "nodes")
    check_valid(tmp_path / "nodes.glb")
    meshes = (o for o in read_glb(tmp_path / "shapes.glb").values() if o.type == "MESH")
    (whole,) = (mesh for mesh in meshes if mesh.data.shape_keys)  # others show bones
    expected = [on_rig(whole, frame - 1) for frame in FRAMES]
    objects = read_glb(tmp_path / "nodes.glb")
    for frame, points in zip(FRAMES, expected, strict=True):
        for eye in ("Eye.L", "Eye.R"):
            # Round, so where it looks hardly moves its surface
            assert furthest_from_nearest(world_vertices(objects[eye], frame - 1), points) < 2.5e-3
    moved = expected[-1] - expected[0]
    assert np.abs(moved).max() > 0.01


@pytest.mark.newest
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--names", "arkit"], "no shape of ARKit's 52 names that is free to move, and no muscles"),
        (["--eyes", "nodes"], "has no muscles, so its eyeballs are not known"),
        (["--names", "arkit", "--controls", "own"], "leave --controls and --preset out"),
    ],
)
def test_what_a_target_lacks_is_said(scene, gazing, tmp_path, options, said):
    bpy.ops.mesh.primitive_cube_add()
    target = f"{saved(scene, tmp_path)}:Cube"
    ran = run_bake(gazing[1], "--out", tmp_path / "a.glb", "--target", target, *options)
    assert ran.returncode == 2
    assert said in ran.stderr
    assert not (tmp_path / "a.glb").exists()


@pytest.mark.newest
def test_a_face_with_a_control_object_is_exported_by_its_shapes(extension, scene, gazing, tmp_path):
    from mimetic.character import gltf

    _, file = gazing
    bpy.ops.mimetic.add_face()
    face = bpy.context.active_object
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    with pytest.raises(ValueError, match="is driven by"):
        extension("scene_out.gltf").export(scene, tmp_path / "refused.glb", face)
    baked(file, tmp_path / "a.glb", f"{saved(scene, tmp_path)}:{face.name}")
    _, weights, names = gltf.read_weights((tmp_path / "a.glb").read_bytes())
    rise = weights[:, names.index("frontalis_medial.R")]
    np.testing.assert_allclose(rise, np.linspace(0, 1, 8), atol=2e-3)
    objects = read_glb(tmp_path / "a.glb")
    assert not [obj for obj in objects.values() if obj.type == "ARMATURE"]
