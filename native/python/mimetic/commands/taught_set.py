# SPDX-License-Identifier: GPL-3.0-or-later
"""What teaching leaves: the set, its page, and what is said about them."""

from __future__ import annotations

from pathlib import Path

from mimetic.puppet.pages import write_taught_page
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.shown_text import shown

MOST_ADVICE = 3  # lines that are printed


def page_of(out: Path) -> Path:
    return out.with_suffix(".html")


def save_set(taught: TaughtSet, out: Path) -> int:
    """Writes both; returns the exit status. Raises OSError."""
    taught.save(out)
    page = page_of(out)
    lines = write_taught_page(taught, page, out.stem)
    print(
        f"{shown(out)}: {len(taught.looks)} looks, {len(taught.template_parts)} templates, "
        f"{len(taught.example_scores)} examples"
    )
    for line in lines[:MOST_ADVICE]:
        print(f"advice: {shown(line)}")
    print(f"{shown(page)}: the templates, and all advice ({len(lines)} lines)")
    return 0
