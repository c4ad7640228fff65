# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures for print, as PNG and SVG, and in a page."""

from __future__ import annotations

import html
import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimetic.report.html import STYLE
from mimetic.report.plots import picture_uri
from mimetic.shared.shown_text import shown
from mimetic.shared.whole_file import whole_file

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure

INK, SOFT = "#1d2429", "#8a949a"
GROUP_COLOURS = {
    1: "#1b7f79",
    2: "#d1495b",
    3: "#b7791f",
    4: "#5b5f97",
    5: "#3f7d3a",
    6: "#8d5524",
    7: "#2b6cb0",
}
DPI = 200


def new_figure(
    rows: int, cols: int, size: tuple[float, float], sharex: bool = True
) -> tuple[Figure, np.ndarray]:
    """A figure of so many inches with rows x cols panels."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    style: Any = {"font.size": 8, "axes.spines.top": False, "axes.spines.right": False}
    with rc_context(style):
        figure = Figure(figsize=size, layout="constrained")
        return figure, figure.subplots(rows, cols, sharex=sharex, squeeze=False)


def write_figure(figure: Figure, folder: Path, name: str) -> bytes:
    """NAME.png and NAME.svg, each whole or not at all; the PNG's bytes. Raises OSError."""
    from matplotlib import rc_context

    pictures = {}
    for kind in ("png", "svg"):
        stream = io.BytesIO()
        with rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
            figure.savefig(stream, format=kind, dpi=DPI, metadata=_metadata(kind))
        pictures[kind] = stream.getvalue()
        with whole_file(folder / f"{name}.{kind}") as file:
            file.write(pictures[kind])
    return pictures["png"]


def _metadata(kind: str) -> dict[str, None]:
    return {"Date": None} if kind == "svg" else {}


def page(title: str, lead: str, parts: Iterable[str]) -> str:
    """An HTML page that needs nothing else."""
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        f"<title>{text(title)}</title><style>{STYLE}</style></head><body>"
        f"<h1>{text(title)}</h1><p class='lead'>{text(lead)}</p>{''.join(parts)}</body></html>\n"
    )


def section(heading: str, *parts: str) -> str:
    return f"<h2>{text(heading)}</h2>{''.join(parts)}"


def paragraph(words: str, kind: str = "") -> str:
    return f"<p class='{kind}'>{text(words)}</p>" if kind else f"<p>{text(words)}</p>"


def picture(png: bytes, label: str) -> str:
    return f"<img class='plot' alt='{text(label)}' src='{picture_uri('png', png)}'>"


def table(header: list[str], rows: list[list[str]]) -> str:
    head = "".join(f"<th>{text(cell)}</th>" for cell in header)
    body = "".join(
        "<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{head}</tr>{body}</table>"


def text(words: str) -> str:
    """Text that may come from a file, escaped for HTML."""
    return html.escape(shown(words))
