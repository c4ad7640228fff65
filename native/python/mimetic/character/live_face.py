# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over a face whose shapes are set by hand: muscles in their places, skin's strain.

Arrays are in the object's frame (`placement`), metres, float32, as a graphics card takes
them; colours are sRGB with opacity.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput
from mimetic.character.muscle_lines import MuscleLines
from mimetic.character.placement import to_head, to_object
from mimetic.character.shapes import group_name
from mimetic.character.strain_map import LIFT, StrainMap, strain_colours
from mimetic.muscles.articulators import JAW
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import load_template

GROUP_COLOURS = {
    1: (0.95, 0.35, 0.25),
    2: (0.98, 0.72, 0.20),
    3: (0.55, 0.80, 0.25),
    4: (0.20, 0.78, 0.62),
    5: (0.30, 0.62, 0.98),
    6: (0.62, 0.45, 0.98),
    7: (0.95, 0.42, 0.80),
}
QUIET_WIDTH, FULL_WIDTH, NUM_WIDTHS = 2.0, 7.0, 8  # pixels
QUIET_LIGHT, QUIET_OPACITY = 0.75, 0.85
NODE_RADIUS = 0.0011
OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]])
OCTAHEDRON_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)


@dataclass(frozen=True)
class Pose:
    """A shape of the face, and the values of its sliders."""

    refined: NDArray[np.float64]  # N x 3, head frame
    normals: NDArray[np.float64]  # N x 3, unit
    activations: NDArray[np.float64]  # M, own value and those of its groups
    jaw: NDArray[np.float64]  # 3


@dataclass(frozen=True)
class Strokes:
    """K lines of one width: points 2K x 3 in pairs, colours 2K x 4."""

    width: float  # pixels
    points: NDArray[np.float32]
    colours: NDArray[np.float32]


@dataclass(frozen=True)
class Patch:
    """Triangles T x 3 of vertices N x 3 with colours N x 4."""

    points: NDArray[np.float32]
    colours: NDArray[np.float32]
    triangles: NDArray[np.int32]


def template_rest(rest_points: ArrayLike) -> NDArray[np.float64]:
    """Points of the object's frame (V x 3) in the head frame; InvalidInput if of another mesh."""
    template = load_template()
    rest = np.asarray(rest_points, dtype=np.float64)
    if rest.shape != template.vertices.shape or not np.isfinite(rest).all():
        raise InvalidInput(
            f"the face has {len(rest)} vertices, known are the muscles of the head with "
            f"{len(template.vertices)}"
        )
    return to_head(rest)


class LiveFace:
    """A face of the template's mesh at rest.

    rest_points: V x 3, object frame. Raises InvalidInput if that is another mesh.
    """

    def __init__(self, rest_points: ArrayLike):
        self._neutral = template_rest(rest_points)
        self._template = load_template()

    @cached_property
    def _lines(self) -> MuscleLines:
        return MuscleLines(self._mesh)

    @cached_property
    def _mesh(self) -> SkinMesh:
        return SkinMesh(self._template, np.ascontiguousarray(self._neutral))

    @cached_property
    def _strain(self) -> StrainMap:
        return StrainMap(self._mesh)

    @property
    def muscle_names(self) -> list[str]:
        return self._lines.names

    def pose(
        self,
        moves: Iterable[tuple[float, NDArray, NDArray]],
        values: Mapping[str, float],
    ) -> Pose:
        """The shape that sliders give.

        moves: value, points and points at value 0 (V x 3 each) of every shape that is not at 0;
        values: of all sliders by name.
        """
        offset = np.zeros(self._neutral.shape)
        for value, points, start in moves:
            offset += value * (np.asarray(points, dtype=np.float64) - start)
        shape = self._neutral + to_head(offset)
        skin = np.ascontiguousarray(shape[: self._template.num_skin_vertices])
        return Pose(
            self._mesh.refinement.positions(skin),
            self._mesh.refinement.normals(skin),
            self._activations(values),
            np.array([values.get(name, 0.0) for name in JAW]),
        )

    def _activations(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        values_by_muscle = []
        for name, group in zip(self._lines.names, self._lines.groups, strict=True):
            side = name[name.rfind(".") :]
            own = (name, group_name(int(group), side), group_name(int(group)))
            values_by_muscle.append(sum(values.get(slider, 0.0) for slider in own))
        return np.array(values_by_muscle)

    def strokes(self, pose: Pose) -> list[Strokes]:
        """Lines of all muscles, coloured by group, the wider and brighter the more active."""
        lines = self._lines
        level = np.clip(pose.activations, 0, 1)[lines.muscle]
        points = to_object(lines.positions(pose.refined, pose.jaw))
        pairs = np.repeat(points, 2, axis=1)[:, 1:-1].astype(np.float32)
        colours = self._colours(lines.muscle, level)
        step = np.round(level * (NUM_WIDTHS - 1)).astype(int)
        strokes = []
        for number in np.unique(step):
            is_at_step = step == number
            width = QUIET_WIDTH + (FULL_WIDTH - QUIET_WIDTH) * number / (NUM_WIDTHS - 1)
            point_colours = np.repeat(colours[is_at_step], pairs.shape[1], axis=0)
            strokes.append(Strokes(width, pairs[is_at_step].reshape(-1, 3), point_colours))
        return strokes

    def nodes(self, pose: Pose) -> Patch:
        """Insertions as small bodies: their size is one on the face, not on the screen."""
        lines = self._lines
        centres = to_object(lines.node_positions(pose.refined))
        points = centres[:, None] + NODE_RADIUS * OCTAHEDRON
        level = np.clip(pose.activations, 0, 1)[lines.node_muscle]
        colours = self._colours(lines.node_muscle, np.maximum(level, 0.6))
        first = len(OCTAHEDRON) * np.arange(len(centres))[:, None, None]
        return Patch(
            points.reshape(-1, 3).astype(np.float32),
            np.repeat(colours, len(OCTAHEDRON), axis=0),
            (first + OCTAHEDRON_FACES).reshape(-1, 3).astype(np.int32),
        )

    def _colours(
        self, muscle: NDArray[np.int64], level: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        groups = np.array([GROUP_COLOURS[int(group)] for group in self._lines.groups])
        light = QUIET_LIGHT + (1 - QUIET_LIGHT) * level[:, None]
        opacity = QUIET_OPACITY + (1 - QUIET_OPACITY) * level[:, None]
        return np.hstack([groups[muscle] * light, opacity]).astype(np.float32)

    def strain(self, pose: Pose, measure: str) -> NDArray[np.float64]:
        """N strains at the refined skin's vertices: area, stretch or compression."""
        return self._strain.measure(pose.refined, measure)

    def strain_range(self, strain: NDArray[np.float64]) -> tuple[float, float]:
        """Smallest and largest on the outer skin."""
        outer = strain[np.unique(self._strain.triangles)]
        return float(outer.min()), float(outer.max())

    def strain_patch(self, pose: Pose, strain: NDArray[np.float64], limit: float) -> Patch:
        """The skin in the colours of its strain."""
        return Patch(
            to_object(pose.refined + LIFT * pose.normals).astype(np.float32),
            strain_colours(strain, limit),
            self._strain.triangles,
        )
