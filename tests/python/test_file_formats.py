# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages on file formats name the keys, types, shapes and schemas that the code has."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from mimetic.fit import face_fit, fitted_view, rest_choice, still_cover
from mimetic.library import expression
from mimetic.muscles import calibration
from mimetic.performance import document
from mimetic.puppet import templates
from mimetic.score import truth
from sample_fit import make_fit

DOCS = Path(__file__).resolve().parents[2] / "docs"


def page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def tables(text: str) -> list[list[dict[str, str]]]:
    """The page's tables of keys, each a list of rows: column -> cell."""
    made: list[list[dict[str, str]]] = []
    columns: list[str] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if cells[:1] == ["key"]:
            columns = cells
            made.append([])
        elif columns and cells and not set(cells[0]) <= {"-"}:
            assert len(cells) == len(columns), line
            made[-1].append(dict(zip(columns, cells, strict=True)))
        elif not cells:
            columns = []
    return made


def keys(rows: list[dict[str, str]]) -> list[str]:
    return [row["key"].strip("`") for row in rows]


def test_tables_are_read_as_they_are_written():
    text = "| key | meaning |\n| --- | --- |\n| `a` | x |\n\n| other |\n| --- |\n| b |\n"
    assert tables(text) == [[{"key": "`a`", "meaning": "x"}]]


@pytest.mark.parametrize(
    ("name", "module"),
    [
        ("performance-file.md", document),
        ("truth-file.md", truth),
        ("expression-file.md", expression),
        ("puppet-file.md", templates),
    ],
)
def test_the_page_of_an_array_file_has_the_keys_types_and_shapes_of_the_code(name, module):
    dtypes = {**module.DTYPES, "U": np.str_}
    required, optional = tables(page(name))
    for rows, of_code in ((required[1:], module.REQUIRED), (optional, module.OPTIONAL)):
        written = {
            key: (row["type"], row["shape"]) for key, row in zip(keys(rows), rows, strict=True)
        }
        assert written == {
            key: (np.dtype(dtypes[kind]).name.replace("str", "text"), shape_text(shape))
            for key, (kind, shape) in of_code.items()
        }
    assert keys(required)[0] == "schema" and required[0]["meaning"] == str(module.SCHEMA)


def shape_text(shape: tuple) -> str:
    return " x ".join(map(str, shape))


def test_the_page_of_a_performance_says_its_schema_and_from_when_frames_are_held():
    text = page("performance-file.md")
    assert f"This page is of `schema` {document.SCHEMA}." in text
    assert f"frames under {document.HELD_QUALITY} are held" in text


def test_the_page_of_a_fit_has_the_keys_and_schemas_of_the_code():
    of_fit, of_view, of_calibration, of_rest, of_cover = tables(page("fit-file.md"))
    since = {}
    for row in of_fit:
        number = int(re.match(r"\d+", row["since schema"])[0])
        since[row["key"].strip("`")] = (number, row["since schema"].endswith("may be missing"))
    assert since == {
        **{key: (1, False) for key in face_fit.REQUIRED},
        **{key: (number, True) for key, number in face_fit.OPTIONAL.items()},
    }
    assert keys(of_fit)[0] == "schema" and of_fit[0]["meaning"] == str(face_fit.SCHEMA)
    assert f"This page is of `schema` {face_fit.SCHEMA}." in page("fit-file.md")
    assert keys(of_view) == list(fitted_view.KEYS)
    assert keys(of_calibration) == list(calibration.KEYS)
    regions = ", ".join(calibration.REGIONS)
    assert f"regions {regions}" in of_calibration[0]["meaning"]
    assert all(f"`{why}`" in of_rest[0]["meaning"] for why in rest_choice.TEXTS if why)
    assert f"1 to {still_cover.MOST_CELLS} texts" in of_cover[-1]["shape"]
    assert all(f"`{sign}`" in of_cover[-1]["meaning"] for sign in (still_cover.IN, still_cover.OUT))


def test_a_fit_is_written_with_the_keys_of_the_page(tmp_path):
    make_fit().save(tmp_path / "fit.json")
    written = json.loads((tmp_path / "fit.json").read_text(encoding="utf-8"))
    of_fit, of_view, of_calibration, of_rest, of_cover = tables(page("fit-file.md"))
    assert written.keys() == set(keys(of_fit))
    assert written["views"][0].keys() == set(keys(of_view))
    assert written["calibration"].keys() == set(keys(of_calibration))
    assert written["rest"].keys() == set(keys(of_rest))
    assert written["still_cover"].keys() == set(keys(of_cover))
