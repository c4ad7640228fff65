# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipe for wheels of other systems, which has not been run, names what the build needs."""

import json
import re
import tomllib

from manual_pages import ROOT

WORKFLOW = ROOT / ".github" / "workflows" / "wheels.yml"
MANIFEST = ROOT / "scripts" / "build" / "extension" / "libraries" / "vcpkg.json"


def test_every_library_that_the_build_looks_for_is_in_the_pinned_manifest():
    manifest = json.loads(MANIFEST.read_text(encoding="utf-8"))
    assert re.fullmatch(r"[0-9a-f]{40}", manifest["builtin-baseline"])
    listed = {
        entry if isinstance(entry, str) else entry["name"] for entry in manifest["dependencies"]
    }
    looked_for = (ROOT / "cmake" / "dependencies.cmake").read_text(encoding="utf-8")
    libraries = set(re.findall(r"add_library\(mimetic_(\w+) ", looked_for)) | {"eigen"}
    ports = {"opencv": "opencv4", "cholmod": "suitesparse-cholmod", "eigen": "eigen3"}
    assert {ports.get(library, library) for library in libraries} == listed
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert manifest["version-string"] == project["version"]


def test_the_recipe_is_marked_as_not_run_and_pins_what_it_installs():
    text = WORKFLOW.read_text(encoding="utf-8")
    assert "NOT YET RUN" in text
    page = (ROOT / "docs" / "guide" / "installing.md").read_text(encoding="utf-8")
    assert "has not been run" in " ".join(page.split())
    for line in re.findall(r"pip install ([^\n]*)", text):
        packages = [word for word in line.split() if not word.startswith(("build/", "$", "{", "}"))]
        assert [word for word in packages if "==" not in word and "matrix" not in word] == []
    assert str(MANIFEST.relative_to(ROOT)) in text
    for module in re.search(
        r"foreach\(module ([\w ]+)\)", (ROOT / "cmake/dependencies.cmake").read_text()
    )[1].split():
        assert re.search(rf"for module in [\w ]*\b{module}\b", text), module
    build = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for package in build["build-system"]["requires"]:
        assert package in text
