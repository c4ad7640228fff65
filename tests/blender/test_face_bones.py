# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the bones of a rig's face: `mimetic bake --target RIG.blend:ARMATURE`."""

import bpy
import numpy as np
import pytest
from mathutils import Vector
from test_bake_command import run_bake

pytestmark = pytest.mark.oldest_and_newest

# Bone: where it is on the face, by a landmark of the template; how far it takes skin along, metres
BONES = {
    "brow.L": ("brow_inner.L", 0.018),
    "brow.R": ("brow_inner.R", 0.018),
    "lips.L": ("mouth_corner.L", 0.015),
    "lips.R": ("mouth_corner.R", 0.015),
}


@pytest.fixture
def rig(parts, scene):
    """A head with muscles on an armature: head, jaw at its hinge, brows, corners of the mouth."""
    from mimetic.character.placement import to_object
    from mimetic.template.face_template import load_template

    template = load_template()
    points, faces, marks = parts
    points = points * 0.01
    mesh = bpy.data.meshes.new("Hero")
    mesh.from_pydata(points, [], faces.tolist())
    face = bpy.data.objects.new("Hero", mesh)
    scene.collection.objects.link(face)
    for name, vertex in marks.items():
        face.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = face
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    places = {bone: points[template.landmark(mark)] for bone, (mark, _) in BONES.items()}
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bones = armature.data.edit_bones
    head = bones.new("head")
    head.head, head.tail = (0, 0.02, -0.05), (0, 0.02, 0.1)
    jaw = bones.new("jaw")
    jaw.head = Vector(to_object(np.asarray(template.jaw_hinge).mean(axis=0)))
    jaw.tail = Vector(points[template.landmark("chin")])
    jaw.parent = head
    for name, place in places.items():
        bone = bones.new(name)
        bone.head = Vector(place)
        bone.tail = bone.head + Vector((0, -0.02, 0))
        bone.parent = head
    bpy.ops.object.mode_set(mode="OBJECT")
    weights = {
        name: np.exp(-((points - places[name]) ** 2).sum(axis=1) / (2 * radius**2))
        for name, (_, radius) in BONES.items()
    }
    from mimetic.character.canonical_head import make_head

    jaw_open = next(shape.offsets for shape in make_head().shapes if shape.name == "jaw_open")
    moved = np.linalg.norm(jaw_open, axis=1)
    weights["jaw"] = moved / moved.max()
    rest = 1 - np.minimum(sum(weights.values()), 1)
    for name, own in {**weights, "head": rest}.items():
        group = face.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(own > 1e-3):
            group.add([int(vertex)], float(own[vertex]), "REPLACE")
    face.modifiers.new("Armature", "ARMATURE").object = armature
    face.modifiers.new("Subdivision", "SUBSURF")
    return armature


@pytest.fixture
def acting_file(tmp_path):
    """The jaw opens while the brows rise; then the left corner of the mouth alone is pulled."""
    from acting import make_acting

    rise = np.linspace(0, 1, 6)
    none = np.zeros(6)
    values = {
        "jaw_open": np.r_[0.7 * rise, none],
        **{f"frontalis_medial.{side}": np.r_[rise, none] for side in "LR"},
        "zygomaticus_major.L": np.r_[none, rise],
    }
    path = tmp_path / "hero.npz"
    make_acting(values).save(path)
    return path


def points_at(face, frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    face.modifiers["Subdivision"].show_viewport = False
    evaluated = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(evaluated.data.vertices), np.float32)
    evaluated.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def test_bones_take_the_skin_where_muscles_do(rig, scene, acting_file, tmp_path):
    from mimetic.template.face_template import load_template

    landmark = load_template().landmark
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"), check_existing=False)
    out = tmp_path / "out.blend"
    target = f"{tmp_path / 'rig.blend'}:Rig"
    ran = run_bake(acting_file, "--out", out, "--target", target, "--controls", "own")
    assert ran.returncode == 0, ran.stderr
    assert "of the face's motion explained" in ran.stdout
    bpy.ops.wm.open_mainfile(filepath=str(out))
    face, armature = bpy.data.objects["Hero"], bpy.data.objects["Rig"]
    assert armature.animation_data.action.name == "hero head"  # one take: head and face
    assert face.data.shape_keys.animation_data is None
    rest, brows, smile = (points_at(face, frame) for frame in (1, 6, 12))
    chin, corner = landmark("chin"), landmark("mouth_corner.L")
    assert (brows - rest)[chin, 2] < -0.008  # the jaw opens
    for side in "LR":
        assert (brows - rest)[landmark(f"brow_inner.{side}"), 2] > 0.002
    pulled = (smile - rest)[corner]
    assert pulled[0] > 0.001  # outward, to the subject's left
    assert pulled[2] > 0.001  # and up
    assert np.abs((smile - rest)[chin]).max() < 0.003


