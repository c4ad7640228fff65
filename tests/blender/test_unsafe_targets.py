# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing is written where the next file that is opened would not have it."""

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.newest


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    return tmp_path_factory.mktemp("library") / "cast.blend"


@pytest.fixture
def cast(extension, performance, library):
    """A file with a baked Face and an armature with a head bone; its objects, linked."""
    if not library.exists():
        extension("scene_out").bake(bpy.context.scene, performance, "first")
        bones = bpy.data.armatures.new("Rig")
        rig = bpy.data.objects.new("Rig", bones)
        bpy.context.scene.collection.objects.link(rig)
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        bones.edit_bones.new("head").tail = (0, 0, 0.2)
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.ops.wm.save_as_mainfile(filepath=str(library))
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, target):
        target.objects = ["Face", "Rig"]
    return {linked.name: linked for linked in target.objects}


@pytest.fixture
def scene(cast):
    """Of the file that the cast was linked into."""
    return bpy.context.scene


def linked(target):
    return target


def data_linked(target):
    return target.copy()


def override(target):
    return target.override_create(remap_local_usages=False)


def whole_override(target):
    face = override(target)
    face.data = face.data.override_create(remap_local_usages=False)
    return face


def shown(target) -> bpy.types.Object:
    """In the scene and selected, as a user has it."""
    scene = bpy.context.scene
    scene.collection.objects.link(target)
    target.select_set(True)
    bpy.context.view_layer.objects.active = target
    bpy.context.view_layer.update()
    return target


def actions_here() -> list[str]:
    return [action.name for action in bpy.data.actions if not action.library]


def refusal(operator) -> str:
    """What a script gets that presses a button which is grey."""
    assert not operator.poll()
    with pytest.raises(RuntimeError) as refused:
        operator()
    return str(refused.value)


@pytest.mark.parametrize("kind", [linked, data_linked, override, whole_override])
def test_a_face_that_is_linked_takes_no_bake(
    extension, scene, cast, performance, performance_file, kind
):
    from mimetic import InvalidInput

    face = scene.mimetic.face = shown(kind(cast["Face"]))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    message = refusal(bpy.ops.mimetic.bake)
    assert "Make Local" in message
    assert "cast.blend" in message or kind in (override, whole_override)
    with pytest.raises(InvalidInput, match="Make Local"):
        extension("scene_out").bake(scene, performance, "take")
    assert actions_here() == []
    assert scene.mimetic.camera is None

    # The way out that the text names
    assert bpy.ops.object.make_local(type="SELECT_OBDATA") == {"FINISHED"}
    face = bpy.context.view_layer.objects.active
    assert scene.mimetic.face == face
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert scene.mimetic.face == face
    assert face.data.shape_keys.animation_data.action.library is None


@pytest.mark.parametrize("kind", [linked, data_linked, override, whole_override])
def test_muscles_and_contact_are_not_put_on_what_is_linked(extension, scene, cast, kind):
    from mimetic import InvalidInput

    face = shown(kind(cast["Face"]))
    for operator in (bpy.ops.mimetic.add_landmarks, bpy.ops.mimetic.attach_muscles):
        assert "Make Local" in refusal(operator)
    with pytest.raises(InvalidInput, match="Make Local"):
        extension("scene_out.foreign").attach(face, None, {}, None)
    before = face.data.shape_keys.key_blocks.keys()
    face.mimetic.use_contact = True
    assert face.data.shape_keys.key_blocks.keys() == before


@pytest.mark.parametrize("kind", [linked, data_linked, override])
def test_linked_sliders_are_not_put_to_rest(cast, kind):
    shown(kind(cast["Face"]))
    assert "Make Local" in refusal(bpy.ops.mimetic.rest_face)


def test_the_sliders_of_an_override_go_to_rest(cast):
    face = shown(whole_override(cast["Face"]))
    face.data.shape_keys.animation_data_clear()
    face.data.shape_keys.key_blocks["jaw_open"].value = 0.5
    assert bpy.ops.mimetic.rest_face() == {"FINISHED"}
    values = [key.value for key in face.data.shape_keys.key_blocks[1:]]
    assert not any(values)


