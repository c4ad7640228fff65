# SPDX-License-Identifier: GPL-3.0-or-later
"""The exported file is valid, and plays the same motion wherever it is opened."""

import errno
import json
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
from test_exports import largest_file

VALIDATOR = Path(__file__).resolve().parents[2] / "scripts" / "gltf_validator"
MOTION_METRES = 1e-4
RATES = {"25": (25, 1.0), "23.976": (24, 1.001)}


@pytest.fixture(params=RATES.values(), ids=RATES.keys())
def exported(request, extension, scene, performance, tmp_path):
    scene.render.fps, scene.render.fps_base = request.param
    extension("scene_out").bake(scene, performance, "take")
    path = tmp_path / "face.glb"
    extension("scene_out.gltf").export(scene, path)
    return path


def world_vertices(face, frame: float) -> np.ndarray:
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    for modifier in face.modifiers:
        modifier.show_viewport = False
    evaluated = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(len(face.data.vertices) * 3, dtype=np.float32)
    evaluated.data.vertices.foreach_get("co", points)
    matrix = np.array(evaluated.matrix_world)
    return points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def furthest_from_nearest(points: np.ndarray, others: np.ndarray) -> float:
    """The largest distance from a point to the other set: seams split vertices, so none pair up."""
    from mathutils.kdtree import KDTree

    tree = KDTree(len(others))
    for i, other in enumerate(others):
        tree.insert(other, i)
    tree.balance()
    return max(tree.find(point)[2] for point in points)


def test_the_validator_finds_neither_errors_nor_warnings(exported):
    ran = subprocess.run([VALIDATOR, exported], capture_output=True, text=True, check=False)
    report = json.loads(ran.stdout)
    counts = [report["issues"][f"num{kind}"] for kind in ("Errors", "Warnings", "Hints")]
    assert counts == [0, 0, 0], report["issues"]["messages"][:5]
    assert ran.returncode == 0
    assert report["info"]["hasMorphTargets"]
    assert exported.stat().st_size < 20e6


def test_lashes_are_cut_out_and_the_exporter_has_no_warnings(
    extension, scene, performance, tmp_path, capfd
):
    from mimetic.character import gltf
    from mimetic.character.appearance import appearance_of

    extension("scene_out").bake(scene, performance, "take", appearance_of(performance))
    capfd.readouterr()
    extension("scene_out.gltf").export(scene, tmp_path / "face.glb")
    assert "WARNING" not in "".join(capfd.readouterr())
    document, _ = gltf.read_chunks((tmp_path / "face.glb").read_bytes())
    lashes = next(m for m in document["materials"] if "Lashes" in m["name"])
    assert lashes["alphaMode"] in ("BLEND", "MASK")
    texture = lashes["pbrMetallicRoughness"]["baseColorTexture"]["index"]
    image = document["images"][document["textures"][texture]["source"]]
    assert image["mimeType"] == "image/png"  # with an alpha channel
    assert max(lashes["pbrMetallicRoughness"]["baseColorFactor"][:3]) < 0.1  # dark


def test_a_reimported_face_moves_the_same(exported, scene, performance, extension):
    rate = scene.render.fps / scene.render.fps_base
    frames = [1, 11, 20, 30, 38]  # whole scene frames, where both have keys
    face = scene.mimetic.face
    expected = [world_vertices(face, frame) for frame in frames]
    curves_of = extension("compat").curves
    bpy.ops.wm.read_factory_settings(use_empty=True)
    imported_rate = 50  # the importer has the exporter's fault with bases, so it gets a whole rate
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = imported_rate, 1.0
    bpy.ops.import_scene.gltf(filepath=str(exported))
    face = next(o for o in bpy.context.scene.objects if o.type == "MESH")
    start = min(curve.keyframe_points[0].co[0] for curve in curves_of(face).fcurves)
    for frame, points in zip(frames, expected, strict=True):
        actual = world_vertices(face, start + (frame - 1) / rate * imported_rate)
        assert furthest_from_nearest(actual, points) < MOTION_METRES
        assert furthest_from_nearest(points, actual) < MOTION_METRES