def test_a_rig_without_muscles_says_what_to_do(rig, scene, acting_file, tmp_path):
    bpy.data.objects["Hero"].modifiers.clear()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"), check_existing=False)
    target = f"{tmp_path / 'rig.blend'}:Rig"
    ran = run_bake(
        acting_file, "--out", tmp_path / "out.blend", "--target", target, "--controls", "own"
    )
    assert ran.returncode == 2
    assert "Rig deforms no mesh with muscles: attach muscles" in ran.stderr


def test_measuring_leaves_the_pose_as_it_was(extension, rig, scene):
    bones = extension("scene_out.face_bones")
    rig.pose.bones["jaw"].rotation_mode = "XYZ"
    rig.pose.bones["jaw"].rotation_euler[0] = 0.1
    rig.pose.bones["brow.L"].location = (0.001, 0.002, 0)
    bpy.context.view_layer.update()
    before = {bone.name: np.array(bone.matrix_basis) for bone in rig.pose.bones}
    own = bones.channels(rig)
    assert {channel.bone for channel in own} == {*BONES, "jaw"}
    responses = bones._responses(rig, bones.deformed_face(scene, rig), own)
    assert np.abs(responses).max() > 0.001
    for bone in rig.pose.bones:
        np.testing.assert_allclose(np.array(bone.matrix_basis), before[bone.name], atol=1e-6)
    assert bpy.data.objects["Hero"].modifiers["Subdivision"].show_viewport


def test_bones_are_measured_with_the_rig_at_rest(extension, rig, scene):
    """The head may be turned at the playhead, by hand or by the take before."""
    bones = extension("scene_out.face_bones")
    face, own = bones.deformed_face(scene, rig), bones.channels(rig)
    at_rest = bones._responses(rig, face, own)
    head = rig.pose.bones["head"]
    head.rotation_mode = "XYZ"
    head.rotation_euler = (0, 0, np.radians(30))
    face.data.shape_keys.key_blocks["jaw_open"].value = 0.5
    np.testing.assert_allclose(bones._responses(rig, face, own), at_rest, atol=1e-5)
    assert head.rotation_euler[2] == pytest.approx(np.radians(30))
    assert face.data.shape_keys.key_blocks["jaw_open"].value == 0.5
    head.keyframe_insert("rotation_euler", frame=1)
    scene.frame_set(1)
    np.testing.assert_allclose(bones._responses(rig, face, own), at_rest, atol=1e-5)
    # What holds the head turned from outside
    aim = bpy.data.objects.new("Aim", None)
    aim.rotation_euler = (0, 0, np.radians(30))
    scene.collection.objects.link(aim)
    head.constraints.new("COPY_ROTATION").target = aim
    turned = bones._responses(rig, face, own)
    np.testing.assert_allclose(turned, at_rest, atol=0.05 * np.abs(at_rest).max())


def test_rows_and_presets_need_no_bone_moved(extension, rig, monkeypatch, tmp_path):
    bones = extension("scene_out.face_bones")
    monkeypatch.setattr(bones, "_moved", lambda *_: pytest.fail("a bone was moved"))
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    rows, path = rig.mimetic.controls, tmp_path / "rig.json"
    assert (rows["jaw turn x"].lowest, rows["jaw turn x"].highest) == (-3, 3)
    bpy.ops.mimetic.save_controls(filepath=str(path))
    assert bpy.ops.mimetic.load_controls(filepath=str(path)) == {"FINISHED"}
    assert rows["jaw turn x"].is_edited


def test_the_buttons_fit_and_bake_bones_too(extension, rig, scene, acting_file):
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(acting_file))
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    rows = rig.mimetic.controls
    assert {"jaw turn x", "brow.L along z"} <= set(rows.keys())
    rows["jaw turn x"].is_on = rows["jaw along y"].is_on = rows["jaw along z"].is_on = False
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    curves = extension("compat").curves(rig).fcurves
    paths = {curve.data_path for curve in curves}
    assert 'pose.bones["brow.L"].location' in paths
    assert 'pose.bones["head"].rotation_quaternion' in paths
    assert not any("jaw" in path and "rotation" in path for path in paths)
    assert rows["jaw turn x"].is_edited
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.mimetic.bake_controls.poll()
    bpy.ops.object.mode_set(mode="OBJECT")


