# SPDX-License-Identifier: GPL-3.0-or-later
"""What a face needs beyond its 36 muscles, jaw and lids: lips in parts, air, gaze.

They are set by hand and not estimated by capture. Data: data/extras.toml, with its sources.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import SIDES, AttachedSkin, load_table
from mimetic.muscles.articulators import EyeFrame, EyeLids, eye_frames, part_vertices, rotate
from mimetic.skin.mesh import Place, SkinMesh, find_place

LINE_SPACING = 0.0015  # of the points that stand for a line, m
FOOTPRINT_LIMIT = 3  # standard deviations
# Of the eye's turn up and down, at the middle of the upper and the lower lid. The upper one goes
# nearly as far as the eye (Becker and Fuchs 1988, J. Neurophysiology 60); the shares are assumed.
LID_FOLLOWS = (0.8, 0.3)
MIRROR = np.array([-1.0, 1.0, 1.0])


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


@dataclass(frozen=True)
class LoadedSkin:
    """The skin that forces of extras act on; a person's own or a foreign head's.

    vertices: N x 3; triangles: those of the outer skin; slit: the middle between the lips.
    """

    vertices: NDArray[np.float64]
    surface: _core.MuscleSurface
    triangles: NDArray[np.int32]
    slit: NDArray[np.float64]
    size: float  # times as long as the template

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        return thirds_of_areas(self.vertices, self.triangles)


def vertex_areas(mesh: SkinMesh) -> NDArray[np.float64]:
    """N: a third of the outer triangles at each refined vertex, m^2."""
    return thirds_of_areas(mesh.vertices, mesh.triangles[mesh.triangle_part == "skin"])


def thirds_of_areas(vertices: NDArray[np.float64], triangles) -> NDArray[np.float64]:
    """N: a third of the triangles at each vertex, m^2."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(triangles.ravel(), np.repeat(third, 3), minlength=len(vertices))


def attach_extras(skin: AttachedSkin) -> Extras:
    """The extras of a person whose skin is attached (`anatomy.attach_skin`)."""
    mesh = skin.mesh
    outer = mesh.triangles[mesh.triangle_part == "skin"]
    loaded = LoadedSkin(mesh.vertices, mesh.surface, outer, slit_middle(mesh), mesh.size)
    indptr, indices, weights = mesh.stencils

    def moved_at(place: Place, response: NDArray[np.float64]) -> NDArray[np.float64]:
        own = slice(indptr[place.vertex], indptr[place.vertex + 1])
        return weights[own] @ response[indices[own]]

    modes = loaded_modes(mesh, loaded, skin.respond, lambda points: points, moved_at)
    modes = dict(zip(modes, skin.spread(np.stack(list(modes.values()))), strict=True))
    for frame in eye_frames(mesh):
        eye = part_vertices(mesh, f"eye.{frame.side}")
        lids = EyeLids(frame)
        for row in gaze_rows():
            mode = (
                lids.turn(lid_angle(lids, row)) if row["axis"][0] else np.zeros_like(mesh.neutral)
            )
            mode[eye] = turned_eye(frame, row, mesh.neutral[eye])
            modes[f"{row['name']}.{frame.side}"] = mode
    return collect(modes)


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


def loaded_modes(
    mesh: SkinMesh,
    loaded: LoadedSkin,
    respond: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    onto: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    moved_at: Callable[[Place, NDArray[np.float64]], NDArray[np.float64]],
) -> dict[str, NDArray[np.float64]]:
    """By name, the responses of a skin at value 1 of what pushes, rolls or presses it.

    mesh: the template's, on which the table's places are found; respond: M x N x 3 newtons to
    displacements of any points; onto: places on the mesh to those on the loaded skin; moved_at: the
    motion (3) of a place in one of the responses.
    """
    canonical = SkinMesh(
        mesh.template, np.ascontiguousarray(mesh.template.vertices, dtype=np.float64)
    )
    entries = [
        (name, row, name[-1] if row.get("paired") else "")
        for row in extras_table()
        if row["type"] != "gaze"
        for name in entry_names(row)
    ]
    forces = []
    for _, row, side in entries:
        line, scale = line_points(canonical, mesh, row, side)
        forces.append(skin_forces(loaded, row, onto(line), 1e-3 * row["width"] * scale))
    modes = {}
    for (name, row, side), response in zip(entries, respond(np.stack(forces)), strict=True):
        anchor, x, y = row["measured_at"]
        place = find_place(canonical, anchor, x, y, 0, side or SIDES[0])
        moved = np.linalg.norm(moved_at(place, response))
        if not moved > 0:
            raise _core.InvalidInput(
                f"the skin where {row['name']} is measured, by {anchor}, does not move: the mesh "
                "ends there, or that landmark is out of place"
            )
        modes[name] = response * (1e-3 * row["excursion_mm"] * place.scale(mesh) / moved)
    return modes


