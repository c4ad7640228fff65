# SPDX-License-Identifier: GPL-3.0-or-later
"""Dependencies point one way: add-on, package, bindings, core; versions are known once."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STANDARD_HEADER = re.compile(r"<[a-z_]+>")
# The folders of native/src in their order, each with its public headers: it sees those before it.
STAGES = {
    "shared": ("camera", "error", "image", "progress", "types"),
    "surface": ("surface",),
    "flow": ("flow",),
    "overlay": ("depth", "overlay"),
    "locate": ("cascade", "eigenspace", "face_spaces", "landmarks", "locate"),
    "fit": ("fit",),
    "skin": (
        *("contact", "corotational_skin", "shell", "skin", "skin_check", "skin_dynamics", "strain"),
    ),
    "muscles": ("muscles",),
    "head": ("head",),
    "solve": ("solve",),
}
# Modules of the package that name single muscles, to use them (CONTRIBUTING, "How to add a muscle")
NAMING_MUSCLES = {"excursions.py", "motion_table.py", "unit_muscles.py"}


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


def test_every_stage_of_the_core_is_in_the_order():
    folders = {path.name for path in (ROOT / "native/src").iterdir()}
    headers = {path.stem for path in (ROOT / "native/include/mimetic").rglob("*.hpp")}
    assert folders == set(STAGES)
    assert sorted(headers) == sorted(header for own in STAGES.values() for header in own)


@pytest.mark.parametrize("stage", list(STAGES)[:-1])
def test_a_stage_of_the_core_sees_earlier_ones_alone(stage):
    order = list(STAGES)
    later = order[order.index(stage) + 1 :]
    public = "|".join(header for name in later for header in STAGES[name])
    private = "|".join(later)
    pattern = rf"#include (<mimetic/({public})\.hpp>|\"([./]*/)?({private})/)"
    own = tuple(f"native/include/mimetic/{header}.hpp" for header in STAGES[stage])
    assert [
        line
        for line in offences("native", (".hpp", ".cpp"), pattern)
        if line.startswith((f"native/src/{stage}/", *own))
    ] == []


def test_muscles_are_described_in_one_file():
    import tomllib

    table = ROOT / "native/python/mimetic/data/muscles.toml"
    names = [row["name"] for row in tomllib.loads(table.read_text(encoding="utf-8"))["muscle"]]
    named = rf"\b({'|'.join(names)})\b"
    assert offences("native/src", (".hpp", ".cpp"), named) == []
    assert offences("blender_addon", (".py",), named) == []
    naming = offences("native/python/mimetic", (".py",), rf"[\"'`]{named}(\.[LR])?[\"'`]")
    assert {Path(line.split(":")[0]).name for line in naming} == NAMING_MUSCLES


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
