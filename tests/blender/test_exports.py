# SPDX-License-Identifier: GPL-3.0-or-later
"""What is exported is read back by Blender's importers and compared, frame by frame."""

import dataclasses
import errno
import json
import os
import resource
import subprocess
import sys
from contextlib import contextmanager

import bpy
import numpy as np
import pytest

SUFFIXES = (".fbx", ".usdc", ".abc")
FRAMES = (1, 4, 8)
ROWS = range(16, 24)  # eight frames in which jaw and lids go below 0 and the head turns
FPS = 25
# Metres that a vertex may be off after the way through a file
NEAR = {".fbx": 2e-6, ".usdc": 2e-6, ".abc": 2e-7}


def cut(performance, rows):
    """Some of its frames, one after the other."""
    fields = ("head_pose", "head_pose_cov", "activations", "activations_std", "quality")
    fields += ("articulator_values",)
    values = {name: np.asarray(getattr(performance, name))[rows] for name in fields}
    return dataclasses.replace(performance, frame=1 + np.arange(len(rows)), **values)


@pytest.fixture(scope="session")
def short(performance):
    return cut(performance, ROWS)


@pytest.fixture(scope="session")
def hero(acted, tmp_path_factory):
    """The same of muscles that heads have; its file."""
    short = cut(acted[0], ROWS)
    path = tmp_path_factory.mktemp("hero") / "hero.npz"
    short.save(path)
    return short, path


@pytest.fixture
def face(extension, scene, short):
    assert short.articulator_values.min() < -0.1 and short.articulator_values.max() > 0.1
    scene.render.fps = FPS
    extension("scene_out").bake(scene, short, "take")
    return scene.mimetic.face


def world_vertices(obj, frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    for modifier in obj.modifiers:
        if modifier.type == "SUBSURF":
            modifier.show_viewport = False
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(evaluated.data.vertices), dtype=np.float32)
    evaluated.data.vertices.foreach_get("co", points)
    matrix = np.array(evaluated.matrix_world)
    return points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def read(path) -> tuple[list[bpy.types.Object], int]:
    """Objects of a file in an empty scene, and by how much its frames are late."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    if path.suffix == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))
    elif path.suffix == ".abc":
        bpy.ops.wm.alembic_import(filepath=str(path), as_background_job=False)
    else:
        bpy.ops.wm.usd_import(filepath=str(path))
    # Blender's FBX importer puts the file's second 0 at frame 1, where the exporter has frame 1 at
    # 1 / 25 of a second
    return list(bpy.context.scene.objects), int(path.suffix == ".fbx")


def mesh_of(objects):
    (mesh,) = (obj for obj in objects if obj.type == "MESH")
    return mesh


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_face_that_is_read_back_moves_the_same(extension, scene, face, tmp_path, suffix):
    expected = [world_vertices(face, frame) for frame in FRAMES]
    path = tmp_path / f"face{suffix}"
    extension("scene_out.exports").export(scene, path, face)
    assert list(tmp_path.iterdir()) == [path]
    objects, late = read(path)
    mesh = mesh_of(objects)
    for frame, points in zip(FRAMES, expected, strict=True):
        actual = world_vertices(mesh, frame + late)
        assert actual.shape == points.shape
        assert np.abs(actual - points).max() < NEAR[suffix], frame


def test_a_usd_file_says_that_the_face_is_subdivided(extension, scene, face, tmp_path):
    assert [m.type for m in face.modifiers if m.show_viewport][-1] == "SUBSURF"
    count = len(face.data.vertices)
    extension("scene_out.exports").export(scene, tmp_path / "face.usdc", face)
    assert face.modifiers[-1].show_viewport
    if "import_subdivision" not in bpy.ops.wm.usd_import.get_rna_type().properties:
        pytest.skip("this Blender does not read it")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(tmp_path / "face.usdc"), import_subdivision=True)
    mesh = mesh_of(bpy.context.scene.objects)
    assert "SUBSURF" in [m.type for m in mesh.modifiers]
    assert len(mesh.data.vertices) == count


@pytest.mark.parametrize("suffix", (".fbx", ".usdc"))
def test_weights_are_read_back_and_none_is_below_0(extension, scene, face, short, tmp_path, suffix):
    path = tmp_path / f"face{suffix}"
    extension("scene_out.exports").export(scene, path, face)
    objects, late = read(path)
    keys = mesh_of(objects).data.shape_keys.key_blocks

    def name(shape):
        return shape.replace(".", "_") if suffix == ".usdc" else shape

    for frame in FRAMES:
        bpy.context.scene.frame_set(frame + late)
        for shape, value in zip(short.muscles, short.activations[frame - 1], strict=True):
            assert keys[name(shape)].value == pytest.approx(value, abs=1e-5)
        for shape, value in zip(
            short.articulators, short.articulator_values[frame - 1], strict=True
        ):
            opposite = keys.get(name(f"{shape}.negative"))
            actual = keys[name(shape)].value - (opposite.value if opposite else 0)
            assert actual == pytest.approx(value, abs=1e-5)
        assert min(key.value for key in keys) >= 0


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_scene_stays_as_it_is(extension, scene, face, tmp_path, suffix):
    scene.frame_start, scene.frame_end = 3, 5
    scene.frame_set(4)
    camera = scene.mimetic.camera
    camera.select_set(True)
    bpy.context.view_layer.objects.active = camera
    keys = face.data.shape_keys
    ranges = [(key.name, key.slider_min, key.slider_max) for key in keys.key_blocks]
    curves = [c.data_path for c in extension("compat").curves(keys).fcurves]
    before = world_vertices(face, 4)
    extension("scene_out.exports").export(scene, tmp_path / f"face{suffix}", face)
    assert (scene.frame_start, scene.frame_end, scene.frame_current) == (3, 5, 4)
    assert bpy.context.view_layer.objects.active == camera
    assert [o.name for o in scene.objects if o.select_get()] == [camera.name]
    assert [(k.name, k.slider_min, k.slider_max) for k in keys.key_blocks] == ranges
    assert [c.data_path for c in extension("compat").curves(keys).fcurves] == curves
    np.testing.assert_array_equal(world_vertices(face, 4), before)


def test_an_exporter_that_is_missing_is_said(extension, scene, face, tmp_path, monkeypatch):
    exports = extension("scene_out.exports")
    formats = dict(exports.FORMATS)
    formats[".usdc"] = exports.Format("USD", lambda: False, formats[".usdc"].write, "")
    monkeypatch.setattr(exports, "FORMATS", formats)
    with pytest.raises(extension("native").known_errors(), match="no USD exporter"):
        exports.export(scene, tmp_path / "face.usdc", face)
    assert list(tmp_path.iterdir()) == []


@contextmanager
def largest_file(size: int):
    """While it lasts no file grows beyond this many bytes, as if the disk were full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("short_of", [10, 100, 300, 500_000])