def test_times_and_weights_are_the_performances(exported, scene, performance):
    from mimetic.character import gltf

    document, _ = gltf.read_chunks(exported.read_bytes())
    (animation,) = document["animations"]
    paths = {channel["target"]["path"] for channel in animation["channels"]}
    assert paths >= {"translation", "rotation", "weights"}
    seconds, weights, names = gltf.read_weights(exported.read_bytes())
    rate = scene.render.fps / scene.render.fps_base
    np.testing.assert_allclose(seconds, np.arange(len(seconds)) / rate, atol=1e-5)
    assert weights.min() >= 0
    captured = (performance.frame - 1) / performance.fps
    ends = [document["accessors"][s["input"]]["max"][0] for s in animation["samplers"]]
    # The last key may lie between two whole frames: what moves goes on to the second
    assert captured[-1] - 1e-5 < min(ends) and max(ends) < captured[-1] + 1 / rate
    shapes = [*performance.muscles, *performance.articulators]
    values = np.hstack([performance.activations, performance.articulator_values])
    assert names[: len(shapes)] == shapes
    for i, shape in enumerate(shapes):
        actual = weights[:, i].copy()
        if f"{shape}.negative" in names:
            actual -= weights[:, names.index(f"{shape}.negative")]
        expected = np.interp(seconds, captured, values[:, i])
        np.testing.assert_allclose(actual, expected, atol=2e-3)


def test_selection_and_scene_stay(extension, scene, performance, tmp_path):
    extension("scene_out").bake(scene, performance, "take")
    ranges = [(a.use_frame_range, a.frame_start, a.frame_end) for a in bpy.data.actions]
    camera = scene.mimetic.camera
    camera.select_set(True)
    bpy.context.view_layer.objects.active = camera
    extension("scene_out.gltf").export(scene, tmp_path / "face.glb")
    assert bpy.context.view_layer.objects.active == camera
    assert [o.name for o in scene.objects if o.select_get()] == [camera.name]
    assert [path.name for path in tmp_path.iterdir()] == ["face.glb"]
    assert [(a.use_frame_range, a.frame_start, a.frame_end) for a in bpy.data.actions] == ranges


@pytest.fixture
def export(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take")
    return lambda path: extension("scene_out.gltf").export(scene, path)


def test_a_folder_that_is_missing_is_an_os_error_of_the_file(export, tmp_path):
    path = tmp_path / "nowhere" / "face.glb"
    with pytest.raises(OSError) as failure:
        export(path)
    assert failure.value.errno == errno.ENOENT and failure.value.filename == str(path)


def test_a_full_disk_is_one_reason_and_leaves_what_was_there(export, scene, tmp_path):
    path = tmp_path / "face.glb"
    path.write_bytes(b"before")
    scene.frame_set(7, subframe=0.25)
    with largest_file(100_000), pytest.raises(OSError) as failure:
        export(path)
    assert failure.value.errno == errno.EFBIG and failure.value.filename == str(path)
    assert "\n" not in str(failure.value)
    assert path.read_bytes() == b"before" and list(tmp_path.iterdir()) == [path]
    assert scene.frame_current_final == 7.25


def test_a_read_only_file_is_refused(export, extension, tmp_path):
    path = tmp_path / "face.glb"
    path.write_bytes(b"mine")
    path.chmod(0o444)
    with pytest.raises(extension("native").known_errors(), match=r"face.glb is read-only"):
        export(path)
    assert path.read_bytes() == b"mine" and list(tmp_path.iterdir()) == [path]


def test_a_link_stays_and_its_file_is_replaced(export, tmp_path):
    path, link = tmp_path / "real.glb", tmp_path / "link.glb"
    path.write_bytes(b"before")
    link.symlink_to(path)
    export(link)
    assert link.is_symlink() and path.read_bytes()[:4] == b"glTF"
    assert sorted(tmp_path.iterdir()) == [link, path]
