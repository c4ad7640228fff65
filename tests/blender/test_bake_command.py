# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake` as a process of its own."""

import dataclasses
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pytest


def run_bake(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "mimetic", "bake", *map(os.fspath, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def untouched(performance) -> np.ndarray:
    """V truth values: control vertices that lie too far from lips and lids for contact."""
    from mimetic.muscles.contact import contact_on

    free = np.ones(len(performance.neutral_vertices), bool)
    free[contact_on(performance.neutral_vertices).moved] = False
    return free


@pytest.fixture(scope="module")
def baked(performance_file, footage, tmp_path_factory) -> Path:
    """A .blend that the command wrote, to be opened."""
    out = tmp_path_factory.mktemp("baked") / "face.blend"
    ran = run_bake(performance_file, "--out", out, "--footage", footage)
    assert ran.returncode == 0, ran.stderr
    assert list(out.parent.iterdir()) == [out]
    return out


def test_a_blend_opens_with_face_curves_camera_and_footage(performance, baked, footage):
    bpy.ops.wm.open_mainfile(filepath=str(baked))
    scene = bpy.context.scene
    assert (scene.render.fps, scene.render.fps_base) == (25, 1.0)
    assert (scene.render.resolution_x, scene.render.resolution_y) == (400, 300)
    assert (scene.frame_start, scene.frame_end) == (1, 40)
    face = bpy.data.objects["Face"]
    scene.frame_set(20)
    face.modifiers.clear()
    evaluated = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([evaluated.matrix_world @ v.co for v in evaluated.data.vertices])
    x, y, z = performance.surface_in_camera(19).T
    apart = np.abs(points - np.column_stack([x, z, -y])).max(axis=1)
    free = untouched(performance)
    assert free.mean() > 0.3
    assert apart[free].max() < 2e-6
    assert apart.max() < 0.03  # made-up muscles, which drive the lips deep into each other
    (behind,) = scene.camera.data.background_images
    assert os.path.samefile(bpy.path.abspath(behind.clip.filepath), footage)
    assert behind.clip.filepath.startswith("//")
    tree = scene.compositing_node_group if bpy.app.version >= (5, 0, 0) else scene.node_tree
    assert tree.nodes["Footage"].clip == behind.clip
    assert scene.render.film_transparent
    assert bpy.data.images["Face Skin"].packed_file


def test_a_blend_opens_with_a_control_object_that_plays(sheet, sheet_file, tmp_path):
    out = tmp_path / "face.blend"
    ran = run_bake(sheet_file, "--out", out, "--control-object")
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out))
    control = bpy.data.objects["Face Controls"]
    assert control.animation_data.action.name == "take"
    bpy.context.scene.frame_set(20)
    keys = bpy.data.objects["Face"].data.shape_keys.key_blocks
    actual = [keys[name].value for name in sheet.muscles]
    np.testing.assert_allclose(actual, sheet.activations[19], atol=1e-5)


@pytest.mark.oldest_and_newest
def test_a_blend_has_curves_that_were_edited_as_asked(sheet, sheet_file, tmp_path):
    from mimetic.character.curve_settings import CurveSettings, edited, parse_factors

    out = tmp_path / "face.blend"
    options = ["--smooth-curves", "0.08", "--neutral", "4", "--exaggerate"]
    factors = ["1.5", "lip-corners=0.5"]
    ran = run_bake(sheet_file, "--out", out, *options, *factors)
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out))
    bpy.context.scene.frame_set(20)
    face = bpy.data.objects["Face"]
    settings = CurveSettings(0.08, 4, parse_factors(factors))
    expected = edited(sheet, settings).activations[19]
    keys = face.data.shape_keys.key_blocks
    actual = [keys[name].value for name in sheet.muscles]
    np.testing.assert_allclose(actual, expected, atol=1e-5)
    assert np.abs(expected - sheet.activations[19]).max() > 0.1
    (row,) = face.mimetic.takes
    assert (row.first, row.last, row.settings) == (1, 40, "by mimetic bake")


