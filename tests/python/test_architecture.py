# SPDX-License-Identifier: GPL-3.0-or-later
"""Dependencies point one way: add-on, package, bindings, core; versions are known once."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STANDARD_HEADER = re.compile(r"<[a-z_]+>")


def offences(folder: str, suffixes: tuple[str, ...], pattern: str, allowed: tuple[str, ...] = ()):
    """Lines of a folder's files that hold the pattern, comments left out."""
    files = [path for path in sorted((ROOT / folder).rglob("*")) if path.suffix in suffixes]
    assert files, folder
    found = []
    for path in files:
        if path.name in allowed:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            code = re.split(r"//|#(?!include)", line)[0]
            if re.search(pattern, code):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    return found


@pytest.mark.parametrize("folder", ["native/include", "native/src"])
def test_the_core_knows_no_python_and_never_prints_or_exits(folder):
    forbidden = r"pybind11|Python\.h|\bprintf\(|std::c(out|err)|\b(exit|abort)\("
    assert offences(folder, (".hpp", ".cpp"), forbidden) == []


def test_public_headers_include_eigen_and_the_standard_library_only():
    includes = offences("native/include", (".hpp",), r"#include")
    strange = [
        line
        for line in includes
        if not re.search(r"<(Eigen|mimetic)/", line) and not STANDARD_HEADER.search(line)
    ]
    assert strange == []


def test_the_package_knows_no_blender():
    assert offences("native/python/mimetic", (".py",), r"^\s*(import|from) bpy\b") == []


def test_importing_the_package_loads_neither_plots_nor_blender():
    code = "import sys, mimetic; print(*({'matplotlib', 'rich', 'bpy'} & sys.modules.keys()))"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []


def test_the_extension_reaches_the_package_by_one_door():
    imports = r"^\s*(import|from) mimetic\b|import_module\(f?[\"']mimetic"
    assert offences("blender_addon/mimetic", (".py",), imports, ("native.py",)) == []


def test_blenders_version_is_known_in_one_place():
    assert offences("blender_addon", (".py",), r"bpy\.app\.version", ("compat.py",)) == []


def test_the_extension_brings_no_packages_that_clash():
    assert offences("blender_addon", (".py",), r"^\s*(import|from) (cv2|scipy|matplotlib)\b") == []


def test_panels_know_no_operators():
    assert offences("blender_addon/mimetic/panels", (".py",), r"import.*operators") == []
    assert offences("blender_addon/mimetic/panels", (".py",), r"from \.+operators") == []


def test_the_extensions_version_is_the_packages():
    import tomllib

    manifest = (ROOT / "blender_addon/mimetic/blender_manifest.toml").read_text(encoding="utf-8")
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert tomllib.loads(manifest)["version"] == tomllib.loads(project)["project"]["version"]
