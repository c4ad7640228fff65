# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist changed on a face stays when it is baked again, and is told."""

import dataclasses

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.oldest_and_newest

SCULPTED, RENAMED = "muscle_03.R", "jaw_open"


def points(key) -> np.ndarray:
    result = np.empty(3 * len(key.points), dtype=np.float32)
    key.points.foreach_get("co", result)
    return result.reshape(-1, 3)


def sculpt(key, vertex: int = 100) -> np.ndarray:
    """One vertex by half a millimetre; returns the key's points then."""
    key.points[vertex].co.z += 5e-4
    return points(key)


def baked(extension, scene, performance):
    def again(taken=performance, **options):
        scene.render.fps = 25
        return extension("scene_out").bake(scene, taken, "take", **options)

    again()
    return again


@pytest.fixture
def bake(extension, scene, sheet):
    return baked(extension, scene, sheet)


@pytest.fixture
def bake_head(extension, scene, performance):
    """The same of our own head, which has paint and contact."""
    return baked(extension, scene, performance)


@pytest.fixture
def face(bake, scene):
    return scene.mimetic.face


@pytest.fixture
def keys(face):
    return face.data.shape_keys.key_blocks


@pytest.fixture(scope="module")
def other(sheet):
    """The same shapes with more in them, of a head that is a little larger."""
    return dataclasses.replace(
        sheet,
        neutral_vertices=sheet.neutral_vertices * 1.01,
        muscle_modes=sheet.muscle_modes * 1.2,
        articulator_values=sheet.articulator_values * 1.5,
    )


@pytest.fixture(scope="module")
def detailed(sheet):
    random = np.random.default_rng(5)
    return dataclasses.replace(
        sheet,
        detail_modes=sheet.muscle_modes[:3] * 40,
        detail_coefficients=0.02 * random.normal(size=(sheet.num_frames, 3)),
    )


def test_nothing_is_kept_where_no_hand_was(bake, other):
    assert bake().kept == ""
    assert bake(other).kept == ""
    assert bake().kept == ""


@pytest.mark.parametrize("name", [SCULPTED, "Brow Raisers.L"])
def test_a_sculpted_key_stays_and_is_told(bake, keys, name):
    mine = sculpt(keys[name])
    assert bake().kept == f"kept as changed by hand: the shape of {name}"
    np.testing.assert_array_equal(points(keys[name]), mine)
    bake()  # and the time after
    np.testing.assert_array_equal(points(keys[name]), mine)


def test_a_sculpted_key_goes_along_with_another_rest(bake, keys, other):
    mine = sculpt(keys[SCULPTED]) - points(keys["Basis"])
    before = points(keys["muscle_04.L"]) - points(keys["Basis"])
    assert SCULPTED in bake(other).kept
    np.testing.assert_allclose(points(keys[SCULPTED]) - points(keys["Basis"]), mine, atol=1e-7)
    after = points(keys["muscle_04.L"]) - points(keys["Basis"])
    np.testing.assert_allclose(after, 1.2 * before, atol=1e-7)


def test_a_sculpted_rest_stays_with_all_that_went_along(bake, face, keys, other):
    """Blender moves the other keys along as the basis is sculpted."""
    moved = np.zeros((len(face.data.vertices), 3), dtype=np.float32)
    moved[50:70, 1] = 0.001
    for key in keys:
        key.points.foreach_set("co", (points(key) + moved).ravel())
    mine = points(keys["Basis"])
    assert bake().kept == "kept as changed by hand: the face at rest"
    np.testing.assert_array_equal(points(keys["Basis"]), mine)
    assert bake(other).kept == "kept as changed by hand: the face at rest"
    np.testing.assert_array_equal(points(keys["Basis"]), mine)


def test_limits_and_subdivision_stay(bake, face, keys):
    keys["jaw_side"].slider_min, keys["jaw_side"].slider_max = -0.25, 0.5
    face.modifiers["Subdivision"].levels = 3
    kept = bake().kept
    assert "the limits of jaw_side" in kept and "the subdivision" in kept
    assert (keys["jaw_side"].slider_min, keys["jaw_side"].slider_max) == (-0.25, 0.5)
    assert face.modifiers["Subdivision"].levels == 3
    face.modifiers["Subdivision"].name = "smooth"
    bake()
    assert [(m.name, m.levels) for m in face.modifiers] == [("smooth", 3)]
    face.modifiers.clear()
    assert "the subdivision" in bake().kept
    assert len(face.modifiers) == 0


