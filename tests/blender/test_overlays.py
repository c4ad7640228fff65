# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlays know of a face, and that they come and go with the extension."""

import bpy
import numpy as np
import pytest
from conftest import MODULE
from mimetic.character.placement import to_head
from mimetic.skin.mesh import SkinMesh, multiply

METRES = 2e-6


@pytest.fixture
def live(extension):
    return extension("overlay.live")


@pytest.fixture
def added():
    bpy.ops.mimetic.add_face()
    return bpy.context.active_object


def refined(points) -> np.ndarray:
    """The skin's limit surface of V x 3 in the object's frame, in the head frame."""
    from mimetic.template.face_template import load_template

    template = load_template()
    mesh = SkinMesh(template, np.ascontiguousarray(template.vertices))
    return multiply(mesh.stencils, to_head(points)[: template.num_skin_vertices])


def evaluated(face) -> np.ndarray:
    face.modifiers["Subdivision"].show_viewport = False
    shown = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(face.data.vertices), dtype=np.float32)
    shown.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def set_some(face) -> None:
    blocks = face.data.shape_keys.key_blocks
    blocks["zygomaticus_major.L"].value = 0.6
    blocks["Brow Raisers"].value = 0.7
    blocks["jaw_open"].value = 0.3


def test_a_look_sees_the_face_that_blender_shows(live, added):
    set_some(added)
    mine = added.shape_key_add(name="mine", from_mix=False)  # relative to another than the basis
    mine.relative_key = added.data.shape_keys.key_blocks["mentalis.L"]
    mine.points[100].co.x += 0.01
    mine.value = 0.5
    muted = added.data.shape_keys.key_blocks["mentalis.R"]
    muted.value, muted.mute = 1.0, True
    look = live.look(added)
    pose = look.pose
    np.testing.assert_allclose(pose.refined, refined(evaluated(added)), atol=METRES)
    active = dict(zip(look.face.muscle_names, pose.activations, strict=True))
    assert active["zygomaticus_major.L"] == pytest.approx(0.6)
    assert active["frontalis_medial.R"] == pytest.approx(0.7)
    assert active["mentalis.R"] == 0


def test_a_pinned_shape_is_seen_alone(live, added):
    set_some(added)
    added.active_shape_key_index = added.data.shape_keys.key_blocks.find("jaw_side")
    added.show_only_shape_key = True
    np.testing.assert_allclose(
        live.look(added).pose.refined, refined(evaluated(added)), atol=METRES
    )


def test_a_look_is_new_only_when_something_changed(live, added):
    first = live.look(added).pose
    assert live.look(added).pose is first
    added.data.shape_keys.key_blocks["jaw_open"].value = 0.5
    second = live.look(added).pose
    assert second is not first
    added.data.shape_keys.key_blocks["jaw_open"].points[50].co.x += 0.01  # as by sculpting
    added.data.update()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(
        live.look(added).pose.refined, refined(evaluated(added)), atol=METRES
    )


def test_curves_move_what_is_seen(live, extension, scene, added):
    key = added.data.shape_keys.key_blocks["jaw_open"]
    for frame, value in ((1, 0.0), (11, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    scene.frame_set(1)
    assert live.look(added).pose.jaw[0] == 0
    scene.frame_set(11)
    assert live.look(added).pose.jaw[0] == 1


def test_strain_of_a_grown_face_is_the_closed_form(live, extension, added):
    grown = added.shape_key_add(name="grown", from_mix=False)
    basis = extension("scene_out.contact").points_of(added.data.shape_keys.reference_key)
    grown.points.foreach_set("co", (1.2 * basis).ravel())
    grown.value = 0.5
    look = live.look(added)
    for measure, expected in (("area", 0.21), ("stretch", 0.1), ("compression", 0.1)):
        result = look.face.strain_range(look.face.strain(look.pose, measure))
        assert result == pytest.approx((expected, expected), abs=1e-4)


def test_a_face_of_another_mesh_says_so(live, added):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.active_object
    cube.shape_key_add(name="Basis")
    cube.mimetic.shapes.add().name = "Basis"
    look = live.look(cube)
    assert look.face is None
    assert "8 vertices" in look.problem
    assert live.problem_of(cube) == look.problem
    assert live.problem_of(added) == ""


def test_overlays_are_settings_of_the_file(scene, added, tmp_path):
    scene.mimetic.show_muscles = True
    scene.mimetic.strain_measure = "STRETCH"
    scene.mimetic.strain_limit = 35
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    settings = bpy.context.scene.mimetic
    assert settings.show_muscles
    assert not settings.show_strain
    assert settings.strain_measure == "STRETCH"
    assert settings.strain_limit == 35


def test_another_file_is_another_face(live, added, tmp_path):
    live.look(added)
    assert live._views
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert not live._views
    assert live.look(bpy.data.objects["Face"]).pose is not None


def test_overlays_change_nothing_of_the_face(live, scene, added):
    def content():
        data = added.data
        return (
            [attribute.name for attribute in data.attributes],
            [modifier.name for modifier in added.modifiers],
            [material.name for material in data.materials],
            [(key.name, key.value) for key in data.shape_keys.key_blocks],
        )

    set_some(added)
    before, shape = content(), evaluated(added)
    scene.mimetic.show_muscles = scene.mimetic.show_strain = True
    look = live.look(added)
    look.face.strokes(look.pose)
    look.face.strain_patch(look.pose, look.face.strain(look.pose, "area"), 0.2)
    scene.mimetic.show_muscles = scene.mimetic.show_strain = False
    assert content() == before
    np.testing.assert_array_equal(evaluated(added), shape)


def our_handlers() -> list:
    lists = (bpy.app.handlers.load_post, bpy.app.handlers.depsgraph_update_post)
    lists += (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post)
    module = f"{MODULE}.overlay"
    return [h for handlers in lists for h in handlers if h.__module__ == module]


def test_handlers_come_and_go_with_the_extension(extension):
    overlay = extension("overlay")
    assert len(our_handlers()) == 4
    assert len(overlay._handles) == 6
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert our_handlers() == []
    assert overlay._handles == []
    bpy.ops.preferences.addon_enable(module=MODULE)
    assert len(our_handlers()) == 4


def test_handlers_stay_when_a_file_is_opened(extension, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert len(our_handlers()) == 4
    assert len(extension("overlay")._handles) == 6