@pytest.mark.oldest_and_newest
def test_a_glb_is_written(sheet_file, tmp_path):
    out = tmp_path / "face.glb"
    ran = run_bake(sheet_file, "--out", out)
    assert ran.returncode == 0, ran.stderr
    assert out.read_bytes()[:4] == b"glTF"


@pytest.mark.parametrize(
    ("suffix", "performance_of", "size"),
    [
        (".glb", "sheet_file", 20_000),
        (".fbx", "sheet_file", 20_000),
        (".usdc", "performance_file", 1_000_000),
        (".blend", "performance_file", 1_000_000),
        (".blend", "sheet_file", 20_000),
    ],
    ids=[".glb", ".fbx", ".usdc", ".blend", "small .blend"],
)
@pytest.mark.newest
def test_what_the_disk_refuses_gets_status_1_and_a_reason(
    request, tmp_path, suffix, performance_of, size
):
    performance_file = request.getfixturevalue(performance_of)
    out = tmp_path / f"face{suffix}"
    out.write_bytes(b"before")
    ran = subprocess.run(
        [sys.executable, "-m", "mimetic", "bake", performance_file, "--out", out],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 1
    (line,) = ran.stderr.splitlines()
    if suffix == ".blend":  # Blender itself does not say what went wrong, or that anything did
        assert "Blender failed" in line or line.endswith("is the disk full?")
        assert "^^^" not in line
    else:
        assert line == f"mimetic: {out}: File too large"
    assert out.read_bytes() == b"before" and list(tmp_path.iterdir()) == [out]


@pytest.mark.parametrize("suffix", [b".glb", b".blend"])
@pytest.mark.newest
def test_names_that_are_no_text_are_baked(performance_file, footage, tmp_path, suffix):
    folder = os.fsencode(tmp_path)
    arguments = [folder + b"/p\xe9.npz", folder + b"/clip\xe9.mp4"]
    for path, copy in zip((performance_file, footage), arguments, strict=True):
        shutil.copy(path, copy)
    out = folder + b"/face\xe9" + suffix
    command = [sys.executable, "-m", "mimetic", "bake", arguments[0], "--out", out]
    ran = subprocess.run([*command, "--footage", arguments[1]], capture_output=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert sorted(os.listdir(folder)) == sorted(
        os.path.basename(path) for path in (*arguments, out)
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{missing}", "--out", "{out}.glb"], "no such file"),
        (["{performance}", "--out", "{out}.obj"], ".blend, .glb, .fbx, .usdc, .abc, .csv, .osc"),
        (["{performance}", "--out", "{out}.blend", "--names", "arkit"], "--eyes are of .glb"),
        (["{performance}", "--out", "{out}.glb", "--control-object"], "is of a .blend"),
        (["{performance}", "--out", "{out}/nowhere/face.glb"], "no folder"),
        (["{performance}", "--out", "{out}.blend", "--neutral", "99"], "neutral frame 99 is not"),
        (["{performance}", "--out", "{out}.glb", "--exaggerate", "nose=2"], "groups are"),
        (["{text}", "--out", "{out}.glb"], "not a performance"),
        (["{performance}", "--out", "{out}.glb", "--footage", "{text}"], "text"),
        (["{performance}", "--out", "{out}.glb", "--blender-python", "{missing}"], "missing"),
    ],
    ids=[
        *("missing", "suffix", "names", "control_object", "folder", "neutral", "group"),
        *("damaged", "footage", "python"),
    ],
)
@pytest.mark.newest
def test_bad_input_gets_status_2_and_one_line(arguments, said, performance_file, tmp_path):
    text = tmp_path / "text.npz"
    text.write_text("not an archive")
    places = {
        "missing": tmp_path / "missing.npz",
        "performance": performance_file,
        "text": text,
        "out": tmp_path / "face",
    }
    ran = run_bake(*(argument.format(**places) for argument in arguments))
    assert ran.returncode == 2
    assert said in ran.stderr
    assert len(ran.stderr.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == [text]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_bake_that_is_ended_takes_blender_along(performance_file, tmp_path, number):
    out = tmp_path / "face.glb"
    out.write_bytes(b"finished before")
    command = [sys.executable, "-m", "mimetic", "bake", performance_file, "--out", out]
    process = subprocess.Popen([*map(os.fspath, command)], stderr=subprocess.PIPE, text=True)
    while not (blender := children(process.pid)):
        time.sleep(0.02)
    time.sleep(1.0)  # in the middle of its work
    process.send_signal(number)
    process.communicate(timeout=60)
    assert process.returncode == (143 if number == signal.SIGTERM else -signal.SIGKILL)
    deadline = time.monotonic() + 60
    while any(Path(f"/proc/{child}").exists() for child in blender):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert list(tmp_path.iterdir()) == [out]
    assert out.read_bytes() == b"finished before"


def children(number: int) -> list[int]:
    return [
        int(word) for word in Path(f"/proc/{number}/task/{number}/children").read_text().split()
    ]


def test_a_target_gets_the_heads_motion_and_its_file_stays(performance_file, rig_file, tmp_path):
    out = tmp_path / "moved.blend"
    before = rig_file.read_bytes()
    ran = run_bake(performance_file, "--out", out, "--target", f"{rig_file}:rig")
    assert ran.returncode == 0, ran.stderr
    assert "head, neck of rig" in ran.stdout
    assert list(tmp_path.iterdir()) == [out]
    assert rig_file.read_bytes() == before
    bpy.ops.wm.open_mainfile(filepath=str(out))
    head = bpy.data.objects["rig"].pose.bones["head"]
    turned = []
    for frame in (1, 15):
        bpy.context.scene.frame_set(frame)
        turned.append(np.array(head.matrix_basis))
    assert np.abs(turned[0] - turned[1]).max() > 0.1


@pytest.mark.oldest_and_newest
def test_a_target_with_sliders_plays_the_muscles(performance, extension, tmp_path):
    from mimetic.character.canonical_head import make_head
    from mimetic.muscles.articulators import ARTICULATORS

    names = [shape.name for shape in make_head().shapes[:36]]
    lowest, highest = np.array([ARTICULATORS[name] for name in performance.articulators]).T
    values = np.clip(performance.articulator_values, lowest, highest)
    acted = dataclasses.replace(performance, muscles=names, articulator_values=values)
    acted.save(tmp_path / "acted.npz")
    bpy.ops.mimetic.add_face()
    name = bpy.context.active_object.name
    rig, out = tmp_path / "character.blend", tmp_path / "played.blend"
    bpy.context.scene.render.fps = 25
    bpy.ops.wm.save_as_mainfile(filepath=str(rig))
    words = ("--out", out, "--target", f"{rig}:{name}", "--few-keys", "0.00001")
    ran = run_bake(tmp_path / "acted.npz", *words)
    assert ran.returncode == 2 and "tolerance" in ran.stderr
    ran = run_bake(tmp_path / "acted.npz", *words[:-2], "--few-keys", "0.03")
    assert ran.returncode == 0, ran.stderr
    assert f"curves on {name}" in ran.stdout
    bpy.ops.wm.open_mainfile(filepath=str(out))
    face = bpy.data.objects[name]
    curves = extension("compat").curves(face.data.shape_keys).fcurves
    assert max(len(curve.keyframe_points) for curve in curves) < len(acted.frame)
    assert face.mimetic.takes[0].settings == "by mimetic bake, few keys within 0.03"
    ran = run_bake(tmp_path / "acted.npz", *words[:-2])
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out))
    face = bpy.data.objects[name]
    bpy.context.scene.frame_set(24)
    value = face.data.shape_keys.key_blocks[names[3]].value
    assert value == pytest.approx(acted.activations[23, 3], abs=1e-5)
    assert len(extension("compat").curves(face).fcurves) >= 6  # it moves as the actor's head


