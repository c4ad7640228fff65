# SPDX-License-Identifier: GPL-3.0-or-later
"""A wheel for the Pythons that Blenders run, from one compiled core.

The wheel of .venv's own Python is built as any other. For the other Pythons only the bindings are
compiled, against that Python's headers, and lie in the same wheel: neither an interpreter nor a
second core is needed, and libraries and data come once. auditwheel then makes it self-contained.
The Python of the window tests, where it is another one, has a wheel apart, which is not shipped.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import licences
from isolate import isolate

ROOT = Path(__file__).resolve().parents[3]
WHEELS = ROOT / "build" / "wheels"
INPUTS = (
    "CMakeLists.txt",
    "cmake",
    "pyproject.toml",
    "native",
    "blender_addon",  # `mimetic bake` brings it
    "build/data",
    "scripts/build/extension",
)


@dataclass(frozen=True)
class OtherPython:
    """A Python that a wheel is for and that need not be here; only its headers must."""

    version: str  # "3.13"
    headers: Path  # the folder that holds Python.h

    @property
    def tag(self) -> str:
        return "cp" + self.version.replace(".", "")


def cache_folder() -> Path:
    if folder := os.environ.get("MIMETIC_CACHE"):
        return Path(folder)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mimetic"


def window_folder() -> Path | None:
    """The Debian folder of the window tests, if it was made (tests/window/prepare)."""
    for suite in ("sid", "trixie"):
        folder = cache_folder() / f"window-{suite}"
        if (folder / "mimetic-window.json").exists():
            return folder
    return None


def window_python() -> OtherPython:
    folder = window_folder()
    if folder is None:
        raise SystemExit("extension: no Debian folder with Blender; run tests/window/prepare")
    version = json.loads((folder / "mimetic-window.json").read_text())["python"]
    return OtherPython(version, folder / "opt" / "python-headers" / f"python{version}")


def find_other_python(version: str) -> OtherPython | None:
    """An installed Python with headers, or headers that the window tests' folder brought."""
    script = "import sysconfig; print(sysconfig.get_path('include'))"
    python = subprocess.run(
        [ROOT / "scripts" / "find_python", version], capture_output=True, text=True, check=False
    )
    places = []
    if python.returncode == 0:
        answer = subprocess.run(
            [python.stdout.strip(), "-c", script], capture_output=True, text=True, check=True
        )
        places.append(Path(answer.stdout.strip()))
    if folder := window_folder():
        places.append(folder / "opt" / "python-headers" / f"python{version}")
    return next(
        (OtherPython(version, place) for place in places if (place / "Python.h").exists()), None
    )


