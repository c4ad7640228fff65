# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads whose eyeballs, teeth and tongue are objects of their own: they move as if joined."""

import bpy
import numpy as np
import pytest
from last_result import result
from mathutils import Matrix
from test_attach_muscles import evaluated, new_head, offsets_of

pytestmark = pytest.mark.newest

NAMES = ("eye.L", "eye.R", "teeth_lower", "teeth_upper", "tongue")


@pytest.fixture
def rows(parts):
    """Vertices of the template by the object that holds them; "" is the head."""
    from mimetic.template.face_template import load_template

    template = load_template()
    by_name = {name: np.asarray(template.part_vertices(name)) for name in NAMES}
    inside = np.concatenate(list(by_name.values()))
    return {**by_name, "": np.setdiff1d(np.arange(len(parts[0])), inside)}


@pytest.fixture
def split(parts, rows):
    """The head, and its parts as children with frames of their own; the right eye's is mirrored."""
    head = new_head(*_piece(parts, rows[""]))
    for name in NAMES:
        points, faces = _piece(parts, rows[name])
        frame = Matrix.Translation(points.mean(axis=0)) @ Matrix.Rotation(0.4, 4, "X")
        if name == "eye.R":
            frame @= Matrix.Diagonal((-1, 1, 1, 1))
            faces = [face[::-1] for face in faces]  # outwards, as it is seen
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points, [], faces)
        mesh.transform(frame.inverted())
        part = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(part)
        part.parent, part.matrix_basis = head, frame
    bpy.context.view_layer.update()
    marks = {name: int(np.searchsorted(rows[""], vertex)) for name, vertex in parts[2].items()}
    for name, vertex in marks.items():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    return head


@pytest.fixture
def joined(parts):
    """The same as one mesh, elsewhere, with all shapes."""
    head = new_head(parts[0], parts[1].tolist())
    head.name = "Joined"
    for name, vertex in parts[2].items():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    return head


def _piece(parts, own):
    """Points and faces of some of the template's vertices."""
    points, faces, _ = parts
    faces = np.asarray(faces)
    inside = np.isin(faces, own).all(axis=1)
    return points[own], np.searchsorted(own, faces[inside]).tolist()


def _in_head(head, part) -> np.ndarray:
    """The part as it is shown, in the head's frame."""
    matrix = np.array(head.matrix_world.inverted() @ part.matrix_world)
    return evaluated(part) @ matrix[:3, :3].T + matrix[:3, 3]


def test_parts_move_as_if_they_were_joined(parts, rows, joined, split):
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert result()["notes"] == []
    assert sorted(result()["parts"]) == ["eye.L", "eye.R", "teeth_lower", "tongue"]
    assert "eye.L, eye.R, teeth_lower, tongue moved along" in result()["message"]
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    assert sorted(result()["parts"]) == ["eye.L", "eye.R", "teeth_lower", "tongue"]
    objects = bpy.data.objects
    assert objects["teeth_upper"].data.shape_keys is None
    split.mimetic.use_contact = joined.mimetic.use_contact = False
    whole, own = joined.data.shape_keys.key_blocks, split.data.shape_keys.key_blocks
    for values in (
        {"jaw_open": 0.7, "look_down.L": 1.0, "look_in.R": 0.8},
        {"eyeBlinkLeft": 1.0, "eyeLookOutLeft": 1.0, "jawOpen": 0.5, "tongueOut": 1.0},
    ):
        for name, value in values.items():
            whole[name].value = own[name].value = value
        shown = evaluated(joined)
        np.testing.assert_allclose(evaluated(split), shown[rows[""]], atol=2e-3)  # .02 mm
        for name in NAMES:
            np.testing.assert_allclose(
                _in_head(split, objects[name]), shown[rows[name]], atol=2e-3, err_msg=name
            )
        moved = np.abs(shown - parts[0]).max(axis=1)
        for name in ("eye.L", "teeth_lower", "tongue"):
            assert moved[rows[name]].max() > 0.2, name  # 2 mm
        for name in values:
            whole[name].value = own[name].value = 0.0


def test_attaching_again_writes_the_same_keys_anew(split):
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    eye = bpy.data.objects["eye.L"]
    names, before = eye.data.shape_keys.key_blocks.keys(), offsets_of(eye, "look_in.L")
    eye.data.shape_keys.key_blocks["look_in.L"].points[0].co.x += 1
    split.data.shape_keys.key_blocks["look_in.L"].name = "inwards"
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert eye.data.shape_keys.key_blocks.keys() == names
    np.testing.assert_array_equal(offsets_of(eye, "look_in.L"), before)
    split.data.shape_keys.key_blocks["inwards"].value = 1.0
    assert np.abs(evaluated(eye) - evaluated_at_rest(eye)).max() > 0.1  # 1 mm


def evaluated_at_rest(obj) -> np.ndarray:
    return np.array([point.co for point in obj.data.shape_keys.reference_key.points])


