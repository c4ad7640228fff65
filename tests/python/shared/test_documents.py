# SPDX-License-Identifier: GPL-3.0-or-later
"""What the texts count and name is what the files hold."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def read(path: str) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


def test_the_validation_says_which_rows_are_of_the_faces_element():
    text = read("docs/validation.md")
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines()]
    cases = [row for row in rows if len(row) > 9 and row[2] in ("skin", "CST + DKT")]
    of_face = [row for row in cases if row[2] == "skin"]
    assert rows[[row[1:2] for row in rows].index(["case"])][3] == "moves the face"
    assert [row[3] for row in cases] == ["yes" if row in of_face else "no" for row in cases]
    assert f"Of the {len(cases)} rows, {len(of_face)} are computed by the element" in text
    assert f"The other {len(cases) - len(of_face)} are computed by a plate element" in text


def minor(version: str) -> tuple[int, int]:
    major, second, *_ = version.split(".")
    return int(major), int(second)


def test_the_oldest_and_the_newest_blender_that_are_claimed_run_all_tests():
    script = read("scripts/test")
    tested = sorted(map(minor, re.search(r"^blenders=\((.*)\)", script, re.MULTILINE)[1].split()))
    whole = set(map(minor, re.search(r'^all_tests="(.*)"', script, re.MULTILINE)[1].split()))
    assert whole == {tested[0], tested[-1]}
    names = [f"{major}.{second}" for major, second in tested]
    manifest = tomllib.loads(read("blender_addon/mimetic/blender_manifest.toml"))
    assert minor(manifest["blender_version_min"]) == tested[0]
    listed = f"{', '.join(names[:-1])} and {names[-1]}"
    assert f"({names[0]} to {names[-1]}; {listed} are tested)" in read("README.md")
    assert f"between Blender {names[0]} and {names[-1]}" in read("blender_addon/mimetic/compat.py")
    assert f"module {listed}," in read("CONTRIBUTING.md")
