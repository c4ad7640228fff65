# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut the head out of the base mesh: which faces, in which order, as which part, in which frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .neck import cut_neck, fill_throat
from .source import ObjMesh, Source
from .topology import components, rings

INTERPUPILLARY_DISTANCE = 0.063
PART_NAMES = (
    "skin",
    "mouth_cavity",
    "eye_socket",
    "eye.L",
    "eye.R",
    "teeth_upper",
    "teeth_lower",
    "tongue",
    "lashes.L",
    "lashes.R",
)
PART_OF_GROUP = {
    "helper-l-eye": "eye.L",
    "helper-r-eye": "eye.R",
    "helper-upper-teeth": "teeth_upper",
    "helper-lower-teeth": "teeth_lower",
    "helper-tongue": "tongue",
    "helper-l-eyelashes-1": "lashes.L",
    "helper-l-eyelashes-2": "lashes.L",
    "helper-r-eyelashes-1": "lashes.R",
    "helper-r-eyelashes-2": "lashes.R",
}
SKIN_PARTS = 3
# Rings of faces between a socket's texture island and the rear edge of the lid margin.
LID_RIM_RINGS = 3
NEUTRAL_ANCESTRIES = ("african", "asian", "caucasian")
SEXES = ("female", "male")


@dataclass(frozen=True)
class Cut:
    """The kept faces in template numbering.

    `base` (V,2) and `weight` (V,) say where a vertex lies on the base mesh: on the edge between two
    of its vertices, nearer the second the greater the weight.
    """

    base: np.ndarray
    weight: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    part: np.ndarray
    mirror: np.ndarray
    num_skin_vertices: int
    num_skin_faces: int

    def carry(self, field: np.ndarray) -> np.ndarray:
        """Positions or displacements (V,3) from those of the base mesh (19158,3)."""
        weight = self.weight[:, None]
        return (1 - weight) * field[self.base[:, 0]] + weight * field[self.base[:, 1]]

    def part_vertices(self, name: str) -> np.ndarray:
        return np.unique(self.faces[self.part == PART_NAMES.index(name)])


def neutral_base_mesh(source: Source) -> np.ndarray:
    """A young adult of mean sex and ancestry, muscle and weight (19158,3), base-mesh units."""
    folder = "mpfb2/targets/macrodetails"
    vertices = source.mesh.vertices.copy()
    for sex in SEXES:
        body = source.target(
            f"{folder}/universal-{sex}-young-averagemuscle-averageweight.target.gz"
        )
        vertices += body / len(SEXES)
        for ancestry in NEUTRAL_ANCESTRIES:
            face = source.target(f"{folder}/{ancestry}-{sex}-young.target.gz")
            vertices += face / (len(SEXES) * len(NEUTRAL_ANCESTRIES))
    return (vertices + mirrored(vertices, source.mirror)) / 2


def mirrored(field: np.ndarray, mirror: np.ndarray) -> np.ndarray:
    """Positions or displacements (..., V, 3) as seen in a mirror held in the plane x = 0."""
    return field[..., mirror, :] * (-1.0, 1.0, 1.0)


def cut_head(source: Source, neutral: np.ndarray, nose_tip: int) -> Cut:
    """Head and neck with cavities, eyes, teeth, tongue and lashes; skin comes first."""
    mesh = source.mesh
    part = _face_parts(mesh, neutral, nose_tip)
    body = mesh.groups == "body"
    head = part[body] >= 0
    neck = cut_neck(neutral, mesh.faces[body], mesh.face_uv[body], mesh.uv, head)
    columns, rings_down = neck.weight.shape

    # Neck vertices are numbered behind the base mesh's own until everything is put in order.
    number = len(mesh.vertices) + np.arange(columns * rings_down).reshape(columns, rings_down)
    number[:, 0] = neck.edge[:, 0, 0]
    left, right = number[neck.strips[:, 0]], number[neck.strips[:, 1]]
    neck_faces = np.stack([right[:, :-1], left[:, :-1], left[:, 1:], right[:, 1:]], axis=-1)
    along, back = neck.uv[:, :, 0], neck.uv[:, :, 1]
    neck_uv = np.stack([back[:, :-1], along[:, :-1], along[:, 1:], back[:, 1:]], axis=2)
    own = np.arange(len(mesh.vertices))
    whole = _Numbering(
        base=np.concatenate([np.stack([own, own], axis=1), neck.edge.reshape(-1, 2)]),
        weight=np.concatenate([np.zeros(len(own)), neck.weight.ravel()]),
        mirror=np.concatenate([source.mirror, _mirrored_columns(number, source.mirror).ravel()]),
    )
    kept = np.flatnonzero(part >= 0)
    faces = np.concatenate([mesh.faces[kept], neck_faces.reshape(-1, 4)])
    uv = np.concatenate([mesh.uv[mesh.face_uv[kept]], neck_uv.reshape(-1, 4, 2)])
    return _in_order(
        whole, faces, uv, np.concatenate([part[kept], np.zeros(neck_faces[..., 0].size, int)])
    )


