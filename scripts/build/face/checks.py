# SPDX-License-Identifier: GPL-3.0-or-later
"""What must hold of the template before it is written: manifold, outward, symmetric."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .head import mirrored
from .source import SourceError
from .topology import boundary_loops, components, directed_edges
from .units import mirror_name

SYMMETRY_TOLERANCE = 1e-6
SMALLEST_FACE = 1e-9


def check_template(template: Mapping[str, np.ndarray]) -> str:
    """One line per fact checked; raises SourceError naming the first that fails."""
    vertices, faces, part = (template[k] for k in ("vertices", "faces", "part"))
    names = template["part_names"].tolist()
    skin = faces[: int(template["num_skin_faces"])]
    report = []
    _demand(
        (part[: len(skin)] < 3).all() and (part[len(skin) :] >= 3).all(), "skin faces come first"
    )
    _demand(skin.max() + 1 == template["num_skin_vertices"], "skin vertices come first")
    _demand(len(np.unique(faces)) == len(vertices), "every vertex is used")

    check_manifold(faces)
    _demand(len(np.unique(components(skin))) == 1, "the skin is in one piece")
    loops = boundary_loops(skin)
    _demand(len(loops) == 1, f"the skin's only boundary is the neck (found {len(loops)})")
    visible = boundary_loops(faces[part == names.index("skin")])
    _demand(len(visible) == 4, f"visible skin ends at neck, eyes and mouth (found {len(visible)})")
    report.append(
        f"{len(vertices)} vertices, {len(faces)} quads, of which skin "
        f"{template['num_skin_vertices']} and {len(skin)}, "
        f"visible skin's loops {sorted(len(loop) for loop in visible)}"
    )

    areas = face_areas(vertices, faces)
    _demand(areas.min() > SMALLEST_FACE, f"face {areas.argmin()} has area {areas.min():.1e} m2")
    closed = [n for n in names if n.startswith("eye.") or n == "tongue"]
    for name in closed:
        _demand(
            signed_volume(vertices, faces[part == names.index(name)]) > 0, f"{name} faces outward"
        )
    _demand(signed_volume(vertices, skin) > 0, "the skin faces outward")
    report.append(f"smallest face {areas.min() * 1e6:.4f} mm2")

    report.append(f"largest asymmetry {check_symmetry(template):.1e} m")
    for key, array in template.items():
        if np.issubdtype(np.asarray(array).dtype, np.floating):
            _demand(bool(np.isfinite(array).all()), f"{key} is finite")
    return "\n".join(report)


def check_manifold(faces: np.ndarray) -> None:
    """Every directed edge once: at most two faces to an edge, and neighbours wind alike."""
    edges, count = np.unique(directed_edges(faces), axis=0, return_counts=True)
    _demand(count.max() == 1, f"edge {edges[count.argmax()].tolist()} winds alike")
    # At a vertex of a manifold all faces form one fan.
    for vertex, fans in enumerate(_fans(faces)):
        _demand(fans == 1, f"vertex {vertex} joins {fans} separate sheets")


def _fans(faces: np.ndarray) -> list[int]:
    """Number of edge-connected groups of faces at each vertex."""
    ahead: list[dict[int, int]] = [{} for _ in range(int(faces.max()) + 1)]
    for face in faces.tolist():
        for i, vertex in enumerate(face):
            ahead[vertex][face[(i + 1) % 4]] = face[(i + 3) % 4]
    counts = []
    for links in ahead:
        starts = set(links) - set(links.values())
        counts.append(max(len(starts), 1) + _closed_fans(links, starts))
    return counts


def _closed_fans(links: dict[int, int], starts: set[int]) -> int:
    """Closed fans beyond the first that `_fans` already counts when a vertex has no open fan."""
    left = dict(links)
    for start in starts:
        while start in left:
            start = left.pop(start)
    cycles = 0
    while left:
        start = next(iter(left))
        while start in left:
            start = left.pop(start)
        cycles += 1
    return cycles if starts else cycles - 1


def check_symmetry(template: Mapping[str, np.ndarray]) -> float:
    """Largest distance between a vertex or mode and its mirror image, metres."""
    mirror, vertices = template["mirror"], template["vertices"]
    _demand(
        np.array_equal(mirror[mirror], np.arange(len(mirror))), "the mirror table is an involution"
    )
    faces = {frozenset(f) for f in template["faces"].tolist()}
    images = {frozenset(f) for f in mirror[template["faces"]].tolist()}
    _demand(faces == images, "mirrored faces are faces")
    worst = float(np.abs(mirrored(vertices, mirror) - vertices).max())

    units = template["unit_names"].tolist()
    partner = [units.index(mirror_name(n)) for n in units]
    modes = template["unit_modes"]
    worst = max(worst, float(np.abs(mirrored(modes[partner], mirror) - modes).max()))
    for name, mode in zip(template["identity_names"], template["identity_modes"], strict=True):
        sign = -1 if name.startswith("asym") else 1
        worst = max(worst, float(np.abs(sign * mirrored(mode, mirror) - mode).max()))
    _demand(worst < SYMMETRY_TOLERANCE, f"the template is symmetric (off by {worst:.1e} m)")
    return worst


def face_areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area of every quad as half the cross product of its diagonals, m2."""
    corner = vertices[faces]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    return np.linalg.norm(normal, axis=1) / 2


def signed_volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Volume enclosed, positive if faces wind outward; a hole is closed through the centroid."""
    corner = vertices[faces] - vertices[np.unique(faces)].mean(0)
    halves = np.concatenate([corner[:, [0, 1, 2]], corner[:, [0, 2, 3]]])
    return float(np.linalg.det(halves).sum() / 6)


def _demand(holds: bool, fact: str) -> None:
    if not holds:
        raise SourceError(f"check failed: {fact}")
