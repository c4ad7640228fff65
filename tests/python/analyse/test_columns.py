# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of written tables stand in the manual, with their intervals where they have some."""

import csv
import re
from pathlib import Path

import pytest
from mimetic.analyse.motion_fields import COLUMNS
from mimetic.commands.cli import main
from mimetic.template.face_template import load_template
from test_comparison import moved_by
from test_timing_scores import smiling

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guide"
ENDS = ("_lower", "_upper")


def header(path):
    with open(path, newline="") as stream:
        return next(csv.reader(stream))


def named(page, start):
    """Columns of the table that begins so, and those of them that have an interval."""
    table = page[page.index(start) :].split("\n\n")[0]
    first = "".join(line.rsplit("|", 2)[0] for line in table.splitlines(keepends=True))
    found = re.findall(r"`(\w+)`( ±)?", first)
    return {name for name, _ in found}, {name for name, mark in found if mark}


@pytest.fixture(scope="module")
def analysed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("analysed")
    smiling().save(folder / "performance.npz")
    assert main(["analyse", str(folder / "performance.npz"), "--out", str(folder / "out")]) == 0
    return folder / "out"


@pytest.mark.parametrize("name", ["phases", "delays", "smiles"])
def test_the_page_of_timing_names_each_column_and_its_interval(analysed, name):
    columns = header(analysed / f"{name}.csv")
    page = (GUIDE / "timing.md").read_text(encoding="utf-8")
    told, with_interval = named(page, f"| `{name}.csv` | a row")
    assert {column for column in columns if not column.endswith(ENDS)} <= told
    assert with_interval == {c.removesuffix("_lower") for c in columns if c.endswith("_lower")}


def test_the_rise_of_a_smile_is_called_as_in_the_table_of_phases(analysed):
    assert "rise_seconds" in header(analysed / "phases.csv")
    assert header(analysed / "smiles.csv")[1] == "rise_seconds"


def test_the_page_of_comparisons_names_each_column(tmp_path):
    moved_by(load_template(), "AU12").save(tmp_path / "performance.npz")
    out = tmp_path / "out"
    assert main(["compare", str(tmp_path / "performance.npz"), "--out", str(out)]) == 0
    page = (GUIDE / "comparison.md").read_text(encoding="utf-8")
    table = page[page.index("| file | column |") :].split("\n\n")[0]
    rows = dict(re.findall(r"\| `(\w+)\.csv` (.*?)(?=\n\| `\w+\.csv`|\Z)", table, re.DOTALL))
    assert set(rows) == {path.stem for path in out.glob("*.csv")} | {"motion"}
    for name, text in rows.items():
        columns = COLUMNS if name == "motion" else header(out / f"{name}.csv")
        assert [column for column in columns if f"`{column}`" not in text] == [], name


def test_the_tables_of_followed_points_are_told():
    page = (GUIDE / "commands.md").read_text(encoding="utf-8")
    assert "first line x,y" in page
    assert all(key in page for key in ("tracks (N frames", "visible (N x K)", "on_face (K)"))
