# SPDX-License-Identifier: GPL-3.0-or-later
"""A wheel is built again when something that it holds has changed."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_all_that_is_installed_into_the_wheel_is_watched():
    source = (ROOT / "scripts/build/extension/wheels.py").read_text(encoding="utf-8")
    inputs = next(
        ast.literal_eval(node.value)
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "INPUTS"
    )
    recipe = (ROOT / "native/python/CMakeLists.txt").read_text(encoding="utf-8")
    places = re.findall(r"\$\{PROJECT_SOURCE_DIR\}/([\w./]+)", recipe)
    assert len(places) >= 3
    assert [p for p in places if not any(p == i or p.startswith(f"{i}/") for i in inputs)] == []