def turned_eye(frame: EyeFrame, row: dict, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """K x 3: displacement of points of an eyeball turned by its whole angle."""
    axis = np.asarray(row["axis"], dtype=np.float64)
    if frame.side == "R":
        axis = axis * -MIRROR  # an axis is a pseudovector
    return rotate(points, frame.centre, axis, np.radians(row["degrees"])) - points


def lid_angle(lids: EyeLids, row: dict) -> NDArray[np.float64]:
    """S: how far the skin about an eye turns with the lids as the eye looks up or down."""
    gaze = row["axis"][0] * np.radians(row["degrees"])  # positive: down, as lids turn
    upper, lower = lids.angles()
    return LID_FOLLOWS[0] * gaze * _even(upper) + LID_FOLLOWS[1] * gaze * _even(-lower)


def _even(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """1 where a lid turns furthest."""
    return angle / np.abs(angle).max()


def skin_forces(
    skin: LoadedSkin, row: dict, line: NDArray[np.float64], width: float
) -> NDArray[np.float64]:
    """N x 3 nodal forces of one entry at some strength; line: K points on the skin; width: m."""
    distance = skin.surface.distances(line, FOOTPRINT_LIMIT * width)
    weight = np.where(np.isfinite(distance), skin.areas * np.exp(-0.5 * (distance / width) ** 2), 0)
    weight /= weight.sum()
    if row["type"] == "pressure":
        return weight[:, None] * skin.surface.normals
    if row["type"] == "push":
        return weight[:, None] * push_direction(skin, row)
    return roll_forces(skin, line, weight, upper="upper" in row["name"])


def push_direction(skin: LoadedSkin, row: dict) -> NDArray[np.float64]:
    """N x 3: forwards, and to the height of the slit between the lips; unit at most."""
    to_slit = skin.slit[1] - skin.vertices[:, 1]
    inwards = np.clip(to_slit / (0.003 * skin.size), -1, 1)  # fades where the lips meet
    direction = np.zeros_like(skin.vertices)
    direction[:, 1] = row["inwards"] * inwards
    direction[:, 2] = row["forwards"]
    return direction / np.hypot(row["inwards"], row["forwards"])


def roll_forces(skin: LoadedSkin, line, weight, *, upper: bool) -> NDArray[np.float64]:
    """A couple about each piece of the lip: free edge forward, outer border back.

    Forces stand across the lip's arm from its axis; what they add up to is taken off, so that the
    lip turns and is not pushed.
    """
    order = np.argsort(line[:, 0])
    axis_at = np.column_stack(
        [np.interp(skin.vertices[:, 0], line[order, 0], line[order, k]) for k in range(3)]
    )
    depth = np.array([0.0, 0.0, 0.003 * skin.size])  # the lip's core lies under its skin
    arm = (skin.vertices - axis_at + depth) * [0.0, 1.0, 1.0]
    turn = np.array([-1.0 if upper else 1.0, 0.0, 0.0])
    forces = weight[:, None] * np.cross(turn, arm)
    return forces - weight[:, None] * forces.sum(axis=0) / weight.sum()


def slit_middle(mesh: SkinMesh) -> NDArray[np.float64]:
    inner = [mesh.landmark(f"lip_{lip}_inner") for lip in ("upper", "lower")]
    return mesh.neutral[inner].mean(axis=0)


def line_points(canonical: SkinMesh, mesh: SkinMesh, row: dict, side: str):
    """K x 3: the entry's line on a person, densely, on both sides if it is not a pair's; and how
    many times as long as on the template lengths are along it."""
    points, scales = [], []
    for s in [side] if side else SIDES:
        places = [find_place(canonical, *place, s) for place in row["line"]]
        points.append(dense([place.position(mesh) for place in places]))
        scales += [place.scale(mesh) for place in places]
    return np.concatenate(points), float(np.mean(scales))


def dense(corners: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Points along straight pieces."""
    points = [corners[0]]
    for start, end in pairwise(corners):
        count = max(1, int(np.ceil(np.linalg.norm(end - start) / LINE_SPACING)))
        points += [start + (end - start) * k / count for k in range(1, count + 1)]
    return np.stack(points)
