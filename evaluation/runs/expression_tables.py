# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of many people's expressions, pooled, as tables and as JSON."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table

from evaluation.runs.bootstrap import r2_interval
from evaluation.runs.deviation import Explained
from evaluation.runs.drift import Drift
from evaluation.runs.expressions import ShownExpression
from evaluation.runs.methods import CHAINED, DIRECT, LOOP, MESH, MUSCLES, OURS, VERTICES

LOOP_MUSCLES = f"{LOOP}, muscles"
IMAGE = (OURS, MUSCLES, LOOP, LOOP_MUSCLES, CHAINED, DIRECT, MESH)
SPACE = (OURS, MUSCLES, LOOP, LOOP_MUSCLES, VERTICES, MESH)
HEADS = {LOOP_MUSCLES: "its muscles"}
CELL = 16
OWN_COLUMNS = {
    "correlation": ("group corr.", ".2f"),
    "pose": ("pose deg", ".2f"),
    "onset": ("onset frames", ".1f"),
    "peak": ("peak frames", ".1f"),
    "delay": ("delay frames", ".1f"),
    "missed": ("missed %", ".0f"),
    "held": ("in 90 %", ".2f"),
    "held, active": ("active in 90 %", ".2f"),
    "pose held": ("pose in 90 %", ".2f"),
    "false": ("largest false", ".2f"),
}
Rows = dict[str, list[ShownExpression]]


def as_text(expressions: list[ShownExpression]) -> str:
    rows = grouped(expressions)
    people = {name: len({one.take for one in ones}) for name, ones in rows.items()}
    people_text = ", ".join(f"{name} {count}" for name, count in people.items())
    tables = [
        f"people: {people_text}",
        _true_motion(rows),
        _table("image motion, R2 beyond the true head's", rows, IMAGE, _image_r2, ".3f"),
        _table("the same of the median person", rows, IMAGE, _median_person, ".3f"),
        _people_table(rows),
        _table("moving points, median px", rows, IMAGE, _image_median, ".2f"),
        _table("surface motion in space, R2", rows, SPACE, _space_r2, ".3f"),
        _table("moving points, median mm", rows, SPACE, _space_median, ".2f"),
    ]
    for method in (OURS, LOOP):
        own = {name: _own(ones, method) for name, ones in rows.items()}
        tables.append(text_table(f"{method}: muscles, head, time", OWN_COLUMNS, own, CELL))
    return "\n\n".join(tables)


def _people_table(rows: Rows) -> str:
    """What the sums above owe to the people who happen to be in them."""
    figures = {
        f"{method} {where}": (method, kind)
        for method, where, kind in (
            (OURS, "image", "image"),
            (MUSCLES, "image", "image"),
            (OURS, "space", "space"),
        )
    }
    columns, values = {}, {name: {} for name in rows}
    for title, (method, kind) in figures.items():
        for end in ("from", "to"):
            columns[f"{title} {end}"] = (title if end == "from" else end, ".3f")
        for name, ones in rows.items():
            low, high = _interval(ones, method, kind)
            values[name] |= {f"{title} from": low, f"{title} to": high}
    title = "R2 for nine in ten samples of as many people"
    return text_table(title, columns, values, CELL)


def _interval(ones: list[ShownExpression], method: str, where: str) -> tuple[float, float]:
    by_person: dict[str, list[Explained]] = {}
    for one in ones:
        if method in getattr(one, where):
            by_person.setdefault(one.take, []).append(getattr(one, where)[method])
    return r2_interval(by_person)


def _true_motion(rows: Rows) -> str:
    columns = {"px": ("px rms", ".2f"), "mm": ("mm rms", ".2f")}
    values = {
        name: {
            "px": _pooled(ones, OURS, "image").rms_motion,
            "mm": _pooled(ones, OURS, "space").rms_motion,
        }
        for name, ones in rows.items()
    }
    return text_table("motion beyond the true head's", columns, values, CELL)


