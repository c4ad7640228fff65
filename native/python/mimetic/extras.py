# SPDX-License-Identifier: GPL-3.0-or-later
"""What a face needs beyond its 36 muscles, jaw and lids: lips in parts, air, gaze.

They are set by hand and not estimated by capture. Data: data/extras.toml, with its sources.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mimetic.anatomy import SIDES, AttachedSkin, load_table
from mimetic.articulators import eye_frames, part_vertices, rotate
from mimetic.skin_mesh import SkinMesh, find_place, multiply

LINE_SPACING = 0.0015  # of the points that stand for a line, m
FOOTPRINT_LIMIT = 3  # standard deviations
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


def attach_extras(skin: AttachedSkin) -> Extras:
    """The extras of a person whose skin is attached (`anatomy.attach_skin`)."""
    mesh = skin.mesh
    canonical = SkinMesh(
        mesh.template, np.ascontiguousarray(mesh.template.vertices, dtype=np.float64)
    )
    names, groups, limits, modes, loaded = [], [], [], [], []
    for row in extras_table():
        for side in SIDES if row.get("paired") else ("",):
            names.append(f"{row['name']}.{side}" if side else row["name"])
            groups.append(row["group"])
            limits.append(row["limits"])
            if row["type"] == "gaze":
                modes.append(turned_eye(mesh, row, side))
            else:
                loaded.append((len(modes), row, side))
                modes.append(np.zeros_like(mesh.neutral))
    forces = np.stack([skin_forces(canonical, mesh, row, side) for _, row, side in loaded])
    responses = skin.respond(forces)
    for (at, row, side), mode in zip(loaded, skin.spread(responses), strict=True):
        modes[at] = mode * strength(canonical, mesh, row, side, mode)
    return Extras(tuple(names), tuple(groups), np.stack(modes), np.array(limits, dtype=np.float64))


def turned_eye(mesh: SkinMesh, row: dict, side: str) -> NDArray[np.float64]:
    """V x 3: the eyeball of a side turned by its whole angle."""
    frame = eye_frames(mesh)[SIDES.index(side)]
    axis = np.asarray(row["axis"], dtype=np.float64)
    if side == "R":
        axis = axis * -MIRROR  # an axis is a pseudovector
    eye = part_vertices(mesh, f"eye.{side}")
    mode = np.zeros_like(mesh.neutral)
    points = mesh.neutral[eye]
    mode[eye] = rotate(points, frame.centre, axis, np.radians(row["degrees"])) - points
    return mode


def skin_forces(canonical: SkinMesh, mesh: SkinMesh, row: dict, side: str) -> NDArray[np.float64]:
    """N x 3 nodal forces of one entry at some strength; side is empty if both share it."""
    line, scale = line_points(canonical, mesh, row, side)
    width = 1e-3 * row["width"] * scale
    distance = mesh.surface.distances(line, FOOTPRINT_LIMIT * width)
    areas = vertex_areas(mesh)
    weight = np.where(np.isfinite(distance), areas * np.exp(-0.5 * (distance / width) ** 2), 0)
    weight /= weight.sum()
    if row["type"] == "pressure":
        return weight[:, None] * mesh.surface.normals
    if row["type"] == "push":
        return weight[:, None] * push_direction(mesh, row)
    return roll_forces(mesh, line, weight, upper="upper" in row["name"])


def push_direction(mesh: SkinMesh, row: dict) -> NDArray[np.float64]:
    """N x 3: forwards, and to the height of the slit between the lips; unit at most."""
    slit = slit_middle(mesh)
    to_slit = slit[1] - mesh.vertices[:, 1]
    inwards = np.clip(to_slit / (0.003 * mesh.size), -1, 1)  # fades where the lips meet
    direction = np.zeros_like(mesh.vertices)
    direction[:, 1] = row["inwards"] * inwards
    direction[:, 2] = row["forwards"]
    return direction / np.hypot(row["inwards"], row["forwards"])


def roll_forces(mesh: SkinMesh, line, weight, *, upper: bool) -> NDArray[np.float64]:
    """A couple about each piece of the lip: free edge forward, outer border back.

    Forces stand across the lip's arm from its axis; what they add up to is taken off, so that the
    lip turns and is not pushed.
    """
    order = np.argsort(line[:, 0])
    axis_at = np.column_stack(
        [np.interp(mesh.vertices[:, 0], line[order, 0], line[order, k]) for k in range(3)]
    )
    depth = np.array([0.0, 0.0, 0.003 * mesh.size])  # the lip's core lies under its skin
    arm = (mesh.vertices - axis_at + depth) * [0.0, 1.0, 1.0]
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


def vertex_areas(mesh: SkinMesh) -> NDArray[np.float64]:
    """N: a third of the outer triangles at each refined vertex, m^2."""
    triangles = mesh.triangles[mesh.triangle_part == "skin"]
    a, b, c = (mesh.vertices[triangles[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(triangles.ravel(), np.repeat(third, 3), minlength=len(mesh.vertices))


def strength(canonical: SkinMesh, mesh: SkinMesh, row: dict, side: str, mode) -> float:
    """What gives the entry its excursion, in proportion to the person; mode: V x 3 at 1."""
    anchor, x, y = row["measured_at"]
    place = find_place(canonical, anchor, x, y, 0, side or SIDES[0])
    moved = multiply(mesh.stencils, mode[: int(mesh.template.num_skin_vertices)])[place.vertex]
    return 1e-3 * row["excursion_mm"] * place.scale(mesh) / float(np.linalg.norm(moved))
