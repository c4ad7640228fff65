# SPDX-License-Identifier: GPL-3.0-or-later
"""Sound files of every kind that is read, small, by the makers of the tests' own samples."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np
from clips import make_clip
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.character.gltf import write_chunks
from mimetic.library.expression import Expression
from mimetic.locate.eigenspaces import FILE_NAME as SPACES
from mimetic.locate.landmarks import FILE_NAME as CASCADE
from mimetic.retarget.controls import FORMAT as PRESET
from mimetic.retarget.controls import ControlRow
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template
from sample_fit import make_fit
from sample_mesh import document, ply
from sample_performance import make_performance
from sample_taught import make_taught
from sample_truth import make_truth

from evaluation.runs.stills import PARTS
from fuzz.batch_files import contents as batch_contents
from fuzz.changed_arrays import change_arrays
from fuzz.changed_bytes import change_bytes, change_text
from fuzz.changed_json import change_glb, change_json

Change = Callable[[bytes, Random], bytes]


@dataclass(frozen=True)
class Sample:
    """A sound file and the changes that know its kind; any is changed byte by byte, too."""

    suffix: str
    content: bytes
    changes: tuple[Change, ...]


ARRAYS = (change_arrays, change_arrays, change_arrays, change_bytes)
JSON = (change_json, change_json, change_text, change_bytes)
TEXT = (change_text, change_text, change_bytes)
MESHES = (change_glb, change_glb, change_bytes)


@cache
def performance():
    """What truth and points are held against."""
    return make_performance(num_frames=5, rings=5, notes=["stopped after frame 5"])


def performances() -> list[Sample]:
    return [_saved(performance(), ".npz", ARRAYS)]


def expressions() -> list[Sample]:
    rows = np.linspace(0, 0.5, 12).reshape(6, 2)
    names, events = ["lip-corner pullers"], np.array([[1.0, 2, 3, 0.4]])
    whole = Expression(
        ["zygomaticus_major.L", "jaw_side"], rows, rows, 25.0, names, events, ["clip.mp4", "1 to 6"]
    )
    return [_saved(one, ".npz", ARRAYS) for one in (whole, whole.still())]


def taught_sets() -> list[Sample]:
    return [_saved(make_taught(num_near=2), ".npz", ARRAYS)]


def truths() -> list[Sample]:
    return [_saved(make_truth(performance(), num_points=6), ".npz", ARRAYS)]


def fits() -> list[Sample]:
    whole = _saved(make_fit(residual=[], relief=[], depth=[], depth_std=[]), ".json", JSON)
    older = json.loads(whole.content)
    for key in (
        "residual",
        "views",
        "calibration",
        "relief",
        "depth",
        "depth_std",
        "lines",
        "rest",
        "still_cover",
    ):
        del older[key]
    older["schema"] = 1
    full = _saved(make_fit(), ".json", JSON)
    return [whole, full, Sample(".json", json.dumps(older).encode(), JSON)]


def landmarks() -> list[Sample]:
    template = load_template()
    numbers = {name: int(template.landmark(name)) for name in REQUIRED}
    places = {name: template.vertices[v].tolist() for name, v in numbers.items()}
    return [
        Sample(".json", json.dumps(landmarks).encode(), JSON) for landmarks in (numbers, places)
    ]


def points() -> list[Sample]:
    return [
        Sample(".csv", b"x,y\n150,100\n160.5,120.25\n0,0\n", TEXT),
        Sample(".csv", b'\xef\xbb\xbfx, y\r\n"150",100\r\n\r\n1e2,-3\r\n', TEXT),
    ]


def face_csvs() -> list[Sample]:
    head = b"Timecode,BlendShapeCount,EyeBlinkLeft,HeadYaw"
    return [
        Sample(".csv", head + b"\n00:00:00:00.000,2,.5,-0.1\n00:00:00:01.000,2,1,0\n", TEXT),
        Sample(".csv", head + b'\r\n00:00:00:00.000,2,"0",1e-3\r\n', TEXT),
    ]


def presets() -> list[Sample]:
    edited = ControlRow("jawOpen", True, 0.8, 0.1, -0.5, 1.5, True)
    rows = [asdict(row) for row in (edited, ControlRow("smile.L"))]
    document = {"format": PRESET, "controls": rows}
    return [Sample(".json", json.dumps(document).encode(), JSON)]


def meshes() -> list[Sample]:
    result, binary = document()
    inside = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    text = dict(result, buffers=[{"uri": inside, "byteLength": len(binary)}])
    obj = b"# a head\nv 0 0 0\nv 1 0 0 0.5\nv 1 1 0\nv 0 1e0 0\nvn 0 0 1\n"
    obj += b"f 1/1 2/2 3/3 4/4\nf -4 -3 -2\n"
    return [
        Sample(".obj", obj, TEXT),
        Sample(".ply", ply("ascii"), TEXT),
        Sample(".ply", ply("binary_little_endian"), (change_text, change_bytes)),
        Sample(".ply", ply("binary_big_endian"), (change_text, change_bytes)),
        Sample(".glb", write_chunks(result, binary), MESHES),
        Sample(".gltf", json.dumps(text).encode(), JSON),
    ]


def models() -> list[Sample]:
    """Of the installed ones: the template, the eigenspaces, the cascade."""
    return [
        Sample(f".{name}", (data_folder() / name).read_bytes(), ARRAYS)
        for name in ("face.npz", SPACES, CASCADE)
    ]


def batch_files(kind: str) -> list[Sample]:
    suffix, changes = (".csv", TEXT) if kind == "table" else (".json", JSON)
    return [Sample(suffix, batch_contents()[kind], changes)]


def stills() -> list[Sample]:
    arrays = {
        "images": np.zeros((2, 8, 9, 3), np.uint8),
        "has_face": np.array([True, False]),
        "places": np.zeros((2, len(PARTS), 2)),
        "ipd": np.array([3.0, np.nan]),
        "yaw": np.zeros(2),
        "kinds": np.array(["drawn", "none"]),
        "parts": np.array(PARTS),
    }
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return [Sample(".npz", stream.getvalue(), ARRAYS)]


@cache
def clips() -> tuple[Sample, ...]:
    result = []
    with TemporaryDirectory() as folder:
        for suffix, options in (
            (".mp4", ("-c:v", "libx264", "-pix_fmt", "yuv420p")),
            (".mkv", ("-c:v", "libx264", "-pix_fmt", "yuv420p")),
            (".avi", ("-c:v", "mjpeg", "-pix_fmt", "yuvj420p")),
            (".gif", ("-pix_fmt", "rgb8")),
            (".y4m", ("-pix_fmt", "yuv420p")),
        ):
            path = make_clip(Path(folder, f"clip{suffix}"), *options, size="32x32", frames=3)
            result.append(Sample(suffix, path.read_bytes(), (change_bytes,)))
    return tuple(result)


def _saved(document, suffix: str, changes: tuple[Change, ...]) -> Sample:
    with TemporaryDirectory() as folder:
        path = Path(folder, f"sample{suffix}")
        document.save(path)
        return Sample(suffix, path.read_bytes(), changes)
