# SPDX-License-Identifier: GPL-3.0-or-later
"""What a face needs beyond its muscles, jaw and lids: lips in parts, air, gaze.

They are set by hand; a capture estimates LIP_SHAPES and the gaze alone. Data: data/extras.toml,
with its sources.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import SIDES, Anatomy, AttachedSkin, load_table
from mimetic.muscles.articulators import ARTICULATORS, EyeLids, eye_frames
from mimetic.skin.mesh import SkinMesh, canonical_skin

# Each moves one lip to the slit, or off it where the other pushes
LIP_CLOSING = ("oris_close_upper", "oris_close_lower")
# Of the extras what the lips' edges show: articulators of a capture
LIP_SHAPES = (*LIP_CLOSING, "lip_roll_upper", "lip_roll_lower")


@dataclass(frozen=True)
class Extras:
    """Modes over the whole control mesh; metres, head frame.

    names: E, air_cheek.L and so on; groups: E, what sliders are listed under; modes: E x V x 3,
    displacement at value 1; limits: E x 2.
    """

    names: tuple[str, ...]
    groups: tuple[str, ...]
    modes: NDArray[np.float64]
    limits: NDArray[np.float64]


def extras_table() -> list[dict]:
    """The entries of extras.toml; a paired one stands for two."""
    return load_table("extras.toml")["extra"]


def attach_extras(skin: AttachedSkin) -> Extras:
    """The extras of a person whose skin is attached (`anatomy.attach_skin`)."""
    mesh = skin.mesh
    modes = dict(zip(loading_names(), skin.spread(loading_responses(skin)), strict=True))
    for frame in eye_frames(mesh):
        eye = mesh.template.part_vertices(f"eye.{frame.side}")
        lids = EyeLids(frame)
        for row in gaze_rows():
            gaze, is_pitch = gaze_of(row), row["axis"][0] != 0
            angle = _core.lid_angle(lids, gaze) if is_pitch else None
            mode = np.zeros(mesh.neutral.shape) if angle is None else lids.turn(angle)
            mode[eye] = _core.turned_eye(frame, gaze, mesh.neutral[eye])
            modes[f"{row['name']}.{frame.side}"] = mode
    return collect(modes)


def loading_responses(
    skin: AttachedSkin, names: Sequence[str] | None = None
) -> NDArray[np.float64]:
    """E x S x 3 of the skin's control vertices, of all in `loading_names` or of some."""
    mesh = skin.mesh
    every = dict(zip(loading_names(), place_extras(mesh), strict=True))
    extras = [every[name] for name in names or every]
    stencil_rows = mesh.stencil_rows_at([extra.measured.vertex for extra in extras])
    mouth = _core.MouthFrame(mesh)
    return _core.extra_responses(skin, mesh.surface, mouth, extras, stencil_rows)


def with_lip_shapes(anatomy: Anatomy, skin: AttachedSkin) -> Anatomy:
    """The anatomy with LIP_SHAPES among its articulators."""
    responses = loading_responses(skin, LIP_SHAPES)
    return replace(
        anatomy,
        articulator_names=(*anatomy.articulator_names, *LIP_SHAPES),
        articulator_modes=np.concatenate([anatomy.articulator_modes, skin.spread(responses)]),
        articulator_limits=np.vstack(
            [anatomy.articulator_limits, [row["limits"] for row in lip_rows()]]
        ),
    )


def lip_rows() -> list[dict]:
    """The entries of LIP_SHAPES, in their order."""
    rows = {row["name"]: row for row in extras_table()}
    return [rows[name] for name in LIP_SHAPES]


def articulator_limits() -> dict[str, tuple[float, float]]:
    """Range of the values of all articulators that a capture estimates, by name."""
    limits = extra_limits()
    return ARTICULATORS | {name: limits[name] for name in LIP_SHAPES}


def extra_limits() -> dict[str, tuple[float, float]]:
    """Range of every extra's value, by name."""
    return {
        name: (float(row["limits"][0]), float(row["limits"][1]))
        for row in extras_table()
        for name in entry_names(row)
    }


def collect(modes: dict[str, NDArray[np.float64]]) -> Extras:
    """Modes by name in the table's order, with what it says of them."""
    rows = {name: row for row in extras_table() for name in entry_names(row)}
    return Extras(
        tuple(rows),
        tuple(row["group"] for row in rows.values()),
        np.stack([modes[name] for name in rows]),
        np.array([row["limits"] for row in rows.values()], dtype=np.float64),
    )


def entry_names(row: dict) -> list[str]:
    """One name, or two of a pair."""
    return [f"{row['name']}.{side}" for side in SIDES] if row.get("paired") else [row["name"]]


def gaze_rows() -> list[dict]:
    return [row for row in extras_table() if row["type"] == "gaze"]


def gaze_of(row: dict) -> _core.Gaze:
    """The turn of an eyeball that an entry of the table means."""
    return _core.Gaze(row["axis"], np.radians(row["degrees"]))


def loading_rows() -> list[dict]:
    """Entries that load the skin."""
    return [row for row in extras_table() if row["type"] != "gaze"]


def loading_names() -> list[str]:
    return [name for row in loading_rows() for name in entry_names(row)]


def place_extras(mesh: SkinMesh) -> list[_core.PlacedExtra]:
    """What loads the skin, as in `loading_names`, on a head of the template's mesh."""
    entries = [_entry(row) for row in loading_rows()]
    return _core.place_extras(canonical_skin(mesh.template), mesh, entries)


def _entry(row: dict) -> _core.ExtraEntry:
    place = _core.LandmarkPlace
    return _core.ExtraEntry(
        name=row["name"],
        type=getattr(_core.ExtraType, row["type"]),
        paired=row.get("paired", False),
        upper="upper" in row["name"],
        line=[place(*at) for at in row["line"]],
        forwards=row.get("forwards", 0.0),
        inwards=row.get("inwards", 0.0),
        width=row["width"],
        measured_at=place(*row["measured_at"]),
        excursion=row["excursion_mm"],
    )
