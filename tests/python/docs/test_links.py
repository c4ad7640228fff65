# SPDX-License-Identifier: GPL-3.0-or-later
"""Every link of the pages leads somewhere; every picture is there, and is shown."""

import re

import pytest
from manual_pages import (
    GUIDE,
    PAGES,
    ROOT,
    TRUE_TODAY,
    Link,
    anchors,
    code_spans,
    links,
    name_of,
    prose,
)

PICTURES = ROOT / "docs" / "images"
# Where a page may name a file from: the checkout, its stages, what the reader is in
ROOTS = [
    ROOT,
    *(ROOT / "native" / folder for folder in ("python/mimetic", "src", "include/mimetic")),
    ROOT / "native" / "python",
    ROOT / "native",
    ROOT / "blender_addon" / "mimetic",
    ROOT / "scripts" / "build",
    ROOT / "docs",
]
SOURCE = re.compile(r"[\w.]+(/[\w.]+)+\.(py|cpp|hpp|toml|md|sh)")


def trouble(link: Link) -> str:
    """What is wrong with a link, or nothing."""
    target, _, anchor = link.target.partition("#")
    if re.match(r"[a-z]+:", target):
        good = re.fullmatch(r"https://[\w.-]+\.[a-z]{2,}(/[^\s]*)?", target)
        return "" if good else "no https address"
    page = (link.page.parent / target).resolve() if target else link.page
    if not page.exists():
        return "leads nowhere"
    if ROOT not in page.parents:
        return "leads out of the checkout"
    if anchor and anchor not in anchors(page):
        return f"has no heading of that name: {', '.join(sorted(anchors(page)))}"
    return ""


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page):
    wrong = [
        f"line {link.line}: {link.target}: {trouble(link)}" for link in links(page) if trouble(link)
    ]
    assert wrong == []


def test_a_link_that_leads_nowhere_is_noticed(tmp_path):
    page = GUIDE[0]
    for target in ("no-such-page.md", "#no-such-heading", "http://example.org", "../../../.."):
        assert trouble(Link(page, 1, "", target, False)), target


@pytest.mark.parametrize("page", TRUE_TODAY, ids=name_of)
def test_files_that_a_page_names_are_there(page):
    spans = [span for span in code_spans(page) if SOURCE.fullmatch(span)]
    spans += re.findall(r"\bdocs/[\w/.-]+\.md\b", prose(page))
    parents = (page.parent, *ROOTS)
    assert [span for span in spans if not any((root / span).exists() for root in parents)] == []


def test_every_picture_is_shown_on_a_page_with_words_for_it():
    shown = [link for page in PAGES for link in links(page) if link.is_picture]
    assert [link.target for link in shown if len(link.text) < 10] == []
    targets = {(link.page.parent / link.target).resolve() for link in shown}
    assert {path for path in PICTURES.rglob("*.*")} - targets == set()


def test_every_page_of_the_guide_is_in_its_index():
    index = ROOT / "docs" / "guide" / "README.md"
    targets = {(index.parent / link.target.split("#")[0]).resolve() for link in links(index)}
    assert set(GUIDE) - targets - {index} == set()


def test_every_page_can_be_reached_from_the_readme():
    reached, waiting = set(), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached or page.suffix != ".md":
            continue
        reached.add(page)
        waiting += [(page.parent / link.target.split("#")[0]).resolve() for link in links(page)]
        waiting += [ROOT / name for name in re.findall(r"\bdocs/[\w/.-]+\.md\b", prose(page))]
        # A folder that is linked shows its pages
        for folder in [path for path in waiting if path.is_dir()]:
            waiting += folder.glob("*.md")
    assert set(PAGES) - reached == {ROOT / "CHANGELOG.md"}