def test_limits_that_a_take_widened_are_not_the_hands(bake, keys, other):
    keys_before = (keys["jaw_open"].slider_min, keys["jaw_open"].slider_max)
    assert bake(other).kept == ""
    assert keys["jaw_open"].slider_max > keys_before[1]
    assert bake().kept == ""
    assert (keys["jaw_open"].slider_min, keys["jaw_open"].slider_max) == keys_before


@pytest.mark.parametrize("is_sculpted", [False, True])
def test_a_renamed_key_is_followed(extension, bake, face, keys, is_sculpted, other):
    names = [key.name for key in keys]
    keys[RENAMED].name = "Kiefer"
    if is_sculpted:
        sculpt(keys["Kiefer"])
    for take in (None, other):
        kept = bake(take).kept if take else bake().kept
        assert f"the name Kiefer of {RENAMED}" in kept
        assert ("the shape of jaw_open" in kept) == is_sculpted
        assert [key.name for key in keys] == [n.replace(RENAMED, "Kiefer") for n in names]
        curves = extension("compat").curves(face.data.shape_keys).fcurves
        paths = [curve.data_path for curve in curves]
        assert paths.count('key_blocks["Kiefer"].value') == 1
        assert f'key_blocks["{RENAMED}"].value' not in paths
    assert "Kiefer" in [shape.name for shape in face.mimetic.shapes]  # as the panel lists it


def test_a_renamed_key_that_was_moved_is_followed(bake, face, keys):
    keys[RENAMED].name = "Kiefer"
    face.active_shape_key_index = keys.find("Kiefer")
    with bpy.context.temp_override(object=face):
        bpy.ops.object.shape_key_move(type="TOP")
    assert "the name Kiefer of jaw_open" in bake().kept
    assert RENAMED not in keys


def test_a_deleted_key_comes_back_and_a_copy_is_not_taken_for_it(bake, face, keys):
    copy = face.shape_key_add(name="my copy", from_mix=False)
    copy.points.foreach_set("co", points(keys[SCULPTED]).ravel())
    mine = sculpt(keys[SCULPTED])
    face.shape_key_remove(keys["muscle_10.L"])
    bake()
    assert {"my copy", SCULPTED, "muscle_10.L"} <= set(keys.keys())
    np.testing.assert_array_equal(points(keys[SCULPTED]), mine)


def test_the_users_own_keys_and_drivers_stay(bake, face, keys, other, detailed):
    own = face.shape_key_add(name="my own", from_mix=False)
    own.value = 0.4
    sculpt(own)
    offsets = points(own) - points(keys["Basis"])
    keys["Brow Raisers"].driver_add("value").driver.expression = "0.25"
    keys["Brow Raisers"].mute = True
    for take in (detailed, other):
        bake(take)
        assert keys["my own"].value == pytest.approx(0.4)
        np.testing.assert_allclose(
            points(keys["my own"]) - points(keys["Basis"]), offsets, atol=1e-7
        )
        (driver,) = face.data.shape_keys.animation_data.drivers
        assert driver.data_path == 'key_blocks["Brow Raisers"].value'
        assert keys["Brow Raisers"].mute


def test_reset_undoes_it_all(bake, face, keys, sheet):
    before = {key.name: points(key) for key in keys}
    sculpt(keys["Basis"])
    sculpt(keys[SCULPTED])
    keys[RENAMED].name = "Kiefer"
    keys["jaw_side"].slider_min, keys["jaw_side"].slider_max = 2, 3
    face.modifiers["Subdivision"].levels = 3
    assert bake(is_reset=True).kept == ""
    assert {key.name for key in keys} == before.keys()
    for name, there in before.items():
        np.testing.assert_array_equal(points(keys[name]), there)
    assert (keys["jaw_side"].slider_min, keys["jaw_side"].slider_max) == (-1, 1)
    assert face.modifiers["Subdivision"].levels == 1
    assert bake().kept == ""


