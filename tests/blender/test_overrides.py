# SPDX-License-Identifier: GPL-3.0-or-later
"""Performances on library overrides of linked characters: what is baked is there when the file is
opened again, takes and tables too."""

import shutil

import bpy
import numpy as np
import pytest
from last_result import result
from test_bake_bound import hero  # noqa: F401
from test_face_bones import acting_file, rig  # noqa: F401
from test_takes import playing, rows

pytestmark = pytest.mark.oldest_and_newest

BROW = "frontalis_medial.L"


@pytest.fixture
def linked_file(tmp_path):
    """Saves the open file as the characters' and opens an empty one, with overrides of theirs."""

    def link(name: str) -> bpy.types.Object:
        library = str(tmp_path / "cast.blend")
        bpy.ops.wm.save_as_mainfile(filepath=library)
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        with bpy.data.libraries.load(library, link=True) as (_, target):
            target.objects = [name]
        scene = bpy.context.scene
        scene.render.fps = 25
        own = target.objects[0].override_create(remap_local_usages=True)
        scene.collection.objects.link(own)
        return own

    return link


@pytest.fixture
def reopened(tmp_path):
    """Saves the shot, opens it, saves and opens it again; returns an object of it by its name."""

    def again(name: str) -> bpy.types.Object:
        for _ in range(2):
            bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
            bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
        obj = bpy.context.scene.objects[name]
        assert obj.override_library
        bpy.context.view_layer.objects.active = obj
        return obj

    return again


def bake(path, **options) -> None:
    bpy.ops.mimetic.load_performance(filepath=str(path))
    assert bpy.ops.mimetic.bake(**options) == {"FINISHED"}


def brow(face, frame: int) -> float:
    bpy.context.scene.frame_set(frame)
    keys = face.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.shape_keys
    return keys.key_blocks[BROW].value


@pytest.fixture
def shot(hero, acted, linked_file):  # noqa: F811
    """A head with a take of its own file, which plays as strips; overridden with its mesh."""
    bake(acted[1], use_strips=True)
    face = linked_file("Hero")
    face.data = face.data.override_create(remap_local_usages=False)
    bpy.context.view_layer.objects.active = face
    return face


def test_takes_of_an_override_make_rows_that_stay(extension, shot, acted, tmp_path, reopened):
    again = tmp_path / "again.npz"
    shutil.copy(acted[1], again)
    inherited = rows(shot)[0]
    bake(acted[1])
    bake(again)
    names = rows(shot)
    assert names[0] == inherited
    assert names[2] == "again"
    assert len(names) == 3
    raised = [brow(shot, frame) for frame in (3, 17, 30)]
    assert np.ptp(raised) > 0.01

    face = reopened("Hero")
    assert rows(face) == names
    assert playing(extension, face) == "again"
    np.testing.assert_allclose([brow(face, frame) for frame in (3, 17, 30)], raised, atol=1e-6)
    assert [part.action.library for part in face.mimetic.takes["again"].parts] == [None, None]

    assert bpy.ops.mimetic.play_take(take=names[1]) == {"FINISHED"}
    assert playing(extension, reopened("Hero")) == names[1]


def test_strips_of_an_override_stay_above_the_characters_own(extension, shot, acted, reopened):
    bake(acted[1], use_strips=True)
    new = rows(shot)[1]
    face = reopened("Hero")
    assert playing(extension, face) == new
    tracks = face.data.shape_keys.animation_data.nla_tracks
    assert [(track.is_override_data, track.mute) for track in tracks] == [
        (True, True),
        (False, False),
    ]
    assert tracks[1].strips[0].action == face.mimetic.takes[new].parts["KEYS"].action
    # The character's own take, from its file, over this one
    assert bpy.ops.mimetic.blend_takes(take=rows(face)[0], over=new, influence=0.4) == {"FINISHED"}
    face = reopened("Hero")
    tracks = [t for t in face.data.shape_keys.animation_data.nla_tracks if not t.mute]
    assert [track.strips[0].action.library is None for track in tracks] == [True, False]


