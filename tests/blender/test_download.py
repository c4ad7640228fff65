# SPDX-License-Identifier: GPL-3.0-or-later
"""What users download: the zip's parts, size and licences, and the repository that serves it."""

import io
import json
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import bpy
import pytest
from conftest import ROOT

pytestmark = pytest.mark.oldest_and_newest


@pytest.fixture(scope="module")
def zip_file() -> Path:
    """The zip that scripts/build_extension made; scripts/test runs that first."""
    files = list((ROOT / "dist").glob("mimetic-*-linux_x64.zip"))
    assert len(files) == 1, "run scripts/build_extension"
    return files[0]


@pytest.fixture(scope="module")
def wheel(zip_file):
    with zipfile.ZipFile(zip_file) as archive:
        names = [name for name in archive.namelist() if name.startswith("wheels/mimetic-")]
        assert len(names) == 1
        with zipfile.ZipFile(io.BytesIO(archive.read(names[0]))) as inner:
            yield inner


def test_one_zip_under_100_mb_has_the_modules_of_all_blenders(zip_file, wheel):
    assert zip_file.stat().st_size < 100e6
    modules = [name for name in wheel.namelist() if re.match(r"mimetic/_core\..*\.so", name)]
    pythons = {re.search(r"cpython-(\d+)", name)[1] for name in modules}
    assert f"{sys.version_info[0]}{sys.version_info[1]}" in pythons
    assert pythons == {"311", "313"}


def test_the_manuals_table_of_its_parts_is_true(zip_file):
    """To half a megabyte: sizes.py prints it."""
    ran = subprocess.run(
        [sys.executable, ROOT / "scripts" / "build" / "extension" / "sizes.py", zip_file],
        capture_output=True,
        text=True,
        check=True,
    )
    rows = re.findall(r"^(\S.*?) +([\d.]+) +([\d.]+)$", ran.stdout, re.MULTILINE)
    page = (ROOT / "docs" / "guide" / "installing.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| (\S.*?) \| ([\d.]+) \| ([\d.]+) \|$", page, re.MULTILINE)
    now = {(part, i): float(mb) for part, *both in rows for i, mb in enumerate(both)}
    stated = {(part, i): float(mb) for part, *both in table for i, mb in enumerate(both)}
    assert len(rows) >= 11 and stated == pytest.approx(now, abs=0.5)


def test_the_licence_of_every_library_is_in_the_zip(zip_file, wheel):
    libraries = {name for name in wheel.namelist() if name.startswith("mimetic.libs/")}
    assert len(libraries) > 20
    with zipfile.ZipFile(zip_file) as archive:
        table = archive.read("LICENSES.md").decode()
        assert b"GNU GENERAL PUBLIC LICENSE" in archive.read("LICENSE")
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if line.startswith("| ")]
    files = {file for row in rows[2:] for file in row[3].split(", ")}
    assert {Path(name).name for name in libraries} <= files
    for row in rows[2:]:
        assert len(wheel.read(f"mimetic/licenses/{row[4]}")) > 500, row
    for part in ("libceres-dev", "libeigen3-dev", "pybind11", "opencv-data"):
        assert part in {row[0] for row in rows}


def test_blender_installs_it_from_a_static_repository(zip_file, tmp_path):
    served, installed = tmp_path / "served", tmp_path / "installed"
    served.mkdir()
    installed.mkdir()
    (served / zip_file.name).symlink_to(zip_file)
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    tool = [sys.executable, str(scripts / "addons_core/bl_pkg/cli/blender_ext.py")]
    here = ["--local-dir", str(installed), "--remote-url", (served / "index.json").as_uri()]
    blender = ["--blender-version", ".".join(map(str, bpy.app.version))]
    for command in (
        ["server-generate", "--repo-dir", str(served)],
        ["sync", *here],
        ["install", *here, *blender, "mimetic"],
    ):
        subprocess.run([*tool, *command], check=True, capture_output=True)
    entry = json.loads((served / "index.json").read_text())["data"][0]
    assert (entry["id"], entry["platforms"]) == ("mimetic", ["linux-x64"])
    assert entry["archive_size"] == zip_file.stat().st_size
    manifest = tomllib.loads((installed / "mimetic" / "blender_manifest.toml").read_text())
    assert all((installed / "mimetic" / wheel).is_file() for wheel in manifest["wheels"])