def test_what_cannot_move_is_told_and_holds_lids_out(joined, split, rows, tmp_path):
    objects = bpy.data.objects
    objects["eye.R"].parent = None
    objects["eye.R"].matrix_world = split.matrix_world @ objects["eye.R"].matrix_basis
    twin = objects.new("twin", objects["eye.L"].data)
    twin.location = (9, 0, 0)
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    notes = "\n".join(result()["notes"])
    assert "eye.L stays where it is: eye.L shares its mesh with 1 more" in notes
    assert "eye.R does not go where Bust goes: parent it" in notes
    assert sorted(result()["parts"]) == ["eye.R", "teeth_lower", "tongue"]
    # The lids still know of it
    np.testing.assert_allclose(
        offsets_of(split, "lid_upper.L"), offsets_of(joined, "lid_upper.L")[rows[""]], atol=2e-3
    )


def test_linked_and_overridden_parts_are_told(split, tmp_path):
    eye, path = bpy.data.objects["eye.L"], str(tmp_path / "eyes.blend")
    matrix = eye.matrix_world.copy()
    eye.parent = None
    bpy.data.libraries.write(path, {eye})
    bpy.data.objects.remove(eye)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["eye.L"]
    linked = wanted.objects[0]
    bpy.context.scene.collection.objects.link(linked)
    linked.matrix_world = matrix
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    notes = "\n".join(result()["notes"])
    assert "eye.L stays where it is: eye.L is linked from eyes.blend" in notes
    assert "eyeball was found" not in notes
    overridden = linked.override_create(remap_local_usages=True)
    overridden.matrix_world = matrix
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    assert "eye.L stays where it is" in "\n".join(result()["notes"])
    assert overridden.data.shape_keys is None


def test_only_what_is_shown_and_inside_is_a_part(extension, scene, split):
    read = extension("heads").foreign_head
    assert [part.name for part in read(scene, split).parts] == sorted(NAMES)
    bpy.data.objects["tongue"].hide_render = True
    bpy.data.objects["eye.L"].hide_set(True)
    bpy.data.objects["eye.R"].location.x += 60
    new_head([(0, 0, 0), (9, 0, 0), (0, 9, 0)], [[0, 1, 2]]).location = (9, 9, 9)
    bpy.context.view_layer.update()
    assert [part.name for part in read(scene, split).parts] == ["teeth_lower", "teeth_upper"]


def test_landmarks_and_muscles_with_parts_are_undone_in_one_step_each(parts, split):
    for group in list(split.vertex_groups):
        split.vertex_groups.remove(group)
    put_landmarks_of(split, parts)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.attach_muscles("EXEC_DEFAULT", True) == {"FINISHED"}
    assert bpy.data.objects["eye.L"].data.shape_keys is not None
    bpy.ops.ed.undo()
    assert all(bpy.data.objects[name].data.shape_keys is None for name in ("Bust", *NAMES))
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["Bust"].mimetic.parts) == len(NAMES)
    assert bpy.data.objects["eye.L"].data.shape_keys.animation_data.drivers


def put_landmarks_of(head, parts) -> None:
    """Empties at the true places, as Add Landmarks would leave them."""
    assert bpy.ops.mimetic.add_landmarks() == {"FINISHED"}
    for mark in head.children:
        if mark.mimetic.landmark:
            mark.location = parts[0][parts[2][mark.mimetic.landmark]]
    bpy.context.view_layer.update()


def test_contact_of_lips_is_that_of_the_joined_head(joined, split, rows):
    bpy.context.view_layer.objects.active = split
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    for head in (joined, split):
        blocks = head.data.shape_keys.key_blocks
        blocks["oris_close_upper"].value = blocks["oris_close_lower"].value = 1.0
    shown = evaluated(joined)
    np.testing.assert_allclose(evaluated(split), shown[rows[""]], atol=0.02)  # .2 mm
    assert np.abs(offsets_of(split, "contact")).max() > 0.1


def test_a_copy_that_plays_another_take_has_parts_of_its_own(extension, scene, split, acted):
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    path = acted[1]
    scene.mimetic.performance_path = path
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    take = result()["take"]
    assert bpy.ops.mimetic.compare_take(take=take) == {"FINISHED"}
    twin = bpy.data.objects[f"Bust {take}"]
    copies = {entry.name: entry.part for entry in twin.mimetic.parts}
    assert sorted(copies) == sorted(NAMES)
    apart = np.array(twin.matrix_world.translation - split.matrix_world.translation)
    assert np.linalg.norm(apart) == pytest.approx(0.25, abs=1e-4)
    for name, own in copies.items():
        original = bpy.data.objects[name]
        assert own != original and own.data != original.data and own.parent == twin
        offset = np.array(own.matrix_world.translation - original.matrix_world.translation)
        np.testing.assert_allclose(offset, apart, atol=1e-5)
    twin.data.shape_keys.animation_data_clear()
    split.data.shape_keys.animation_data_clear()
    for obj in (split, twin):
        for key in obj.data.shape_keys.key_blocks:
            key.value = 0.0
    own, original = copies["eye.L"], bpy.data.objects["eye.L"]
    rest = evaluated(original).copy()
    twin.data.shape_keys.key_blocks["look_in.L"].value = 1.0
    assert np.abs(evaluated(own) - rest).max() > 0.1
    np.testing.assert_array_equal(evaluated(original), rest)
