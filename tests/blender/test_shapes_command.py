# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic shapes` as a process of its own."""

import json
import os
import subprocess
import sys

import bpy
import numpy as np
import pytest


def run_shapes(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "mimetic", "shapes", *map(os.fspath, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def bust(parts, tmp_path):
    """A file with a head that has a key of its own, and one with its landmarks, in metres."""
    points, faces, marks = parts
    mesh = bpy.data.meshes.new("Bust")
    mesh.from_pydata(points, [], faces.tolist())
    head = bpy.data.objects.new("Bust", mesh)
    bpy.context.scene.collection.objects.link(head)
    head.scale = (0.01,) * 3
    head.location = (0.3, -0.2, 1.5)
    for name in ("Basis", "jawOpen"):
        head.shape_key_add(name=name)
    bpy.context.view_layer.update()
    path = tmp_path / "bust.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    landmarks = tmp_path / "landmarks.json"
    places = {n: (0.01 * points[v] + np.array(head.location)).tolist() for n, v in marks.items()}
    landmarks.write_text(json.dumps(places))
    return path, landmarks


@pytest.mark.oldest_and_newest
def test_a_head_gets_the_shapes_in_a_copy_and_its_own_stay(bust, tmp_path):
    path, landmarks = bust
    before, out = path.read_bytes(), tmp_path / "out.blend"
    ran = run_shapes(f"{path}:Bust", "--out", out, "--landmarks", landmarks)
    assert ran.returncode == 0, ran.stderr
    assert "51 of ARKit's shapes on Bust; 1 keys of such names stay" in ran.stdout
    assert path.read_bytes() == before
    bpy.ops.wm.open_mainfile(filepath=str(out))
    head = bpy.data.objects["Bust"]
    keys = head.data.shape_keys.key_blocks
    assert len(keys) == 53

    def points(name):
        places = np.empty(3 * len(head.data.vertices), np.float32)
        keys[name].points.foreach_get("co", places)
        return places.reshape(-1, 3)

    rest = points("Basis")
    np.testing.assert_array_equal(points("jawOpen"), rest)
    lowered = points("eyeBlinkLeft") - rest
    assert -1.5 < lowered[:, 2].min() < -0.5  # centimetres
    assert rest[np.abs(lowered).max(axis=1) > 0.1, 0].min() > 0.5  # of one eye


@pytest.mark.newest
def test_without_a_file_the_landmarks_place_themselves_and_a_glb_has_the_shapes(bust, tmp_path):
    path, _ = bust
    out = tmp_path / "out.glb"
    ran = run_shapes(f"{path}:Bust", "--out", out)
    assert ran.returncode == 0, ran.stderr
    whole = out.read_bytes()
    length = int.from_bytes(whole[12:16], "little")
    names = json.loads(whole[20 : 20 + length])["meshes"][0]["extras"]["targetNames"]
    assert len(names) == 52
    assert {"eyeBlinkLeft", "mouthSmileRight", "tongueOut"} < set(names)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{head}", "--out", "{out}.blend"], "give it as HEAD.blend:OBJECT"),
        (["{head}:Bust", "--out", "{out}.fbx"], ".blend, .glb"),
        (["{head}:Bust", "--out", "{head}"], "bust.blend"),
        (["{head}:nobody", "--out", "{out}.blend"], "bust.blend has no object nobody; it has Bust"),
        (["{out}.blend:Bust", "--out", "{out}.glb"], "no such file"),
        (["{head}:Bust", "--out", "{out}.blend", "--landmarks", "{head}"], "bust.blend"),
    ],
    ids=["form", "suffix", "onto itself", "object", "missing", "landmarks"],
)
def test_bad_input_gets_status_2_and_one_line(bust, tmp_path, arguments, said):
    places = {"head": bust[0], "out": tmp_path / "out"}
    ran = run_shapes(*(argument.format(**places) for argument in arguments))
    assert ran.returncode == 2
    assert said in ran.stderr
    assert len(ran.stderr.strip().splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bust.blend", "landmarks.json"]