def test_detail_goes_with_a_plain_take_but_not_what_was_sculpted(bake, keys, detailed):
    plain = [key.name for key in keys]
    bake(detailed)
    assert "detail.002" in keys
    bake()
    assert [key.name for key in keys] == plain
    bake(detailed)
    sculpt(keys["detail.001"])
    assert "the shape of detail.001" in bake().kept
    assert set(keys.keys()) == {*plain, "detail.001"}
    assert keys["detail.001"].value == 0


def test_an_exported_plain_take_is_as_small_as_if_there_never_was_detail(
    extension, bake, scene, detailed, tmp_path
):
    export = extension("scene_out").gltf.export
    export(scene, tmp_path / "plain.glb")
    bake(detailed)
    bake()
    export(scene, tmp_path / "again.glb")
    sizes = [(tmp_path / f"{name}.glb").stat().st_size for name in ("plain", "again")]
    assert sizes[1] == pytest.approx(sizes[0], rel=0.01)


def test_contact_off_turns_contact_off(bake_head, scene, performance):
    from mimetic.character.contact_shapes import contact_shapes

    face = scene.mimetic.face
    keys = face.data.shape_keys.key_blocks
    bake_head(contact_shapes=contact_shapes(performance))
    assert face.mimetic.use_contact and "contact" in keys
    bake_head(contact_shapes=None)
    assert not face.mimetic.use_contact
    assert not [key.name for key in keys if key.name.startswith("contact")]


def test_the_button_says_what_was_kept_and_resets(scene, sheet_file, capfd):
    scene.mimetic.performance_path = str(sheet_file)
    bpy.ops.mimetic.bake()
    key = scene.mimetic.face.data.shape_keys.key_blocks[SCULPTED]
    before = points(key)
    sculpt(key)
    capfd.readouterr()
    bpy.ops.mimetic.bake()
    assert f"kept as changed by hand: the shape of {SCULPTED}" in capfd.readouterr().out
    bpy.ops.mimetic.bake(reset_hand_changes=True)
    assert "by hand" not in capfd.readouterr().out
    np.testing.assert_array_equal(points(key), before)


@pytest.fixture(scope="module")
def appearance(performance, footage):
    from mimetic.character.appearance import appearance_of

    return appearance_of(performance, footage)


@pytest.mark.parametrize("how", ["painted", "painted and packed", "exchanged"])
def test_a_picture_that_was_painted_on_stays(bake_head, scene, appearance, how):
    face = scene.mimetic.face
    bake_head(appearance=appearance)
    tree = face.data.materials["Face Skin"].node_tree
    node = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    first = node.image
    assert bake_head(appearance=appearance).kept == ""
    assert node.image != first  # the new take's
    if how == "exchanged":
        node.image = bpy.data.images.new("mine", 8, 8)
    else:
        node.image.pixels[:4] = (1, 0, 0, 1)
        if "packed" in how:
            node.image.pack()
    mine = node.image
    assert (
        bake_head(appearance=appearance).kept == "kept as changed by hand: the picture of Face Skin"
    )
    assert node.image == mine
    bake_head(appearance=appearance, is_reset=True)
    assert (node.image == mine) == (how == "exchanged")  # nothing says whose node it is


@pytest.mark.parametrize("use_few_keys", [False, True])
def test_drivers_that_set_muscles_are_told(extension, bake, face, other, use_few_keys):
    num_curves = bake(other).num_curves
    keys = face.data.shape_keys
    driver = keys.key_blocks[SCULPTED].driver_add("value").driver
    driver.expression = "0.25"
    summary = bake(other, tolerance=0.01 if use_few_keys else 0.0)
    assert summary.remark == f"drivers of {face.name} set {SCULPTED}"
    assert summary.num_curves == num_curves - 1
    path = keys.key_blocks[SCULPTED].path_from_id("value")
    assert path not in {curve.data_path for curve in extension("compat").curves(keys).fcurves}
    keys.key_blocks[SCULPTED].driver_remove("value")
    summary = bake(other)
    assert (summary.remark, summary.num_curves) == ("", num_curves)
