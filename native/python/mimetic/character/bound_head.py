# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on a character's mesh: it turns about its own head's centre.

*Character* frame: as in `rig_motion`, from midway between the ears. Metres unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic._core import rotation_of
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.character.rig_motion import Channels, carried_channels, mirror, motion
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

EARS_BEHIND = 0.08  # metres, of the middle of a face
AHEAD = 3.0  # weight of where the face looks, against what is up: a character may lie
# Where nothing tells, y is behind and z up, as in Blender, or y up, as in other programs
USUAL = 1e-3 * np.array([[0.0, 0, 0], [0, 0.1, 0.5], [0, 0, 1]])

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class MovedMesh:
    """A mesh, and how much a character's controls move of it; points in the object's frame."""

    points: Floats  # V x 3
    starts: NDArray[np.int32]  # of each polygon among the corners
    corners: NDArray[np.int32]  # vertices
    moved: Floats  # V, not negative


def object_from_character(
    points: ArrayLike, landmarks: Mapping[str, int | ArrayLike], metres_from_object: ArrayLike
) -> Floats:
    """4 x 4: where the head is in an object, and where it faces there, by its landmarks.

    points: V x 3, the object's frame; landmarks: name -> vertex, or place in metres;
    metres_from_object: 4 x 4, as it was for those places.
    """
    points = np.asarray(points, dtype=np.float64)
    matrix = np.asarray(metres_from_object, dtype=np.float64)
    places = [
        matrix[:3, :3] @ points[int(place)] + matrix[:3, 3] if place.ndim == 0 else place
        for place in (np.asarray(landmarks[name]) for name in REQUIRED)
    ]
    template = load_template()
    usual = template.vertices[[template.landmark(name) for name in REQUIRED]]
    return _core.object_from_character(usual, np.array(places, dtype=np.float64), matrix)


def world_from_motion(mesh: MovedMesh, world_from_object: ArrayLike, units: float = 1.0) -> Floats:
    """4 x 4: where a head rests in the world, and where it faces, by what its own controls move.

    world_from_object: 4 x 4, as the object stands; units: of the world, per metre. A mesh's y may
    be up in an object that stands turned, so that the character's axes are those of the object's,
    either way round, of which one is most nearly up and one looks as the face does. A mirrored
    object holds a face still: its left is where its right was.
    """
    matrix = np.asarray(world_from_object, dtype=np.float64)
    linear, ears = matrix[:3, :3], EARS_BEHIND * units
    side = mirror(linear)
    points = mesh.points @ linear.T + matrix[:3, 3]
    areas = _core.polygon_areas(points, mesh.starts.tolist(), mesh.corners.tolist())
    moved = mesh.moved if mesh.moved.any() else np.ones(len(points))
    centre = _middle(points, areas * moved)
    is_near = ((points - centre) ** 2).sum(axis=1) < (2 * ears) ** 2
    # Lids at rest look down, and a jaw is low on its head: the mean of both looks ahead
    looks = _looks(points, mesh, moved) * side[0, 0]
    ahead = _unit(_unit(looks) + _unit(centre - _middle(points, areas * is_near)))
    own = linear / np.maximum(np.sqrt((linear**2).sum(axis=0)), 1e-12)

    def likelihood(turn: Floats) -> float:
        axes = own @ turn
        return float(axes[2, 2] - AHEAD * ahead @ axes[:, 1] + (USUAL * turn).sum())

    axes = own @ max(_quarter_turns(), key=likelihood)
    world_from_character = np.eye(4)
    world_from_character[:3, :3] = rotation_of(axes @ side, "object")
    world_from_character[:3, 3] = centre + ears * world_from_character[:3, 1]
    return world_from_character


def _looks(points: Floats, mesh: MovedMesh, moved: Floats) -> Floats:
    """3: the normal of what moves, by area and motion."""
    if not len(mesh.starts):
        return np.zeros(3)
    following = np.arange(1, len(mesh.corners) + 1)
    following[np.append(mesh.starts[1:], len(mesh.corners)) - 1] = mesh.starts
    corners = points[mesh.corners]
    normals = np.add.reduceat(np.cross(corners, corners[following]), mesh.starts)
    return np.add.reduceat(moved[mesh.corners], mesh.starts) @ normals


def _middle(points: Floats, weights: Floats) -> Floats:
    total = float(weights.sum())
    return weights @ points / total if total > 0 else points.mean(axis=0)


def _unit(vector: Floats) -> Floats:
    return vector / max(float(np.sqrt(vector @ vector)), 1e-12)


def _quarter_turns() -> list[Floats]:
    """The 24 rotations that take axes to axes."""
    signed = [*np.eye(3), *-np.eye(3)]
    return [
        np.column_stack([np.cross(back, up), back, up])
        for back in signed
        for up in signed
        if back @ up == 0
    ]


def head_channels(
    performance: Performance,
    world_from_character: ArrayLike,
    location: ArrayLike,
    rotation: ArrayLike,
    rotation_mode: str,
    units: float = 1.0,
) -> Channels:
    """Curves of an object without parent that move it as the actor's head moves from its rest.

    world_from_character: 4 x 4, where the object's head rests in the world; location: 3, rotation:
    3 x 3, the object's own now; units: of the world, per metre.
    """
    world = np.asarray(world_from_character, dtype=np.float64)
    axes = rotation_of(world[:3, :3], "head")
    # The object's origin goes where a rigid head takes it: it may lie at the feet
    pivot = (np.asarray(location, dtype=np.float64) - world[:3, 3]) @ axes / units
    head_motion = motion(performance, pivot=pivot)
    return carried_channels(head_motion, location, rotation, np.eye(4), axes, rotation_mode, units)
