# SPDX-License-Identifier: GPL-3.0-or-later
"""Dependencies point one way: add-on, package, bindings, core; versions are known once."""

import ast
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
    lines = []
    for path in files:
        if path.name in allowed:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            code = re.split(r"//|#(?!include)", line)[0]
            if re.search(pattern, code):
                lines.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    return lines


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


def test_muscles_are_described_in_one_file():
    import tomllib

    table = ROOT / "native/python/mimetic/data/muscles.toml"
    names = [row["name"] for row in tomllib.loads(table.read_text(encoding="utf-8"))["muscle"]]
    named = rf"\b({'|'.join(names)})\b"
    assert offences("native/src", (".hpp", ".cpp"), named) == []
    assert offences("blender_addon", (".py",), named) == []
    assert offences("native/python/mimetic", (".py",), rf"[\"'`]{named}(\.[LR])?[\"'`]") == []


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


# The package's folders from the ground up: each imports those of lower floors alone.
PACKAGE_FLOORS = (
    {"shared"},
    {"media", "template"},
    {"skin"},
    {"muscles", "performance", "locate"},
    {"character", "score", "fit"},
    {"solve", "retarget"},
    {"head", "report"},
    {"analyse", "batch"},
    {"library"},
    {"puppet"},
    {"commands"},
)
# The core's stages, each of which includes earlier ones alone
CORE_STAGES = (
    *("shared", "raster", "surface", "flow", "locate", "fit", "skin", "muscles", "contact"),
    *("register", "retarget", "head", "solve", "analyse", "puppet"),
)
PACKAGE = ROOT / "native" / "python" / "mimetic"
LONGEST_FILE, LONGEST_FUNCTION = 400, 60  # lines


def package_files() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def imports_of(path: Path) -> set[str]:
    """First two parts of what a file imports absolutely, as in `mimetic.skin`."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            modules.add(node.module)
        elif isinstance(node, ast.Import):
            modules.update(alias.name for alias in node.names)
    return {".".join(module.split(".")[:2]) for module in modules}


def test_the_packages_root_holds_the_door_alone():
    modules = {path.name for path in PACKAGE.glob("*.py")}
    assert modules == {"__init__.py", "__main__.py"}
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir()} - {"__pycache__", "data"}
    assert folders == set().union(*PACKAGE_FLOORS)


def test_folders_of_the_package_import_lower_floors_alone():
    floor = {folder: number for number, level in enumerate(PACKAGE_FLOORS) for folder in level}
    upward = []
    for path in package_files():
        folder = path.relative_to(PACKAGE).parts[0]
        for module in imports_of(path):
            target = module.removeprefix("mimetic.")
            known = folder in floor and target in floor and target != folder
            if known and floor[target] >= floor[folder]:
                upward.append(f"{path.relative_to(PACKAGE)} imports {module}")
    assert upward == []


def test_the_package_imports_nothing_that_is_not_shipped():
    strays = [
        f"{path.relative_to(PACKAGE)} imports {module}"
        for path in package_files()
        for module in imports_of(path)
        if module.split(".")[0] in ("evaluation", "scripts", "tests")
    ]
    assert strays == []


def test_stages_of_the_core_include_earlier_ones_alone():
    order = {stage: number for number, stage in enumerate(CORE_STAGES)}
    later = []
    for base in (ROOT / "native/src", ROOT / "native/include/mimetic"):
        for path in sorted(base.rglob("*.[ch]pp")):
            stage = path.relative_to(base).parts[0]
            included = re.findall(r'#include [<"](?:mimetic/)?(\w+)/\w+\.hpp', path.read_text())
            later += [
                f"{path.relative_to(ROOT)} includes {other}"
                for other in included
                if order.get(other, 0) > order[stage]
            ]
    assert later == []


def test_every_stage_of_the_core_has_headers_and_sources_of_its_name():
    headers = {path.name for path in (ROOT / "native/include/mimetic").iterdir()}
    sources = {path.name for path in (ROOT / "native/src").iterdir()}
    assert headers == sources
    assert sources <= set(CORE_STAGES)


def test_bindings_are_named_by_their_stages_and_bound_in_their_order():
    folder = ROOT / "native/python/bindings"
    stages = {path.stem: path.stem.split("_")[1] for path in folder.glob("bind_*.cpp")}
    assert set(stages.values()) <= set(CORE_STAGES)
    for name in stages:
        functions = re.findall(r"^void (bind_\w+)\(", (folder / f"{name}.cpp").read_text(), re.M)
        assert name in functions
    text = (folder / "module.cpp").read_text(encoding="utf-8")
    bound = re.findall(r"^    bindings::(bind_\w+)\(m\);", text, re.M)
    assert sorted(bound) == sorted(stages)
    order = [CORE_STAGES.index(stages[name]) for name in bound]
    assert order == sorted(order)


def test_mathematics_is_the_cores():
    assert offences("native/python/mimetic", (".py",), r"np\.linalg|einsum|np\.add\.at") == []


def test_programs_are_commands():
    mains = [
        str(path.relative_to(PACKAGE))
        for path in package_files()
        if path.parent.name != "commands"
        and re.search(r"^def main\(|__name__ == ", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert mains == ["__main__.py"] or mains == []


def test_the_extension_names_no_module_in_a_string():
    strings = offences("blender_addon/mimetic", (".py",), r"import_module\(|[\"']mimetic\.\w+\.")
    assert [line for line in strings if "/native.py:" not in line] == []
    door = (ROOT / "blender_addon/mimetic/native.py").read_text(encoding="utf-8")
    assert set(re.findall(r"import_module\(([^)]*)\)", door)) <= {'"mimetic"'}


def test_files_and_functions_stay_short():
    long = []
    for folder in ("native", "tests", "evaluation", "blender_addon", "scripts", "sample_scenes"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".py", ".cpp", ".hpp") or "wheels" in path.parts:
                continue
            text = path.read_text(encoding="utf-8")
            if (lines := len(text.splitlines())) > LONGEST_FILE:
                long.append(f"{path.relative_to(ROOT)}: {lines} lines")
            if path.suffix == ".py":
                long += [
                    f"{path.relative_to(ROOT)}: {node.name} has {lines} lines"
                    for node in ast.walk(ast.parse(text))
                    if isinstance(node, ast.FunctionDef)
                    and (lines := node.end_lineno - node.lineno + 1) > LONGEST_FUNCTION
                ]
    assert long == []