def run(command: list[object]) -> None:
    """Run a command; its output is shown only if it fails."""
    words = [str(word) for word in command]
    process = subprocess.run(
        words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if process.returncode:
        print(process.stdout[-6000:], file=sys.stderr)
        raise SystemExit(f"extension: failed: {' '.join(words)}")


def state_of_inputs(pythons: list[OtherPython]) -> str:
    digest = hashlib.sha256(repr([(p.version, str(p.headers)) for p in pythons]).encode())
    for name in INPUTS:
        place = ROOT / name
        files = [place] if place.is_file() else sorted(place.rglob("*"))
        for path in files:
            if path.is_file() and path.suffix != ".pyc":
                digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def build_own(folder: Path) -> Path:
    pip = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation"]
    run([*pip, "--wheel-dir", folder, ROOT])
    return next(folder.glob("mimetic-*.whl"))


def build_tree() -> Path:
    tag = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    return next((ROOT / "build").glob(f"{tag}-{tag}-*"))


def compile_bindings(pythons: list[OtherPython]) -> None:
    if not pythons:
        return
    tree = build_tree()
    python_list = ";".join(f"{python.tag}={python.headers}" for python in pythons)
    run(["cmake", "-S", ROOT, "-B", tree, f"-DMIMETIC_OTHER_PYTHONS={python_list}"])
    targets = [f"_core_{python.tag}" for python in pythons]
    run(["cmake", "--build", tree, "-j", "2", "--target", *targets])


def with_modules(own: Path, pythons: list[OtherPython], folder: Path, *, keeps_own: bool) -> Path:
    """A copy of the own wheel with the other Pythons' modules and tags, beside its own or not."""
    with tempfile.TemporaryDirectory() as scratch:
        wheel_folder = unpack(own, Path(scratch))
        if not keeps_own:
            for old in (wheel_folder / "mimetic").glob("_core.*.so"):
                old.unlink()
        for python in pythons:
            module = next((build_tree() / "other_pythons" / python.tag).glob("_core.*.so"))
            shutil.copy(module, wheel_folder / "mimetic")
        facts = next(wheel_folder.glob("*.dist-info")) / "WHEEL"
        lines = [line for line in facts.read_text().splitlines() if line]
        kept = [line for line in lines if keeps_own or not line.startswith("Tag:")]
        tags = [f"Tag: {python.tag}-{python.tag}-linux_x86_64" for python in pythons]
        facts.write_text("\n".join(kept + tags) + "\n")
        target = folder / "-".join(python.tag for python in pythons)
        target.mkdir()
        pack(wheel_folder, target)
    return next(target.glob("*.whl"))


def build(shipped: list[OtherPython], apart: list[OtherPython]) -> list[Path]:
    """Self-contained wheels, built only if an input changed.

    One for .venv's Python and those that are shipped with it, one for each that is kept apart.
    """
    state = state_of_inputs([*shipped, *apart])
    stamp = WHEELS / "state"
    if stamp.exists() and stamp.read_text() == state:
        return sorted(WHEELS.glob("mimetic-*.whl"))
    versions = [python.version for python in (*shipped, *apart)]
    print("extension: building wheels for Python 3.11", *versions, flush=True)
    WHEELS.mkdir(parents=True, exist_ok=True)
    stamp.unlink(missing_ok=True)
    for old in WHEELS.glob("mimetic-*.whl"):
        old.unlink()
    with tempfile.TemporaryDirectory(dir=ROOT / "build") as name:
        scratch = Path(name)
        own = build_own(scratch)
        compile_bindings([*shipped, *apart])
        raw = [with_modules(own, shipped, scratch, keeps_own=True) if shipped else own]
        raw += [with_modules(own, [python], scratch, keeps_own=False) for python in apart]
        for wheel in raw:
            run([sys.executable, "-m", "auditwheel", "repair", "--strip", "-w", WHEELS, wheel])
    for wheel in WHEELS.glob("mimetic-*.whl"):
        finish(wheel)
    stamp.write_text(state)
    return sorted(WHEELS.glob("mimetic-*.whl"))


def finish(wheel: Path) -> None:
    """Keep a repaired wheel's libraries apart from a host's, and say their licences."""
    with tempfile.TemporaryDirectory(dir=wheel.parent) as name:
        scratch = Path(name)
        folder = unpack(wheel, scratch)
        isolate(folder, scratch)
        licences.write(folder)
        for archive in sorted((folder / "mimetic" / "data").glob("*.npz")):
            smaller(archive)  # deflated by numpy, and so no smaller in the wheel
        pack(folder, wheel.parent)


def unpack(wheel: Path, scratch: Path) -> Path:
    run([sys.executable, "-m", "wheel", "unpack", "--dest", scratch, wheel])
    return next(scratch.glob("mimetic-*"))


def pack(folder: Path, target: Path) -> None:
    run([sys.executable, "-m", "wheel", "pack", "--dest-dir", target, folder])


def smaller(archive: Path) -> None:
    """Compress a zip's members anew: the same format, 4 % less than zlib's best."""
    run(["advzip", "--recompress", "--shrink-normal", "--quiet", archive])