@dataclass(frozen=True)
class _Numbering:
    """Base mesh and neck together, before sorting: fields as in `Cut`."""

    base: np.ndarray
    weight: np.ndarray
    mirror: np.ndarray


def _mirrored_columns(number: np.ndarray, mirror: np.ndarray) -> np.ndarray:
    """Partner of every neck vertex (C,K): same ring, column under the mirrored border vertex."""
    column = {int(top): i for i, top in enumerate(number[:, 0])}
    return number[[column[int(mirror[top])] for top in number[:, 0]]]


def _in_order(whole: _Numbering, faces: np.ndarray, uv: np.ndarray, part: np.ndarray) -> Cut:
    """Sort faces by part and number the vertices by first use, so that visible skin comes first."""
    order = np.argsort(part, kind="stable")
    faces, uv, part = faces[order], uv[order], part[order]
    used, first = np.unique(faces, return_index=True)
    used = used[np.lexsort((used, part[first // 4]))]
    place = np.full(len(whole.base), -1)
    place[used] = np.arange(len(used))
    mirror = place[whole.mirror[used]]
    if mirror.min() < 0:
        raise ValueError("the cut is not symmetric")
    skin = part < SKIN_PARTS
    return Cut(
        base=whole.base[used],
        weight=whole.weight[used],
        faces=place[faces],
        uv=uv,
        part=part,
        mirror=mirror,
        num_skin_vertices=int(place[faces[skin]].max()) + 1,
        num_skin_faces=int(skin.sum()),
    )


def _face_parts(mesh: ObjMesh, neutral: np.ndarray, nose_tip: int) -> np.ndarray:
    """Part of every base-mesh face, -1 where dropped; texture islands tell mouth and sockets."""
    part = np.full(len(mesh.faces), -1)
    for group, name in PART_OF_GROUP.items():
        part[mesh.groups == group] = PART_NAMES.index(name)
    body = np.flatnonzero(mesh.groups == "body")
    islands = components(mesh.face_uv[body])
    head = islands == islands[(mesh.faces[body] == nose_tip).any(1)][0]
    part[body[head]] = PART_NAMES.index("skin")
    head_vertices = np.unique(mesh.faces[body[head]])
    for island in np.unique(islands[~head]):
        inside = body[islands == island]
        points = neutral[np.unique(mesh.faces[inside])]
        if points[:, 1].min() < neutral[head_vertices, 1].min():
            continue
        on_midline = abs(points[:, 0].mean()) < 1e-3
        part[inside] = PART_NAMES.index("mouth_cavity" if on_midline else "eye_socket")
    _move_lid_rims_to_sockets(mesh.faces, part)
    throat = fill_throat(mesh.faces[body], part[body] >= 0) & (part[body] < 0)
    part[body[throat]] = PART_NAMES.index("skin")
    return part


def _move_lid_rims_to_sockets(faces: np.ndarray, part: np.ndarray) -> None:
    """The lids' inner faces, up to the margin's rear edge, lie on the eyeball, never seen."""
    skin, socket = PART_NAMES.index("skin"), PART_NAMES.index("eye_socket")
    outer = faces[part == skin]
    ring = rings(outer, np.intersect1d(outer, faces[part == socket]), int(faces.max()) + 1)
    rim = (part == skin) & (ring[faces] >= 0).all(1) & (ring[faces].max(1) <= LID_RIM_RINGS)
    part[rim] = socket


def sphere_center(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre and radius of the sphere nearest to the points (N,3), least squares."""
    system = np.column_stack([2 * points, np.ones(len(points))])
    solution = np.linalg.lstsq(system, (points**2).sum(1), rcond=None)[0]
    return solution[:3], float(np.sqrt(solution[3] + solution[:3] @ solution[:3]))
