# SPDX-License-Identifier: GPL-3.0-or-later
"""What the texts count and name is what the files hold."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def read(path: str) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


def test_the_validation_says_which_rows_are_of_the_faces_element():
    text = read("docs/measured/skin-validation.md")
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


def test_the_newest_blender_that_is_claimed_runs_all_tests_and_the_oldest_nearly_all():
    script = read("scripts/test")
    tested = sorted(map(minor, re.search(r"^blenders=\((.*)\)", script, re.MULTILINE)[1].split()))
    block = re.search(r"^declare -A left_out=\((.*?)^\)", script, re.MULTILINE | re.DOTALL)[1]
    left_out = {minor(of): marks for of, marks in re.findall(r'\[(\S+)\]="(.*?)"', block)}
    assert left_out.pop(tested[0]) == "newest"
    assert left_out == dict.fromkeys(tested[1:-1], "newest or oldest_and_newest")
    names = [f"{major}.{second}" for major, second in tested]
    manifest = tomllib.loads(read("blender_addon/mimetic/blender_manifest.toml"))
    assert minor(manifest["blender_version_min"]) == tested[0]
    listed = f"{', '.join(names[:-1])} and {names[-1]}"
    assert f"({names[0]} to {names[-1]}; {listed} are tested)" in read("README.md")
    assert f"between Blender {names[0]} and {names[-1]}" in read("blender_addon/mimetic/compat.py")
    assert f"module {listed}," in read("CONTRIBUTING.md")


PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs", "sample_scenes")
SOURCES = ("native", "blender_addon", "evaluation", "scripts", "tests", "sample_scenes")
FOLDERS = "blender_addon|docs|evaluation|native|sample_scenes|scripts|tests"


def pages() -> list[Path]:
    result = [path for name in PAGES for path in [ROOT / name, *(ROOT / name).rglob("*.md")]]
    return [path for path in result if path.suffix == ".md"]


def texts() -> list[Path]:
    """Pages and sources."""
    sources = [path for name in SOURCES for path in (ROOT / name).rglob("*")]
    kinds = (".py", ".cpp", ".hpp", ".toml", ".txt", ".cmake", "")
    kept = [path for path in sources if path.suffix in kinds and path.is_file()]
    return [*pages(), *(path for path in kept if "__pycache__" not in path.parts)]


def test_links_between_pages_lead_somewhere():
    broken = [
        f"{path.relative_to(ROOT)}: {target}"
        for path in pages()
        for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8"))
        if not (path.parent / target).exists()
    ]
    assert broken == []


def test_pages_named_in_texts_and_sources_exist():
    broken = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in texts()
        for name in re.findall(r"\bdocs/[\w/.-]+\.(?:md|png|jpg)", path.read_text(errors="ignore"))
        if not (ROOT / name).exists()
    ]
    assert broken == []


def test_files_and_modules_named_in_pages_exist():
    broken = []
    for path in pages():
        text = path.read_text(encoding="utf-8")
        named = re.findall(rf"`\.?/?((?:{FOLDERS})/[\w/.-]++)(?![<*])", text)
        for dotted in re.findall(r"(?<![\w/])evaluation(?:\.(?!md\b)[a-z_]+)+", text):
            stem = dotted.replace(".", "/")
            named.append(stem if (ROOT / stem).is_dir() else f"{stem}.py")
        named += [f"native/python/{stem}.py" for stem in modules_named(text)]
        broken += [f"{path.relative_to(ROOT)}: {name}" for name in named if not exists(name)]
    assert broken == []


def modules_named(text: str) -> list[str]:
    """`mimetic/fit/fitting` of `mimetic.fit.fitting.refit`; names with capitals are no modules."""
    dotted = re.findall(r"\bmimetic\.[a-z_]+\.[a-z_]+\b(?!/)", text)
    return [name.replace(".", "/") for name in dotted]


def exists(name: str) -> bool:
    return (ROOT / name.rstrip(".")).exists()


def test_python_files_named_in_pages_exist():
    names = {path.name for folder in SOURCES for path in (ROOT / folder).rglob("*.py")}
    broken = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in pages()
        for name in re.findall(r"`(?:[\w/]+/)?(\w+\.py)`", path.read_text(encoding="utf-8"))
        if name not in names
    ]
    assert broken == []
