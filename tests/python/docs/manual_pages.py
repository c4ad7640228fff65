# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages a reader meets, cut into what the tests of the manual look at."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "CHANGELOG.md",
    *sorted((ROOT / "docs").rglob("*.md")),
]
# Pages that say how Mimetic is; the changelog also says how it was
TRUE_TODAY = [page for page in PAGES if page.name != "CHANGELOG.md"]
GUIDE = sorted((ROOT / "docs" / "guide").glob("*.md"))

LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+(?:\([^()]*\))?)\)")
FENCE = re.compile(r"^(```|    \S)")


@dataclass(frozen=True)
class Link:
    page: Path
    line: int
    text: str
    target: str
    is_picture: bool


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def prose(page: Path) -> str:
    """The page without its blocks of code, line by line as it was."""
    lines, is_code = [], False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            is_code = not is_code
            lines.append("")
        else:
            lines.append("" if is_code else line)
    return "\n".join(lines)


def code_lines(page: Path) -> list[str]:
    """Lines of the page's blocks of code, those that end in a backslash joined to the next."""
    lines, is_code = [], False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            is_code = not is_code
        elif is_code or re.match(r" {4}\S", line):
            if lines and lines[-1].endswith("\\"):
                lines[-1] = lines[-1][:-1] + line.strip()
            else:
                lines.append(line.strip())
    return lines


def code_spans(page: Path) -> list[str]:
    """What stands between single backticks."""
    return [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", prose(page))]


def links(page: Path) -> list[Link]:
    text = re.sub(r"`[^`]*`", lambda span: " " * len(span[0]), prose(page))
    return [
        Link(page, text.count("\n", 0, link.start()) + 1, link[2], link[3], link[1] == "!")
        for link in LINK.finditer(text)
    ]


def anchors(page: Path) -> set[str]:
    """What a heading is called in an address, as GitHub makes it."""
    names: set[str] = set()
    for heading in re.findall(r"^#+ +(.*)$", prose(page), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        name = re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")
        copies = sum(1 for other in names if re.fullmatch(rf"{re.escape(name)}(-\d+)?", other))
        names.add(f"{name}-{copies}" if copies else name)
    return names