def test_the_head_of_a_linked_target_is_not_keyed(extension, scene, cast, performance):
    from mimetic import InvalidInput

    face = shown(cast["Face"])
    before = face.animation_data.action
    head = extension("scene_out").head
    with pytest.raises(InvalidInput, match="library override"):
        head.bake(scene, performance, "take", head.Target(face.name))
    assert face.animation_data.action == before


def test_a_rig_that_is_an_override_keeps_its_heads_curves(
    extension, scene, cast, performance_file, tmp_path
):
    rig = shown(override(cast["Rig"]))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    scene.mimetic.head.target = rig
    assert bpy.ops.mimetic.bake_head() == {"FINISHED"}
    scene.frame_set(20)
    turned = np.array(rig.pose.bones["head"].matrix)
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.scene.frame_set(20)
    rig = bpy.context.scene.objects["Rig"]
    assert rig.override_library
    np.testing.assert_allclose(np.array(rig.pose.bones["head"].matrix), turned, atol=1e-6)
    assert np.abs(turned - np.array(rig.pose.bones["head"].bone.matrix_local)).max() > 0.01


def test_an_override_that_is_not_editable_is_refused(extension, scene, cast, performance_file):
    rig = shown(override(cast["Rig"]))
    rig.override_library.is_system_override = True
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    scene.mimetic.head.target = rig
    assert "make it editable" in refusal(bpy.ops.mimetic.bake_head)


def test_an_action_that_is_linked_is_copied(extension, scene, library, cast, performance):
    """What else moves the target goes on, and the linked action stays as it is."""
    rig = shown(override(cast["Rig"]))
    rig.animation_data_create().action = cast["Face"].animation_data.action
    action = rig.animation_data.action
    assert action.library
    head = extension("scene_out").head
    head.bake(scene, performance, "take", head.Target("Rig", "head"))
    assert rig.animation_data.action.library is None
    assert action.name == "first head"


def test_a_metarig_is_not_keyed_as_a_whole(extension, scene, performance, performance_file):
    from mimetic import InvalidInput

    bones = bpy.data.armatures.new("metarig")
    rig = shown(bpy.data.objects.new("metarig", bones))
    bpy.ops.object.mode_set(mode="EDIT")
    bones.edit_bones.new("spine.006").tail = (0, 0, 0.2)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    scene.mimetic.head.target = rig
    assert "Generate" in refusal(bpy.ops.mimetic.bake_head)
    head = extension("scene_out").head
    with pytest.raises(InvalidInput, match="Generate"):
        head.bake(scene, performance, "take", head.Target("metarig"))
    assert rig.animation_data is None
    scene.mimetic.head.bone = "spine.006"  # by the user's own choice
    assert bpy.ops.mimetic.bake_head() == {"FINISHED"}


def test_a_linked_clip_is_not_stabilised(extension, scene, performance, footage, tmp_path):
    from mimetic import InvalidInput

    bpy.ops.mimetic.load_clip(filepath=str(footage))
    scene.mimetic.clip.use_fake_user = True
    library = tmp_path / "shots.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (source, target):
        target.movieclips = list(source.movieclips)
    settings = bpy.context.scene.mimetic
    settings.clip = target.movieclips[0]
    assert "Make Local" in refusal(bpy.ops.mimetic.hold_head_still)
    with pytest.raises(InvalidInput, match="Make Local"):
        extension("scene_out.stabilised").hold_still(settings.clip, performance)
    assert not bpy.ops.mimetic.release_head.poll()


def test_a_camera_that_is_linked_takes_no_lens(scene, library, cast, performance_file):
    with bpy.data.libraries.load(str(library), link=True) as (_, target):
        target.objects = ["Footage Camera"]
    scene.mimetic.camera = shown(target.objects[0])
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    assert "Footage Camera is linked" in refusal(bpy.ops.mimetic.bake)
