# SPDX-License-Identifier: GPL-3.0-or-later
"""What clang-tidy checked once is checked again as soon as anything it depends on has changed."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "build" / "checks" / "native_tidy.py"


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A core of one source, its header, that header's header and a header of nobody's."""
    spec = importlib.util.spec_from_file_location("native_tidy", SCRIPT)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    native = tmp_path / "native"
    files = {
        ".clang-tidy": "Checks: bugprone-*",
        "native/src/flow/flow.cpp": '#include "flow/rows.hpp"\n#include <vector>\n',
        "native/src/flow/rows.hpp": "#include <mimetic/flow/flow.hpp>\n",
        "native/include/mimetic/flow/flow.hpp": "struct Flow {};\n",
        "native/src/flow/other.hpp": "struct Other {};\n",
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.setattr(script, "ROOT", tmp_path)
    monkeypatch.setattr(script, "INCLUDE_FOLDERS", (native / "include", native / "src"))
    monkeypatch.setattr(script, "version", lambda _: "1")
    yield script, tmp_path
    sys.modules.pop("native_tidy", None)


def state(script, root: Path, command: str = "c++ -O3") -> str:
    script.included.cache_clear()
    return script.state_of(root / "native/src/flow/flow.cpp", command)


@pytest.mark.parametrize(
    "name",
    [
        *(".clang-tidy", "native/src/flow/flow.cpp", "native/src/flow/rows.hpp"),
        "native/include/mimetic/flow/flow.hpp",
    ],
)
def test_a_change_to_what_a_source_depends_on_changes_its_state(checkout, name):
    script, root = checkout
    before = state(script, root)
    with open(root / name, "a") as stream:
        stream.write("// more\n")
    assert state(script, root) != before


def test_other_files_do_not_change_a_sources_state(checkout):
    script, root = checkout
    before = state(script, root)
    (root / "native/src/flow/other.hpp").write_text("struct Another {};\n")
    assert state(script, root) == before


def test_the_command_and_the_version_are_part_of_a_state(checkout, monkeypatch):
    script, root = checkout
    before = state(script, root)
    assert state(script, root, "c++ -O0") != before
    monkeypatch.setattr(script, "version", lambda _: "2")
    assert state(script, root) != before
