# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles on a mesh that is not ours, by landmarks that are empties, vertex groups or a file."""

import json
import re

import bmesh
import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn, lit_buttons

HOLE = 139  # a face of the forehead
UNIT = 0.01  # metres in the object's unit: modelled in centimetres, scaled in the scene


@pytest.fixture
def head(parts):
    return new_head(parts[0], parts[1].tolist())


def landmark_file(extension, folder) -> str:
    """The landmarks of the active head's empties."""
    scene, head = bpy.context.scene, bpy.context.active_object
    landmarks = extension("heads").foreign_head(scene, head).landmarks
    path = folder / "landmarks.json"
    path.write_text(json.dumps({name: place.tolist() for name, place in landmarks.items()}))
    return str(path)


def new_head(points, faces) -> bpy.types.Object:
    mesh = bpy.data.meshes.new("Bust")
    mesh.from_pydata(points, [], faces)
    head = bpy.data.objects.new("Bust", mesh)
    bpy.context.scene.collection.objects.link(head)
    head.scale = (UNIT,) * 3
    head.location = (0.3, -0.2, 1.5)
    head.rotation_euler = (0, 0, 0.7)
    bpy.context.view_layer.objects.active = head
    head.select_set(True)
    bpy.context.view_layer.update()
    return head


def put_landmarks(head, parts) -> None:
    assert bpy.ops.mimetic.add_landmarks() == {"FINISHED"}
    for mark in filter(lambda child: child.mimetic.landmark, head.children):
        mark.location = parts[0][parts[2][mark.mimetic.landmark]]
    bpy.context.view_layer.update()


def evaluated(face) -> np.ndarray:
    shown = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(face.data.vertices), dtype=np.float32)
    shown.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def offsets_of(head, name) -> np.ndarray:
    """V x 3 in the object's frame and unit."""
    keys = head.data.shape_keys
    both = np.empty((2, 3 * len(head.data.vertices)), dtype=np.float32)
    keys.key_blocks[name].points.foreach_get("co", both[0])
    keys.reference_key.points.foreach_get("co", both[1])
    return (both[0] - both[1]).reshape(-1, 3)


@pytest.mark.oldest_and_newest
def test_a_head_by_empties_gets_the_muscles_of_our_own(parts, extension, capfd):
    from mimetic.character.canonical_head import make_head
    from mimetic.character.placement import to_object

    head = new_head(parts[0], np.delete(parts[1], HOLE, axis=0).tolist())
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    output = capfd.readouterr().out
    beside = int(re.search(r"Warning: Bust: there is a hole .* beside face (\d+)", output).group(1))
    assert len({*head.data.polygons[beside].vertices} & {*parts[1][HOLE].tolist()}) == 2
    ours = make_head()
    expected = {
        shape.name: to_object(shape.offsets) / UNIT for shape in (*ours.shapes, *ours.groups)
    }
    blocks = head.data.shape_keys.key_blocks
    assert blocks.keys() == ["Basis", *expected, "contact"]
    assert len(head.mimetic.shapes) == 60
    for name in ("zygomaticus_major.L", "jaw_open", "look_down.R", "air_cheek.L", "Brow Raisers"):
        own = offsets_of(head, name)
        cosine = (own * expected[name]).sum()
        cosine /= np.linalg.norm(own) * np.linalg.norm(expected[name])
        assert cosine > 0.95, name
        assert np.linalg.norm(own) == pytest.approx(np.linalg.norm(expected[name]), rel=0.1), name
    # Lips rest on each other as on ours, also when the file is opened by another session
    blocks["oris_close_upper"].value = blocks["oris_close_lower"].value = 1.0
    pressed = evaluated(head)
    assert np.abs(offsets_of(head, "contact")).max() > 0.1  # 1 mm
    extension("contact").forget_all()
    blocks["oris_close_upper"].value = 0.0
    evaluated(head)
    blocks["oris_close_upper"].value = 1.0
    np.testing.assert_allclose(evaluated(head), pressed, atol=1e-3)