def test_a_take_of_the_characters_file_is_not_removed_in_a_shot(shot, acted, reopened):
    inherited = rows(shot)[0]
    with pytest.raises(RuntimeError, match="remove it there"):
        bpy.ops.mimetic.remove_take(take=inherited)
    bake(acted[1], replace_take=True)
    assert f"{inherited} is a take of the linked file" in result()["message"]
    new = rows(shot)[1]
    assert bpy.ops.mimetic.remove_take(take=new) == {"FINISHED"}
    assert rows(reopened("Hero")) == [inherited]


def test_an_object_overridden_without_its_mesh_says_what_to_do(hero, acted, linked_file):  # noqa: F811
    face = linked_file("Hero")
    bpy.context.view_layer.objects.active = face
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    with pytest.raises(RuntimeError, match="override of the mesh too"):
        bpy.ops.mimetic.bake()
    face.data = face.data.override_create(remap_local_usages=False)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}


def test_bones_of_an_overridden_rig_play_by_its_own_table(
    extension,
    rig,  # noqa: F811
    acting_file,  # noqa: F811
    linked_file,
    reopened,
):
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    count = len(rig.mimetic.controls)
    mesh = linked_file("Hero")
    rig = next(modifier for modifier in mesh.modifiers if modifier.type == "ARMATURE").object
    rig = rig.override_create(remap_local_usages=True)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.context.view_layer.update()
    bpy.ops.mimetic.load_performance(filepath=str(acting_file))
    rig.mimetic.controls["jaw turn x"].gain = 0.5
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    bpy.context.scene.frame_set(6)
    turned = np.array(rig.pose.bones["jaw"].matrix_basis)
    assert np.abs(turned - np.eye(4)).max() > 0.01

    rig = reopened("Rig")
    assert playing(extension, rig) == "hero"
    assert len(rig.mimetic.controls) == count
    row = rig.mimetic.controls["jaw turn x"]
    assert row.gain == 0.5
    assert row.is_edited
    bpy.context.scene.frame_set(6)
    np.testing.assert_allclose(np.array(rig.pose.bones["jaw"].matrix_basis), turned, atol=1e-6)


@pytest.fixture
def in_override(bake, performance, tmp_path):
    """A face with a take in an overridden collection of another file's."""
    face = bake(performance)
    cast = bpy.data.collections.new("Cast")
    cast.objects.link(face)
    bpy.context.scene.collection.objects.unlink(face)
    bpy.context.scene.collection.children.link(cast)
    library = str(tmp_path / "cast.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(library, link=True) as (_, target):
        target.collections = ["Cast"]
    scene, linked = bpy.context.scene, target.collections[0]
    scene.collection.children.link(linked)
    linked.override_hierarchy_create(scene, bpy.context.view_layer, do_fully_editable=True)
    scene.collection.children.unlink(linked)
    (face,) = (obj for obj in scene.objects if obj.type == "MESH")
    assert face.users_collection[0].override_library
    bpy.context.view_layer.objects.active = face
    return face


def test_an_overridden_collection_is_compared_beside_it(extension, in_override):
    """It takes no objects: the copy is in the scene's own."""
    assert bpy.ops.mimetic.compare_take() == {"FINISHED"}
    twin = bpy.data.objects[result()["copy"]]
    assert list(twin.users_collection) == [bpy.context.scene.collection]
    assert playing(extension, twin) == "hero"


def test_a_local_face_in_an_overridden_collection_gets_controls_and_lights(extension, in_override):
    scene = bpy.context.scene
    in_override.select_set(True)
    assert bpy.ops.object.make_local(type="SELECT_OBDATA") == {"FINISHED"}
    face = bpy.context.view_layer.objects.active
    assert not face.override_library and face.users_collection[0].override_library
    face.animation_data_clear()
    face.data.shape_keys.animation_data_clear()
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    control = face.mimetic.control_object
    assert list(control.users_collection) == [scene.collection]
    face.mimetic.has_lights = False
    before = set(scene.objects)
    extension("scene_out.face_lights").ensure(scene, face)
    lamps = set(scene.objects) - before
    assert [list(lamp.users_collection) for lamp in lamps] == [[scene.collection]] * 2
