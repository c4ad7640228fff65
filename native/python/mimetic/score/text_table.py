# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures as aligned text."""

from __future__ import annotations

import math
from collections.abc import Mapping


def text_table(
    title: str,
    columns: Mapping[str, tuple[str, str]],
    rows: Mapping[str, Mapping[str, float]],
    cell: int = 14,
) -> str:
    """A line of heads and one for each row; what is not finite or not there is "-".

    columns: head and number format by key; rows: figures by key; cell: letters a column.
    """
    width = max(len(title), *(len(name) for name in rows)) + 2
    lines = [title.ljust(width) + "".join(head.rjust(cell) for head, _ in columns.values())]
    for name, figures in rows.items():
        cells = (
            number_text(figures.get(key, math.nan), style) for key, (_, style) in columns.items()
        )
        lines.append(name.ljust(width) + "".join(text.rjust(cell) for text in cells))
    return "\n".join(lines)


def number_text(value: float, style: str) -> str:
    """ "-" for what is not finite."""
    return format(value, style) if math.isfinite(value) else "-"