@pytest.mark.oldest_and_newest
def test_other_shape_keys_of_the_head_stay(parts, head):
    put_landmarks(head, parts)
    head.shape_key_add(name="Basis", from_mix=False)
    own = head.shape_key_add(name="viseme", from_mix=False)
    own.points[7].co.x += 1
    own.value = 0
    own.value = 0.6
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert head.data.shape_keys.key_blocks["viseme"].value == pytest.approx(0.6)
    assert offsets_of(head, "viseme")[7, 0] == pytest.approx(1)


def test_landmarks_by_vertex_groups_are_their_vertices(extension, scene, parts, head):
    for name, vertex in parts[2].items():
        group = head.vertex_groups.new(name=name)
        group.add([vertex], 1.0, "REPLACE")
        group.add([vertex + 1], 0.4, "REPLACE")
    assert extension("heads").foreign_head(scene, head).landmarks == parts[2]


@pytest.mark.oldest_and_newest
def test_a_dragged_landmark_asks_for_the_muscles_to_be_attached_again(extension, parts, head):
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    panels = ("MIMETIC_PT_capture_view", "MIMETIC_PT_muscles")
    assert not any("mimetic.attach_muscles" in lit_buttons(panel) for panel in panels)
    before = offsets_of(head, "mentalis.L")
    head.location[2] += 0.4  # the whole head, its landmarks with it
    bpy.context.view_layer.update()
    assert extension("heads").moved_landmarks(bpy.context.scene, head) == []
    chin = next(mark for mark in head.children if mark.mimetic.landmark == "chin")
    chin.location[2] -= 1.0  # a centimetre
    bpy.context.view_layer.objects.active = chin  # as whoever drags it has it
    bpy.context.view_layer.update()
    for panel in panels:
        assert lit_buttons(panel) == ["mimetic.attach_muscles"]
        assert "Bust: landmarks moved: chin" in " ".join(drawn(panel).split())
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert np.abs(offsets_of(head, "mentalis.L") - before).max() > 1e-3
    for panel in panels:
        assert "mimetic.attach_muscles" not in lit_buttons(panel)


def attached(head, parts, kind: str) -> None:
    """With ARKit's shapes; by empties, or by vertex groups."""
    if kind == "empties":
        put_landmarks(head, parts)
    else:
        for name, vertex in parts[2].items():
            head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}


def character_in_world(extension, head) -> np.ndarray:
    """4 x 4, in metres, of which the head's motion is made."""
    scene = bpy.context.scene
    frame = extension("scene_out.bound").object_from_character(scene, head)
    bpy.context.view_layer.update()
    return np.array(head.matrix_world) @ frame


def cut(head) -> None:
    """The top of the head goes, with vertices of low numbers."""
    mesh = bmesh.new()
    mesh.from_mesh(head.data)
    gone = [vertex for vertex in mesh.verts if vertex.co.z > 9]
    assert min(vertex.index for vertex in gone) < 2000
    bmesh.ops.delete(mesh, geom=gone, context="VERTS")
    mesh.to_mesh(head.data)
    mesh.free()
    head.data.update()


@pytest.mark.oldest_and_newest
@pytest.mark.parametrize("kind", ["empties", "groups"])
def test_the_heads_place_stays_where_transforms_are_applied(extension, parts, head, kind):
    attached(head, parts, kind)
    before = character_in_world(extension, head)
    size = extension("heads").remembered_head(bpy.context.scene, head).matrix
    for what in ("location", "rotation", "scale"):
        only = {"location": False, "rotation": False, "scale": False, what: True}
        bpy.ops.object.transform_apply(**only)
        now = character_in_world(extension, head)
        np.testing.assert_allclose(now, before, atol=1e-5)
        assert extension("heads").moved_landmarks(bpy.context.scene, head) == []
    assert head.scale[0] == pytest.approx(1)
    applied = extension("heads").remembered_head(bpy.context.scene, head).matrix
    assert np.linalg.det(applied) == pytest.approx(np.linalg.det(size) / UNIT**3, rel=1e-4)


