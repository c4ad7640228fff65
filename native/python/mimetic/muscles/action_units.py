# SPDX-License-Identifier: GPL-3.0-or-later
"""Action units of FACS on the canonical mesh, to compare with: animation before muscles."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.template.face_template import FaceTemplate

OFF_THE_FACE = ("neck", "scalp", "ear", "mouth_cavity", "eye_socket")
PLACE_RADIUS = 0.016  # metres
UNSIDED = ("AU26",)  # jaws drop as a whole
SIDE_MARGIN = 0.012  # metres aside of the middle where a unit of one side has all of its motion
HIGHEST = 2.0  # intensity of a slider: 1 is CANDIDE's full, and real faces go beyond


@dataclass(frozen=True)
class ActionUnit:
    """An action unit on one person's mesh of V vertices."""

    name: str
    meaning: str
    group: int  # of muscles that do the same, 1 to 7; 0 where none do
    course: str  # of articulators that do it then, one of `timing.COURSES`; "" where muscles do
    mode: NDArray[np.float64]  # V x 3, metres at intensity 1, head frame
    reach: NDArray[np.float64]  # V, 0 to 1, above 0 where it moves skin


def unit_names() -> list[str]:
    """AU1, AU2 and so on, as they may be asked for."""
    return list(unit_meanings())


def unit_meanings() -> dict[str, str]:
    """What each unit does, by its name."""
    entries = (*_table()["unit"], *_table()["sum"])
    return {entry["name"]: entry["meaning"] for entry in entries}


def action_unit(name: str, neutral: NDArray[np.float64], template: FaceTemplate) -> ActionUnit:
    """A unit on a person's neutral vertices (V x 3); raises InvalidInput if there is none such."""
    table = _table()
    entries = {entry["name"]: entry for entry in (*table["unit"], *table["sum"])}
    unit_name = name.upper() if name.upper().startswith("AU") else f"AU{name}"
    if unit_name not in entries:
        raise InvalidInput(f"{name} is no action unit that is known: {', '.join(entries)}")
    check_mesh(neutral, template)
    warp = _warp(neutral, template)
    is_skin = is_face(template)
    entry = entries[unit_name]
    shares = entry.get("shares", {unit_name: 1.0})
    mode = np.zeros_like(neutral)
    reach = np.zeros(len(neutral))
    for part, share in shares.items():
        rows = np.array(_both_sides(entries[part]["points"]))
        places = warp(rows[:, :3])
        radius = table["radius"] * table["unit_metres"]
        displacements = rows[:, 3:] * table["unit_metres"]
        mode += share * _core.displacement_about(neutral, is_skin, places, displacements, radius)
        reach = np.maximum(reach, _core.nearness_to(neutral, is_skin, places, radius))
    done_by = entry.get("group", 0), entry.get("course", "")
    return ActionUnit(unit_name, entry["meaning"], *done_by, mode, reach)


def unit_sides(
    neutral: NDArray[np.float64], template: FaceTemplate
) -> dict[str, NDArray[np.float64]]:
    """Modes (V x 3, metres at intensity 1) of AU1.L, AU1.R and so on; of AU26, the jaw's, as one.

    The two sides of a unit add up to it. Raises InvalidInput on another mesh than the canonical.
    """
    check_mesh(neutral, template)
    left = _core.left_share(neutral, SIDE_MARGIN)[:, None]
    modes = {}
    for name in unit_names():
        mode = action_unit(name, neutral, template).mode
        if name in UNSIDED:
            modes[name] = mode
        else:
            modes |= {f"{name}.L": left * mode, f"{name}.R": (1 - left) * mode}
    return modes


def named_places(
    neutral: NDArray[np.float64], template: FaceTemplate
) -> dict[str, NDArray[np.float64]]:
    """How much each vertex belongs to the places that the paper's text names: V each, 0 to 1."""
    warp, is_skin = _warp(neutral, template), is_face(template)
    return {
        entry["name"]: _core.nearness_to(
            neutral,
            is_skin,
            warp(np.array(_both_sides([[*entry["at"], 0, 0, 0]]))[:, :3]),
            PLACE_RADIUS,
        )
        for entry in _table()["place"]
    }


def is_face(template: FaceTemplate) -> list[bool]:
    """Which of the mesh's V vertices are skin of the face."""
    count = len(template.vertices)
    flags = np.zeros(count, dtype=bool)
    flags[: template.num_skin_vertices] = ~template.in_region(*OFF_THE_FACE)
    return flags.tolist()


def check_mesh(neutral: NDArray[np.float64], template: FaceTemplate) -> None:
    """Raises InvalidInput unless the vertices are the canonical head's."""
    if neutral.shape != template.vertices.shape:
        raise InvalidInput(
            f"the mesh has {len(neutral)} vertices, the canonical head {len(template.vertices)}: "
            "action units are known on that one alone; capture the footage again"
        )


def _warp(neutral: NDArray[np.float64], template: FaceTemplate) -> _core.PointWarp:
    places, at = [], []
    for anchor in _table()["anchors"]:
        x, y, z = anchor["at"]
        sides = ((".L", 1), (".R", -1)) if x else (("", 1),)
        for suffix, sign in sides:
            places.append(neutral[template.landmark(f"{anchor['landmark']}{suffix}")])
            at.append((sign * x, y, z))
    return _core.PointWarp(np.array(at, dtype=np.float64), np.array(places))


def _both_sides(rows: Sequence[Sequence[float]]) -> list[list[float]]:
    """Points (x, y, z, dx, dy, dz) of both sides from those of the left."""
    right = [[-x, y, z, -dx, dy, dz] for x, y, z, dx, dy, dz in rows if x]
    return [*(list(map(float, row)) for row in rows), *right]


@cache
def _table() -> dict[str, Any]:
    path = resources.files("mimetic") / "data" / "action_units.toml"
    return tomllib.loads(path.read_text(encoding="utf-8"))