@pytest.mark.oldest_and_newest
def test_a_target_plays_by_a_control_object(acted, tmp_path):
    performance, file = acted
    bpy.ops.mimetic.add_face()
    name = bpy.context.active_object.name
    rig, out = tmp_path / "character.blend", tmp_path / "played.blend"
    bpy.context.scene.render.fps = 25
    bpy.ops.wm.save_as_mainfile(filepath=str(rig))
    ran = run_bake(file, "--out", out, "--target", f"{rig}:{name}", "--control-object")
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out))
    scene, face = bpy.context.scene, bpy.data.objects[name]
    assert bpy.data.objects[f"{name} Controls"].animation_data.action
    keys = face.data.shape_keys
    assert keys.animation_data.action is None  # drivers alone
    for frame in (5, 24):
        scene.frame_set(frame)
        actual = [keys.key_blocks[muscle].value for muscle in performance.muscles]
        np.testing.assert_allclose(actual, performance.activations[frame - 1], atol=1e-5)


@pytest.mark.newest
def test_a_control_object_needs_muscles(acted, rig_file, tmp_path):
    out = tmp_path / "x.blend"
    ran = run_bake(acted[1], "--out", out, "--target", f"{rig_file}:rig", "--control-object")
    assert ran.returncode == 2 and "has no muscles for --control-object" in ran.stderr
    assert not out.exists()