def test_a_usd_file_that_is_cut_off_is_refused(extension, scene, face, tmp_path, short_of):
    exports = extension("scene_out.exports")
    path = tmp_path / "face.usdc"
    exports.export(scene, path, face)
    before = path.read_bytes()
    assert len(before) > 600_000
    # The exporter says that it is done all the same
    with (
        largest_file(len(before) - short_of),
        pytest.raises(OSError, match=r"face.usdc: .*probably no space is left .*; free some"),
    ):
        exports.export(scene, path, face)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_an_exporters_traceback_of_a_full_disk_is_one_reason(extension, scene, face, tmp_path):
    path = tmp_path / "face.fbx"
    with largest_file(100_000), pytest.raises(OSError) as failure:
        extension("scene_out.exports").export(scene, path, face)
    assert failure.value.errno == errno.EFBIG and failure.value.filename == str(path)
    assert failure.value.strerror == os.strerror(errno.EFBIG)
    assert list(tmp_path.iterdir()) == []


def test_an_exporters_other_traceback_is_its_last_line(extension):
    report = 'Error: Python: Traceback (most recent call last):\n  File "x.py", line 1\n'
    error = RuntimeError(report + "KeyError: 'bone'\nLocation: ops.py:109\n")
    failure = extension("scene_out.exporter_reports").reported(error, "face.fbx")
    assert failure.errno is None and str(failure) == "face.fbx: KeyError: 'bone'"


