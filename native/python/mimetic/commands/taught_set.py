# SPDX-License-Identifier: GPL-3.0-or-later
"""What teaching leaves: the set, its page, and what is said about them."""

from __future__ import annotations

import os
from pathlib import Path

from mimetic.puppet.pages import write_taught_page
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.counted import counted
from mimetic.shared.results import publish_files, staging
from mimetic.shared.shown_text import shown

MOST_ADVICE = 3  # lines that are printed


def page_of(out: Path) -> Path:
    """Beside the set; where `out` is a link, beside what it names."""
    return (Path(os.path.realpath(out)) if out.is_symlink() else out).with_suffix(".html")


def save_set(taught: TaughtSet, out: Path) -> int:
    """Writes both, which appear together; returns the exit status. Raises OSError."""
    page, target = page_of(out), Path(os.path.realpath(out))
    with staging(target.parent) as folder:
        taught.save(folder / target.name)
        lines = write_taught_page(taught, folder / page.name, out.stem)
        publish_files(folder, target.parent)
    print(
        f"{shown(out)}: {counted(len(taught.looks), 'look')}, "
        f"{counted(len(taught.template_parts), 'template')}, "
        f"{counted(len(taught.example_scores), 'example')}"
    )
    for line in lines[:MOST_ADVICE]:
        print(f"advice: {shown(line)}")
    print(f"{shown(page)}: the templates, and all advice ({counted(len(lines), 'line')})")
    return 0