def grouped(expressions: list[ShownExpression]) -> Rows:
    """By expression, by what moves the face, by how the head moves, and all."""
    rows: Rows = {}
    for one in expressions:
        rows.setdefault(one.expression, []).append(one)
    for one in expressions:
        rows.setdefault({"units": "by face units", "muscles": "by muscles"}[one.kind], []).append(
            one
        )
    for one in expressions:
        rows.setdefault(f"head {one.head}", []).append(one)
    rows["all"] = expressions
    return rows


def drift_text(drifts: dict[str, Drift]) -> str:
    columns = {
        "activation": ("activation", ".3f"),
        "degrees": ("degrees", ".2f"),
        "left_over": ("left at rest", ".3f"),
    }
    rows = {name: vars(drift) for name, drift in drifts.items()}
    return text_table("drift in 1000 frames, returning to rest", columns, rows)


def as_json(expressions: list[ShownExpression], drifts: dict[str, Drift]) -> str:
    """Pooled figures by row and method; what is undefined is null."""
    tables: dict[str, dict] = {}
    for name, ones in grouped(expressions).items():
        tables[name] = {"people": len({one.take for one in ones})}
        for method in dict.fromkeys((*IMAGE, *SPACE)):
            tables[name][method] = {
                "image_r2": _image_r2(ones, method),
                "image_r2_interval": list(_interval(ones, method, "image")),
                "surface_r2_interval": list(_interval(ones, method, "space")),
                "image_r2_median_person": _median_person(ones, method),
                "image_median_px": _image_median(ones, method),
                "surface_r2": _space_r2(ones, method),
                "surface_median_mm": _space_median(ones, method),
                **_own(ones, method),
            }
    takes = {
        f"{one.take}, {one.expression}": {
            method: {"image_r2": share.r2} for method, share in one.image.items()
        }
        for one in expressions
    }
    document = {"pooled": tables, "takes": takes, "drift": {k: vars(v) for k, v in drifts.items()}}
    return json_text(document)


def _table(title: str, rows: Rows, methods: tuple[str, ...], figure: Callable, style: str) -> str:
    columns = {method: (HEADS.get(method, method), style) for method in methods}
    values = {
        name: {method: figure(ones, method) for method in methods} for name, ones in rows.items()
    }
    return text_table(title, columns, values, CELL)


def _pooled(ones: list[ShownExpression], method: str, where: str) -> Explained:
    return Explained.all_of(
        getattr(one, where)[method] for one in ones if method in getattr(one, where)
    )


def _image_r2(ones: list[ShownExpression], method: str) -> float:
    return _pooled(ones, method, "image").r2


def _median_person(ones: list[ShownExpression], method: str) -> float:
    shares = [one.image[method].r2 for one in ones if method in one.image]
    return float(np.median(shares)) if shares else math.nan


def _image_median(ones: list[ShownExpression], method: str) -> float:
    return _pooled(ones, method, "image").median


def _space_r2(ones: list[ShownExpression], method: str) -> float:
    return _pooled(ones, method, "space").r2


def _space_median(ones: list[ShownExpression], method: str) -> float:
    return _pooled(ones, method, "space").median


def _own(ones: list[ShownExpression], method: str) -> dict[str, float]:
    """Medians of what varies by group, means of shares and of pose errors, the largest false."""

    def values(name: str) -> np.ndarray:
        lists = [one.figures.get(f"{method}: {name}", []) for one in ones]
        return np.array([value for row in lists for value in row], float)

    def known(name: str, of: Callable) -> float:
        numbers = values(name)
        numbers = numbers[np.isfinite(numbers)]
        return float(of(numbers)) if len(numbers) else math.nan

    cells = {name: known(name, np.median) for name in ("correlation", "onset", "peak", "delay")}
    cells |= {name: known(name, np.mean) for name in ("pose", "held", "held, active", "pose held")}
    onsets = values("onset")
    cells["missed"] = 100 * float(np.isnan(onsets).mean()) if len(onsets) else math.nan
    cells["false"] = known("false", np.max)
    return cells