def test_the_operator_writes_and_says_what_is_lost(face, tmp_path):
    result = bpy.ops.mimetic.export_character(filepath=str(tmp_path / "a"), format="USD")
    assert result == {"FINISHED"} and (tmp_path / "a.usdc").is_file()
    told = json.loads(bpy.context.window_manager.mimetic_result)
    assert told["file"] == str(tmp_path / "a.usdc") and "names" in told["message"]
    with pytest.raises(RuntimeError, match="nowhere"):
        bpy.ops.mimetic.export_character(filepath=str(tmp_path / "nowhere/a"), format="FBX")


def run_bake(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "mimetic", "bake", *map(os.fspath, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("has_target", [False, True])
@pytest.mark.parametrize("suffix", (".fbx", ".usdc"))
@pytest.mark.oldest_and_newest
def test_the_command_writes_arkits_names(scene, hero, tmp_path, suffix, has_target):
    from mimetic.retarget.unit_fit import unit_order, unit_values

    performance, file = hero
    out, target = tmp_path / f"face{suffix}", ()
    if has_target:  # a head with muscles, which make the 52
        bpy.ops.mimetic.add_face()
        scene.render.fps = FPS
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "character.blend"))
        target = "--target", f"{tmp_path / 'character.blend'}:{bpy.context.active_object.name}"
    ran = run_bake(file, "--out", out, "--names", "arkit", *target)
    assert ran.returncode == 0, ran.stderr
    assert ("Euler" in ran.stdout) == (suffix == ".fbx")
    objects, late = read(out)
    keys = mesh_of(objects).data.shape_keys.key_blocks
    assert sorted(key.name for key in list(keys)[1:]) == sorted(unit_order())
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame + late)
        actual = [keys[name].value for name in unit_order()]
        np.testing.assert_allclose(actual, unit_values(performance)[frame - 1], atol=1e-5)


@pytest.mark.oldest_and_newest
def test_a_target_is_exported_by_its_own_keys(extension, scene, hero, tmp_path):
    from mimetic.character import gltf

    performance, file = hero
    bpy.ops.mimetic.add_face()
    character = bpy.context.active_object
    rig = tmp_path / "character.blend"
    scene.render.fps = FPS
    bpy.ops.wm.save_as_mainfile(filepath=str(rig))
    extension("scene_out.bound").bake(scene, performance, "take", character)
    expected = world_vertices(character, 6)
    for suffix in (".glb", *SUFFIXES):
        out = tmp_path / f"played{suffix}"
        ran = run_bake(file, "--out", out, "--target", f"{rig}:{character.name}")
        assert ran.returncode == 0, ran.stderr
    _, weights, names = gltf.read_weights((tmp_path / "played.glb").read_bytes())
    for muscle, values in zip(performance.muscles, performance.activations.T, strict=True):
        np.testing.assert_allclose(weights[:, names.index(muscle)], values, atol=1e-5)
    # FBX leaves out what a shape hardly moves, of each of its 80 shapes; the command's own bake is
    # .02 mm from this one before any file is written
    for suffix in SUFFIXES:
        objects, late = read(tmp_path / f"played{suffix}")
        apart = np.abs(world_vertices(mesh_of(objects), 6 + late) - expected).max()
        assert apart < 5e-5, suffix


def test_a_rig_goes_along_and_moves_the_head(extension, scene, face, tmp_path):
    """A mesh on an armature, as characters have it: bones turn it in the file as they did."""
    face.animation_data_clear()
    face.matrix_basis.identity()
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("head")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    pose = armature.pose.bones["head"]
    pose.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (8, 0.6)):
        pose.rotation_euler = (0, angle, 0)
        pose.keyframe_insert("rotation_euler", frame=frame)
    face.vertex_groups.new(name="head").add(range(len(face.data.vertices)), 1.0, "REPLACE")
    face.modifiers.new("Armature", "ARMATURE").object = armature
    face.parent = armature
    expected = [world_vertices(face, frame) for frame in FRAMES]
    for suffix in (".fbx", ".usdc", ".abc"):
        extension("scene_out.exports").export(scene, tmp_path / f"rigged{suffix}", face)
    for suffix in (".fbx", ".usdc", ".abc"):
        objects, late = read(tmp_path / f"rigged{suffix}")
        mesh = mesh_of(objects)
        assert suffix == ".abc" or any(obj.type == "ARMATURE" for obj in objects)
        for frame, points in zip(FRAMES, expected, strict=True):
            apart = np.abs(world_vertices(mesh, frame + late) - points).max()
            assert apart < 2e-5, (suffix, frame)
