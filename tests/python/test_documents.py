# SPDX-License-Identifier: GPL-3.0-or-later
"""What the texts count and name is what the files hold."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


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
