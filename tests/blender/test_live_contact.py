# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips and lids of a face stay apart however it is moved."""

import threading
import time

import bpy
import numpy as np
import pytest
from conftest import MODULE

pytestmark = pytest.mark.newest

PRESSED = {"oris_close_upper": 1.0, "oris_close_lower": 1.0}
CLOSED = {f"lid_{lid}.{side}": 1.0 for lid in ("upper", "lower") for side in "LR"}
MILLIMETRE = 1e-3


@pytest.fixture(scope="session")
def contact():
    from mimetic.muscles.anatomy import attach_skin
    from mimetic.muscles.contact import attach_contact
    from mimetic.template.face_template import load_template

    template = load_template()
    return attach_contact(attach_skin(template.vertices, template))


@pytest.fixture
def added():
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    face = bpy.context.active_object
    face.modifiers["Subdivision"].show_viewport = False
    return face


def evaluated(face, depsgraph=None) -> np.ndarray:
    """V x 3 in the object's frame, as Blender evaluates the shape keys."""
    shown = face.evaluated_get(depsgraph or bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(face.data.vertices), dtype=np.float32)
    shown.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def depth(contact, points) -> float:
    """How deep lips or lids lie in each other, metres."""
    from mimetic.character.placement import to_head
    from mimetic.template.face_template import load_template

    return contact.depth(to_head(points) - load_template().vertices)


def put(face, values) -> None:
    for name, value in values.items():
        face.data.shape_keys.key_blocks[name].value = value


@pytest.mark.parametrize("values", [PRESSED, CLOSED])
def test_sliders_do_not_drive_lips_or_lids_through_each_other(contact, added, values):
    put(added, values)
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE
    added.mimetic.use_contact = False
    assert depth(contact, evaluated(added)) > 1.5 * MILLIMETRE
    added.mimetic.use_contact = True
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE


def test_a_key_presses_only_where_its_vertex_group_moves_it(contact, added):
    rest = evaluated(added)
    lids = [f"lid_{lid}.R" for lid in ("upper", "lower")]
    left = added.vertex_groups.new(name="Left")
    left.add([int(i) for i in np.flatnonzero(rest[:, 0] > 0)], 1.0, "REPLACE")
    for name in lids:
        added.data.shape_keys.key_blocks[name].vertex_group = "Left"
    put(added, dict.fromkeys(lids, 1.0))
    np.testing.assert_array_equal(evaluated(added), rest)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    left.add(range(len(rest)), 1.0, "REPLACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE
    added.mimetic.use_contact = False
    assert depth(contact, evaluated(added)) > MILLIMETRE


def test_contact_leaves_nothing_behind(added):
    rest = evaluated(added)
    put(added, PRESSED)
    assert np.abs(evaluated(added) - rest).max() > MILLIMETRE
    put(added, dict.fromkeys(PRESSED, 0.0))
    np.testing.assert_array_equal(evaluated(added), rest)


def test_groups_and_curves_are_followed(contact, scene, added):
    key = added.data.shape_keys.key_blocks["Chin and Lip Ring"]
    for frame, value in ((1, 0.0), (11, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    added.mimetic.use_contact = False
    scene.frame_set(11)
    assert depth(contact, evaluated(added)) > MILLIMETRE
    added.mimetic.use_contact = True
    for frame in (1, 6, 11, 8):
        scene.frame_set(frame)
        assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE


def test_a_file_is_opened_as_it_was_saved_and_goes_on(contact, added, tmp_path):
    put(added, PRESSED)
    pressed = evaluated(added)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    face = bpy.data.objects["Face"]
    np.testing.assert_allclose(evaluated(face), pressed, atol=1e-6)
    put(face, {"jaw_open": 0.2})
    assert depth(contact, evaluated(face)) < 0.05 * MILLIMETRE
    put(face, dict.fromkeys((*PRESSED, "jaw_open"), 0.0))
    assert depth(contact, evaluated(face)) == 0


def test_undo_takes_the_contact_back_with_the_slider(contact, added):
    rest = evaluated(added)
    bpy.ops.ed.undo_push(message="added")
    put(added, PRESSED)
    evaluated(added)
    bpy.ops.ed.undo_push(message="pressed")
    bpy.ops.ed.undo()
    face = bpy.data.objects["Face"]
    np.testing.assert_array_equal(evaluated(face), rest)
    bpy.ops.ed.redo()
    face = bpy.data.objects["Face"]
    assert depth(contact, evaluated(face)) < 0.05 * MILLIMETRE


def test_rest_leaves_contact_ready(contact, added):
    put(added, PRESSED)
    evaluated(added)
    assert bpy.ops.mimetic.rest_face() == {"FINISHED"}
    assert added.data.shape_keys.key_blocks["contact"].value == 1.0
    put(added, CLOSED)
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE


def test_a_face_that_contact_does_not_know_says_why(extension, added):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.active_object
    cube.shape_key_add(name="Basis")
    moved = cube.shape_key_add(name="moved")
    cube.mimetic.shapes.add().name = "moved"
    cube.mimetic.use_contact = True
    moved.value = 0.5
    bpy.context.view_layer.update()
    assert "8 vertices" in extension("contact").problem_of(cube)
    assert extension("contact").problem_of(added) == ""


def test_handlers_go_with_the_extension():
    def ours() -> int:
        lists = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
        names = [h.__module__ for handlers in lists for h in handlers]
        return names.count(f"{MODULE}.contact")

    assert ours() == 2
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert ours() == 0


def test_an_exported_face_takes_its_contact_along(contact, extension, added, tmp_path):
    """The file's morph targets and weights, added up by hand."""
    from mimetic.character import gltf

    blocks = added.data.shape_keys.key_blocks
    for frame, value in ((1, 0.0), (9, 1.0)):
        for name in PRESSED:
            blocks[name].value = value
            blocks[name].keyframe_insert("value", frame=frame)
    names = blocks.keys()
    path = tmp_path / "face.glb"
    assert bpy.ops.mimetic.export_gltf(filepath=str(path)) == {"FINISHED"}
    assert blocks.keys() == names
    _, weights, targets = gltf.read_weights(path.read_bytes())
    parts = [name for name in targets if name.startswith("contact")]
    assert 1 <= len(parts) <= 6
    assert not weights[0, [targets.index(name) for name in parts]].any()
    by_hand = added.data.shape_keys
    assert by_hand.key_blocks["contact"].value == 1.0
    assert len(extension("compat").curves(by_hand).fcurves) == 2
    bpy.context.scene.frame_set(5)
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE
    bpy.ops.import_scene.gltf(filepath=str(path))
    imported = bpy.context.active_object
    bpy.context.scene.frame_set(9)
    shown = imported.evaluated_get(bpy.context.evaluated_depsgraph_get())
    places = np.array([v.co for v in shown.data.vertices])
    expected = evaluated(added)
    gap = np.abs(places[:, None, :] - expected[None, ::97]).max(axis=2).min(axis=0)
    assert gap.max() < 2e-4
    lips = [v for v in contact.moved[::9]]
    gap = np.abs(places[:, None, :] - expected[None, lips]).max(axis=2).min(axis=0)
    assert gap.max() < 2e-4


def test_a_face_that_nothing_presses_is_exported_without_contact(added, tmp_path):
    from mimetic.character import gltf

    key = added.data.shape_keys.key_blocks["jaw_open"]
    for frame, value in ((1, 0.0), (5, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    path = tmp_path / "face.glb"
    assert bpy.ops.mimetic.export_gltf(filepath=str(path)) == {"FINISHED"}
    _, _, targets = gltf.read_weights(path.read_bytes())
    assert "contact" not in targets
    assert not added.data.shape_keys.key_blocks["contact"].mute


def test_a_baked_take_carries_its_contact(contact, extension, scene, performance):
    """Lips that a take presses through each other rest on each other, frame by frame."""
    import dataclasses

    from mimetic.character.canonical_head import make_head
    from mimetic.character.contact_shapes import contact_shapes

    head = make_head()
    pressing = {shape.name: shape.offsets for shape in head.shapes}
    modes = np.zeros_like(performance.muscle_modes)
    modes[0] = sum(pressing[name] for name in PRESSED)
    activations = np.zeros_like(performance.activations)
    activations[10:20, 0] = np.linspace(0.2, 1, 10)
    take = dataclasses.replace(
        performance,
        muscle_modes=modes,
        activations=activations,
        articulator_values=0 * performance.articulator_values,
    )
    shapes = contact_shapes(take)
    assert 1 <= len(shapes) <= 8
    assert not any(shape.values[:10].any() or shape.values[20:].any() for shape in shapes)
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, take, "take", contact_shapes=shapes)
    face = scene.mimetic.face
    face.modifiers["Subdivision"].show_viewport = False
    face.mimetic.use_contact = False  # what is baked holds without what follows
    for frame in (5, 15, 20, 25):
        scene.frame_set(frame)
        expected = take.surface(frame - 1)
        assert depth(contact, evaluated(face)) < 0.15 * MILLIMETRE
        if not activations[frame - 1].any():
            from mimetic.character.placement import to_object

            np.testing.assert_allclose(evaluated(face), to_object(expected), atol=2e-6)
    assert contact.depth(take.surface(19) - take.neutral_vertices) > 5 * MILLIMETRE


def test_with_a_window_a_face_is_made_known_in_the_background(
    contact, extension, added, monkeypatch
):
    follower = extension("contact")
    make, may_start = follower._maker, threading.Event()

    def slow(*arguments):
        result = make(*arguments)
        return lambda: may_start.wait() and result()

    monkeypatch.setattr(follower, "_waits", lambda depsgraph: False)
    monkeypatch.setattr(follower, "_maker", slow)
    put(added, PRESSED)
    assert depth(contact, evaluated(added)) > MILLIMETRE
    assert bpy.app.timers.is_registered(follower._poll)
    may_start.set()
    while follower._poll() is not None:  # as Blender's timer does
        time.sleep(0.02)
    assert depth(contact, evaluated(added)) < 0.05 * MILLIMETRE


def test_an_object_that_took_a_faces_name_is_left_alone(extension, scene, added):
    put(added, PRESSED)
    bpy.context.view_layer.update()
    name = added.name
    assert name in extension("contact")._states
    added.name = "Hero"
    scene.collection.objects.link(bpy.data.objects.new(name, None))
    assert extension("contact")._poll() is None


def test_a_rendered_animation_shows_each_frame_as_it_stands(scene, added, tmp_path):
    blocks = added.data.shape_keys.key_blocks
    for frame, value in ((1, 0.0), (3, 1.0)):
        for name in (*PRESSED, "look_down.L"):
            blocks[name].value = value
            blocks[name].keyframe_insert("value", frame=frame)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -0.6, -0.03), (np.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera, scene.world = camera, bpy.data.worlds.new("World")
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.render.resolution_x = scene.render.resolution_y = 48
    scene.frame_start = scene.frame_end = 3

    def rendered(name: str, **how) -> np.ndarray:
        scene.render.filepath = str(tmp_path / name)
        bpy.ops.render.render(**how)
        image = bpy.data.images.load(str(next(tmp_path.glob(f"{name}*"))))
        pixels = np.empty(4 * 48 * 48, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        return pixels

    scene.frame_set(1)
    animation = rendered("animation", animation=True)
    scene.frame_set(3)
    np.testing.assert_array_equal(animation, rendered("still.png", write_still=True))
    added.mimetic.use_contact = False
    assert np.abs(rendered("without.png", write_still=True) - animation).max() > 0.02