def loaded_take(scene, path, rig) -> None:
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(path))
    bpy.context.view_layer.objects.active = rig


def moves(extension, rig, path: str) -> float:
    """By how much the curves of a property move it."""
    curves = extension("compat").curves(rig).fcurves
    own = [curve for curve in curves if curve.data_path == path]
    keys = [[key.co.y for key in curve.keyframe_points] for curve in own]
    return max((np.ptp(values) for values in keys), default=0.0)


BROW = 'pose.bones["brow.L"].location'


def test_a_bone_at_rest_in_the_next_take_keeps_nothing_of_the_one_before(
    extension, rig, scene, acting_file, tmp_path
):
    from acting import make_acting

    loaded_take(scene, acting_file, rig)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    first = rig.animation_data.action
    assert moves(extension, rig, BROW) > 1e-3
    still = tmp_path / "still.npz"
    make_acting({"zygomaticus_major.L": np.linspace(0, 1, 6)}).save(still)
    loaded_take(scene, still, rig)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert rig.animation_data.action != first
    assert moves(extension, rig, BROW) < 1e-4


def test_a_bone_that_is_switched_off_keeps_nothing_of_the_bake_before(
    extension, rig, scene, acting_file
):
    loaded_take(scene, acting_file, rig)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    scene.frame_set(6)
    for axis in "xyz":
        rig.mimetic.controls[f"brow.L along {axis}"].is_on = False
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert moves(extension, rig, BROW) == 0
    assert moves(extension, rig, BROW.replace(".L", ".R")) > 1e-3
    scene.frame_set(6)
    assert rig.pose.bones["brow.L"].location.length == 0
    # What an animator keys on it then goes on through further bakes
    rig.pose.bones["brow.L"].location[2] = 0.02
    rig.keyframe_insert(BROW, frame=3)
    rig.pose.bones["brow.L"].location[2] = 0.01
    rig.keyframe_insert(BROW, frame=9)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert moves(extension, rig, BROW) == pytest.approx(0.01)


def test_a_curve_edited_by_hand_outlives_its_row(extension, rig, scene, acting_file):
    loaded_take(scene, acting_file, rig)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    curves = extension("compat").curves(rig).fcurves
    edited = next(c for c in curves if c.data_path == BROW and c.array_index == 2)
    edited.keyframe_points[0].co.y = 0.5
    for axis in "xyz":
        rig.mimetic.controls[f"brow.L along {axis}"].is_on = False
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    left = [c for c in extension("compat").curves(rig).fcurves if c.data_path == BROW]
    assert [curve.array_index for curve in left] == [2]


@pytest.mark.parametrize("is_renamed", [True, False])
def test_a_bone_that_is_gone_meanwhile_is_named(extension, rig, scene, acting_file, is_renamed):
    bones = extension("scene_out.face_bones")
    performance = extension("native").performances().Performance.load(acting_file)
    played = bones.play(scene, performance, rig)
    if is_renamed:
        rig.data.bones["brow.L"].name = "Other"
    else:
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        rig.data.edit_bones.remove(rig.data.edit_bones["brow.L"])
        bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(ValueError, match=r"Rig has no bone to move for brow\.L along x any more"):
        bones.bake(scene, performance, "hero", rig, played)
    assert rig.animation_data is None or rig.animation_data.action is None


def test_a_take_that_plays_again_keeps_nothing_of_the_other(extension, rig, scene, acting_file):
    """Whose bones it leaves at rest without a curve."""
    loaded_take(scene, acting_file, rig)
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    for axis in "xyz":
        rig.mimetic.controls[f"brow.L along {axis}"].is_on = False
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    first, second = (row.name for row in rig.mimetic.takes)
    brow, other = rig.pose.bones["brow.L"], rig.pose.bones["brow.R"]
    other.rotation_quaternion = posed = (0.8, 0.6, 0.0, 0.0)  # by hand, without a key
    scene.frame_set(6)
    assert bpy.ops.mimetic.play_take(take=first) == {"FINISHED"}
    assert brow.location.length > 1e-3
    assert bpy.ops.mimetic.play_take(take=second) == {"FINISHED"}
    assert brow.location.length == 0
    assert other.location.length > 1e-3
    assert tuple(other.rotation_quaternion) == pytest.approx(posed)