@pytest.mark.oldest_and_newest
@pytest.mark.parametrize("kind", ["empties", "groups"])
def test_the_heads_place_stays_where_its_mesh_is_cut(extension, parts, head, kind):
    attached(head, parts, kind)
    before = character_in_world(extension, head)
    cut(head)
    np.testing.assert_allclose(character_in_world(extension, head), before, atol=1e-5)
    assert extension("heads").moved_landmarks(bpy.context.scene, head) == []


@pytest.mark.oldest_and_newest
def test_parts_stay_where_transforms_are_applied(extension, parts, head):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2)
    eye = bpy.context.active_object
    eye.parent, eye.location = head, (3.2, -7.0, 3.0)
    bpy.context.view_layer.objects.active = head
    attached(head, parts, "empties")

    def places() -> np.ndarray:
        own = extension("heads").remembered_head(bpy.context.scene, head)
        points = np.vstack([own.points, *(part.mesh.in_head() for part in own.parts)])
        assert len(points) > len(head.data.vertices)
        return points @ own.matrix[:3, :3].T + own.matrix[:3, 3]

    before = places()
    head.select_set(True)
    eye.select_set(True)
    bpy.ops.object.transform_apply()
    np.testing.assert_allclose(places(), before, atol=1e-5)


@pytest.mark.newest
@pytest.mark.parametrize("how", ["applied", "cut"])
def test_muscles_follow_landmarks_after_the_mesh_was_changed(extension, parts, head, how):
    attached(head, parts, "empties")
    sculpted = head.data.shape_keys.key_blocks["frontalis_medial.L"]
    for i in range(0, len(sculpted.points), 9):
        sculpted.points[i].co.y -= 0.5
    if how == "cut":
        cut(head)
    else:
        bpy.ops.object.transform_apply()
    muscle, unit = offsets_of(head, "mentalis.L"), offsets_of(head, "mouthShrugLower")
    bpy.context.view_layer.update()
    chin = next(mark for mark in head.children if mark.mimetic.landmark == "chin")
    placed = chin.matrix_world.copy()
    placed.translation.z -= 0.006
    chin.matrix_world = placed
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    for name, before in (("mentalis.L", muscle), ("mouthShrugLower", unit)):
        after = offsets_of(head, name)
        assert np.abs(after - before).max() > 0.01 * np.abs(before).max(), name
    kept = "" if how == "cut" else "kept as changed by hand: the shape of frontalis_medial.L"
    for _ in range(2):
        message = result()["message"]
        assert kept in message and ("kept" in message) == bool(kept)
        assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}


@pytest.mark.newest
def test_contact_is_of_the_muscles_attached_last(extension, parts, head):
    def pressed() -> np.ndarray:
        blocks = head.data.shape_keys.key_blocks
        blocks["oris_close_upper"].value = blocks["oris_close_lower"].value = 1.0
        evaluated(head)
        return offsets_of(head, "contact")

    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    pressed()
    for mark in head.children:
        if mark.mimetic.landmark.startswith(("lip", "mouth")):
            mark.location[2] -= 0.4
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    after = pressed()
    extension("contact").forget_all()
    np.testing.assert_allclose(after, pressed(), atol=1e-4)


def test_landmarks_by_a_file_are_those_of_the_empties(extension, scene, parts, head, tmp_path):
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    by_empties = offsets_of(head, "mentalis.L")
    assert bpy.ops.mimetic.attach_muscles(filepath=landmark_file(extension, tmp_path)) == {
        "FINISHED"
    }
    np.testing.assert_array_equal(offsets_of(head, "mentalis.L"), by_empties)


@pytest.mark.newest
@pytest.mark.parametrize("turn", [(0, 0, 0.7), (1.57, 0, 0), (0, 0, 3.14)])
def test_landmarks_find_their_places_whichever_way_a_head_looks(parts, head, turn):
    head.rotation_euler = turn
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.add_landmarks() == {"FINISHED"}
    for mark in head.children:
        away = np.array(mark.location) - parts[0][parts[2][mark.mimetic.landmark]]
        assert np.linalg.norm(away) < 0.2  # 2 mm
        assert mark.empty_display_type == "SPHERE"
    assert result()["doubtful"] == []
    with pytest.raises(RuntimeError, match="There are landmarks"):
        bpy.ops.mimetic.add_landmarks()


