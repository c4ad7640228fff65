# SPDX-License-Identifier: GPL-3.0-or-later
"""Every name of the Python package that the documents mention can be imported."""

import importlib
import re

import pytest
from manual_pages import ROOT

# Decisions tell what once was
PAGES = [page for page in ROOT.glob("docs/**/*.md") if page.parent.name != "decisions"]
# Of one part alone, as `mimetic.bake`, operators are meant
QUOTED = re.compile(r"`(mimetic(?:\.[A-Za-z_]\w*){2,}|mimetic\.[A-Z]\w*)(?=[`(])")
IMPORTED = re.compile(r"^from (mimetic[\w.]*) import ([\w, ]+)", re.MULTILINE)


def names_of(text: str) -> set[str]:
    names = set(QUOTED.findall(text))
    for module, parts in IMPORTED.findall(text):
        names |= {f"{module}.{part.split(' as ')[0].strip()}" for part in parts.split(",")}
    return names


def is_there(name: str) -> bool:
    """A module, or what one has; a method of its class too."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for part in parts[count:]:
            found = getattr(found, part, None)
        return found is not None
    return False


def test_every_name_of_the_package_on_the_pages_can_be_imported():
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES]
    named = {page: names_of(page.read_text(encoding="utf-8")) for page in pages}
    assert len(set().union(*named.values())) > 10
    wrong = [
        f"{page.relative_to(ROOT)}: {name}"
        for page, names in named.items()
        for name in sorted(names)
        if not is_there(name)
    ]
    assert wrong == []


@pytest.mark.parametrize("name", ["mimetic.Nothing.load", "mimetic.fit.nothing", "mimetic.no.one"])
def test_a_name_that_there_is_not_is_found_out(name):
    assert names_of(f"as `{name}(1)` does") == {name}
    assert not is_there(name)