@pytest.mark.newest
@pytest.mark.parametrize(
    ("target", "more", "said"),
    [
        ("{rig}", [], "RIG.blend:OBJECT"),
        ("{missing}:rig", [], "no such file"),
        ("{rig}:nobody", [], "no object nobody"),
        ("{rig}:rig", ["--out", "face.obj"], ".blend"),
    ],
    ids=["form", "missing", "object", "suffix"],
)
def test_a_bad_target_gets_status_2_and_one_line(
    target, more, said, performance_file, rig_file, tmp_path
):
    named = target.format(rig=rig_file, missing=tmp_path / "missing.blend")
    ran = run_bake(performance_file, "--out", tmp_path / "x.blend", "--target", named, *more)
    assert ran.returncode == 2
    assert said in ran.stderr
    assert len(ran.stderr.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("camera", ["free", "in use", "none"])
def test_footage_lies_behind_what_a_targets_own_camera_sees(
    camera, performance_file, footage, rig_file, tmp_path
):
    bpy.ops.wm.open_mainfile(filepath=str(rig_file))
    scene = bpy.context.scene
    scene.camera = None
    if camera != "none":
        lens = bpy.data.cameras.new("Lens")
        lens.lens = 61
        if camera == "in use":
            lens.background_images.new().alpha = 0.25
        scene.camera = bpy.data.objects.new("Shot", lens)
        scene.collection.objects.link(scene.camera)
    target, out = tmp_path / "shot.blend", tmp_path / "out.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(target), check_existing=False)
    ran = run_bake(
        performance_file, "--out", out, "--target", f"{target}:rig", "--footage", footage
    )
    assert ran.returncode == 0, ran.stderr
    reasons = {"in use": "Shot has images or curves of its own", "none": "the scene has no camera"}
    said = f"behind no camera: {reasons[camera]}" if camera in reasons else "behind what Shot sees"
    assert said in ran.stdout
    bpy.ops.wm.open_mainfile(filepath=str(out))
    if (seen_through := bpy.context.scene.camera) is not None:
        (behind,) = seen_through.data.background_images
        assert seen_through.data.lens == 61
        assert behind.alpha == (1 if camera == "free" else 0.25)
        film = behind.image  # whose frames are keyed: the scene's rate is another
        assert bool(film) == (camera == "free")
        assert film is None or os.path.samefile(bpy.path.abspath(film.filepath), footage)


@pytest.mark.oldest_and_newest
def test_a_blend_opens_in_a_view_that_shows_it(baked):
    bpy.ops.wm.open_mainfile(filepath=str(baked), load_ui=True)
    areas = bpy.context.window_manager.windows[0].screen.areas
    spaces = {area.type: area.spaces.active for area in areas}
    view = spaces["VIEW_3D"]
    assert view.region_3d.view_perspective == "CAMERA"
    assert (view.shading.type, view.shading.color_type) == ("SOLID", "TEXTURE")
    assert spaces["GRAPH_EDITOR"].dopesheet.show_only_selected
    assert spaces["PROPERTIES"].context == "DATA"
    face = bpy.data.objects["Face"]
    assert bpy.context.view_layer.objects.active == face and face.select_get()
    assert bpy.context.scene.sync_mode == "FRAME_DROP"
