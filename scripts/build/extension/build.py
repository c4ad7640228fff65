# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on and its wheels with Blender's own tool into a zip, and validates it."""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import re
import shutil
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

import licences
import wheels

ADDON = wheels.ROOT / "blender_addon" / "mimetic"
SHIPPED = ("3.11", "3.13")  # Blender 4.2 to 5.0, and 5.1 on; the first is .venv's own


def blender_tool() -> Path:
    """Blender's blender_ext.py; the bpy module brings it though not the blender program."""
    spec = importlib.util.find_spec("bpy")
    if spec is None or spec.origin is None:
        raise SystemExit("extension: bpy is not in .venv; run scripts/setup")
    return next(Path(spec.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))


def ffmpeg_wheel() -> Path:
    """The wheel of imageio-ffmpeg, the only other part that Blender does not have."""
    lines = tomllib.loads((wheels.ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    requirement = next(line for line in lines if line.startswith("imageio-ffmpeg=="))
    version = requirement.split("==")[1]
    pattern = f"imageio_ffmpeg-{version}-*.whl"
    kept = wheels.ROOT / "build" / "wheels_of_others"
    if not list(kept.glob(pattern)):
        kept.mkdir(parents=True, exist_ok=True)
        pip = [sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary", ":all:"]
        with tempfile.TemporaryDirectory(dir=kept) as scratch:
            wheels.run([*pip, "--dest", scratch, requirement])
            wheel = next(Path(scratch).glob(pattern))
            wheels.smaller(wheel)
            wheel.replace(kept / wheel.name)
    return next(kept.glob(pattern))


def is_shipped(wheel: Path) -> bool:
    """Whether a wheel of the package is that of all Pythons, not one for the window tests alone."""
    return "cp311" in wheel.name.split("-")[2].split(".")


def write_manifest(folder: Path, version: str, wheel_files: list[Path]) -> None:
    """The committed manifest with pyproject.toml's version and the wheels that lie beside it."""
    path = folder / "blender_manifest.toml"
    text = re.sub(r"(?ms)^wheels\s*=\s*\[.*?\]\s*$", "", path.read_text())
    text = re.sub(r"(?m)^version\s*=.*$", f'version = "{version}"', text)
    wheel_lines = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in wheel_files)
    head, table, tail = text.partition("\n[")
    # The wheels are of one platform, so the zip is.
    platform = 'platforms = ["linux-x64"]'
    path.write_text(f"{head}\n{platform}\nwheels = [\n{wheel_lines}]\n{table}{tail}")
    manifest = tomllib.loads(path.read_text())
    if manifest["version"] != version or len(manifest["wheels"]) != len(wheel_files):
        raise SystemExit(f"extension: {path} could not be given its version and wheels")


def add_licences(folder: Path, wheel: Path) -> None:
    """The table of what the zip carries, for those who look into it; the texts are in the wheel."""
    with zipfile.ZipFile(wheel) as archive:
        name = f"mimetic/{licences.FOLDER}/{licences.TABLE}"
        (folder / licences.TABLE).write_bytes(archive.read(name))
    shutil.copy(wheels.ROOT / "LICENSE", folder)


def add_wheel(folder: Path, wheel: Path) -> None:
    """A wheel as the zip has it: the package without its copy of the add-on, which is beside."""
    if not wheel.name.startswith("mimetic-"):
        shutil.copy(wheel, folder)
        return
    with tempfile.TemporaryDirectory() as scratch:
        content = wheels.unpack(wheel, Path(scratch))
        shutil.rmtree(content / "mimetic" / "blender_addon")
        wheels.pack(content, folder)
    wheels.smaller(folder / wheel.name)


def stage(version: str, wheel_files: list[Path]) -> Path:
    folder = wheels.ROOT / "build" / "extension" / "mimetic"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ADDON, folder, ignore=shutil.ignore_patterns("__pycache__", "wheels", "*.pyc"))
    (folder / "wheels").mkdir()
    for wheel in wheel_files:
        add_wheel(folder / "wheels", wheel)
    add_licences(folder, next(wheel for wheel in wheel_files if is_shipped(wheel)))
    write_manifest(folder, version, wheel_files)
    return folder


def state_of(wheel_files: list[Path]) -> str:
    digest = hashlib.sha256(Path(__file__).read_bytes())
    sources = [path for path in sorted(ADDON.rglob("*")) if "__pycache__" not in path.parts]
    for path in [*sources, *wheel_files]:
        if path.is_file():
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def pack(target: Path, version: str, wheel_files: list[Path]) -> None:
    stamp = wheels.ROOT / "build" / "extension" / f"{target.stem}.state"
    state = state_of(wheel_files)
    if target.exists() and stamp.exists() and stamp.read_text() == state:
        return
    print(f"extension: packing {target.relative_to(wheels.ROOT)}", flush=True)
    source = stage(version, wheel_files)
    target.parent.mkdir(parents=True, exist_ok=True)
    aside = target.with_suffix(".partial.zip")
    tool = [sys.executable, blender_tool()]
    wheels.run([*tool, "build", "--source-dir", source, "--output-filepath", aside])
    wheels.run([*tool, "validate", aside])
    aside.replace(target)
    stamp.write_text(state)


def publish(zip_file: Path, folder: Path) -> None:
    """A static repository that Blender installs and updates from, wherever the folder is served.

    Earlier versions go to `folder`/earlier: of two for one Blender, either might be installed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("mimetic-*-linux_x64.zip"):
        if old.name != zip_file.name:
            (folder / "earlier").mkdir(exist_ok=True)
            old.replace(folder / "earlier" / old.name)
    shutil.copy(zip_file, folder)
    tool = [sys.executable, blender_tool()]
    wheels.run([*tool, "server-generate", "--repo-dir", folder, "--html"])
    print(f"extension: repository {folder / 'index.json'}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--window", action="store_true", help="add the window tests' Python")
    choice.add_argument("--wheels", action="store_true", help="build the wheels only")
    choice.add_argument(
        "--repository", type=Path, metavar="DIR", help="put the zip into a static repository, too"
    )
    options = parser.parse_args()

    shipped = []
    for version in SHIPPED[1:]:
        if python := wheels.find_other_python(version):
            shipped.append(python)
        else:
            print(
                f"extension: no headers of Python {version}, so none for Blender 5.1 and later;"
                f" an installed python{version} gives them, or tests/window/prepare",
                file=sys.stderr,
            )
    # One set of wheels serves both zips, so that making one does not unmake the other.
    apart = []
    if wheels.window_folder() or options.window:
        python = wheels.window_python()
        if python.tag not in {"cp311", *(other.tag for other in shipped)}:
            apart.append(python)
    all_wheels = wheels.build(shipped, apart)
    if options.wheels:
        print(wheels.WHEELS)
        return 0
    wheels_in_zip = [wheel for wheel in all_wheels if is_shipped(wheel)]
    version = tomllib.loads((wheels.ROOT / "pyproject.toml").read_text())["project"]["version"]
    if options.window:
        target = wheels.ROOT / "build" / "extension" / f"mimetic-{version}-window.zip"
        pack(target, version, [*all_wheels, ffmpeg_wheel()])
    else:
        target = wheels.ROOT / "dist" / f"mimetic-{version}-linux_x64.zip"
        pack(target, version, [*wheels_in_zip, ffmpeg_wheel()])
    if options.repository:
        publish(target, options.repository.resolve())
    print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