@pytest.mark.newest
def test_landmarks_of_what_is_no_face_are_marked_as_guesses():
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.1)
    ball = bpy.context.active_object
    assert bpy.ops.mimetic.add_landmarks() == {"FINISHED"}
    assert {mark.empty_display_type for mark in ball.children} == {"CUBE"}
    assert "guessed" in result()["message"]
    assert len(result()["doubtful"]) == len(ball.children) == 15


def test_a_head_that_changed_meanwhile_gets_no_landmarks(head, extension):
    operator = extension("operators.foreign").MIMETIC_OT_add_landmarks
    read = extension("heads").foreign_head(bpy.context.scene, head)
    head.data.vertices.add(1)
    with pytest.raises(extension("native").known_errors(), match="changed meanwhile: it had"):
        operator.write(None, bpy.context, (read, None))
    bpy.data.objects.remove(head)
    with pytest.raises(extension("native").known_errors(), match="deleted or renamed"):
        operator.write(None, bpy.context, (read, None))


def test_what_is_wrong_is_said(parts, head, tmp_path):
    with pytest.raises(RuntimeError, match=r"landmarks lack eye_inner\.L"):
        bpy.ops.mimetic.attach_muscles()
    path = tmp_path / "landmarks.json"
    path.write_text(json.dumps(parts[2]))
    head.scale = (1, 1, 1)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="if it is in centimetres"):
        bpy.ops.mimetic.attach_muscles(filepath=str(path))
    assert head.data.shape_keys is None
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.mimetic.attach_muscles.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.mimetic.attach_muscles.poll()


def test_a_bad_face_is_named_by_blenders_number(parts, head):
    points, faces, marks = parts
    flipped = faces.tolist()
    flipped[HOLE + 1].reverse()
    turned = new_head(points, flipped)
    for name, vertex in marks.items():
        turned.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    with pytest.raises(RuntimeError, match=rf"face {HOLE + 1} of the head lies turned over"):
        bpy.ops.mimetic.attach_muscles()


def test_attaching_is_one_undo_step(extension, parts, head, tmp_path):
    put_landmarks(head, parts)
    path = landmark_file(extension, tmp_path)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.attach_muscles("EXEC_DEFAULT", True, filepath=path) == {"FINISHED"}
    bpy.ops.ed.undo()
    assert bpy.data.objects["Bust"].data.shape_keys is None
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["Bust"].mimetic.shapes) == 60


@pytest.mark.oldest_and_newest
def test_arkit_shapes_join_the_keys_of_a_head(parts, head):
    head.shape_key_add(name="Basis", from_mix=False)
    own = head.shape_key_add(name="jawOpen", from_mix=False)
    own.points[7].co.x += 1
    own.value = 0
    before = offsets_of(head, "jawOpen")
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    keys = head.data.shape_keys.key_blocks
    assert len(keys) == 1 + 52
    assert {"eyeBlinkLeft", "mouthClose", "tongueOut"} <= set(keys.keys())
    assert "jawOpen" in result()["message"]
    np.testing.assert_array_equal(offsets_of(head, "jawOpen"), before)
    assert all(key.value == 0 for key in keys[1:])
    corner = parts[2]["mouth_corner.L"]
    assert offsets_of(head, "mouthSmileLeft")[corner, 2] > 0.3  # centimetres, upwards
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert "mouthSmileLeft" in keys and "zygomaticus_major.L" in keys


@pytest.mark.oldest_and_newest
def test_our_own_face_gets_arkit_shapes():
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    face = bpy.context.active_object
    last = face.data.shape_keys.key_blocks[-1].name
    before = len(face.data.shape_keys.key_blocks)
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    keys = face.data.shape_keys.key_blocks
    assert len(keys) == before + 52
    assert keys[-1].name == last == "contact"


def test_arkit_shapes_want_landmarks_first(head):
    assert not bpy.ops.mimetic.add_arkit_shapes.poll()
    with pytest.raises(RuntimeError, match="Press Add Landmarks first"):
        bpy.ops.mimetic.add_arkit_shapes()
