# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole heads made of the fetched mask (`scripts/fetch_foreign_face`): slits, eyes, skull, shape.

The mask is a sealed surface of 468 vertices. Mouth and lids are cut open; eyeballs, the inside of
the mouth and a skull are added; each person's proportions are changed by smooth warps of our own:
no identity mode of the estimator's template takes part.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from evaluation.anatomy.mesh_file import read_mesh
from evaluation.synthetic.characters import FETCHED

# Rings of the mask's vertices, from corner to corner and back.
EYES = {
    "L": (263, 249, 390, 373, 374, 380, 381, 382, 362, 398, 384, 385, 386, 387, 388, 466),
    "R": (33, 7, 163, 144, 145, 153, 154, 155, 133, 173, 157, 158, 159, 160, 161, 246),
}
UPPER_LIDS = {"L": (385, 386, 387), "R": (158, 159, 160)}
LIPS = (78, 95, 88, 178, 87, 14, 317, 402, 318, 324)
LIPS += (308, 415, 310, 311, 312, 13, 82, 81, 80, 191)
LANDMARKS = {
    **{"nose_tip": 4, "nose_base": 2, "lip_upper": 0, "lip_lower": 17, "chin": 199, "menton": 152},
    **{"ala.L": 358, "ala.R": 129, "zygion.L": 352, "zygion.R": 123, "tragus.L": 454},
    **{"tragus.R": 234, "mouth_corner.L": 291, "mouth_corner.R": 61, "eye_inner.L": 362},
    **{"eye_inner.R": 133, "eye_outer.L": 263, "eye_outer.R": 33, "lid_upper.L": 386},
    **{"lid_upper.R": 159, "lid_lower.L": 374, "lid_lower.R": 145, "brow_inner.L": 285},
    **{"brow_inner.R": 55, "brow_middle.L": 282, "brow_middle.R": 52, "brow_outer.L": 276},
    **{"brow_outer.R": 46, "hairline": 10},
}
PARTS = ("skin", "scalp", "eye_socket", "mouth_cavity", "eye.L", "eye.R")
ORIGIN = (0.0, 0.005, -0.045)  # between the ears, in the mask's frame, metres
EYE_RADIUS = 0.0125
SKULL = (0.080, 0.108, 0.088)  # half axes of the back of the head
SKULL_RINGS = 7
LIP_GAP = 0.0004


@dataclass(frozen=True)
class HeadMesh:
    """Triangles of a head at rest; the mask's own vertices come first."""

    vertices: NDArray[np.float64]  # V x 3, metres, head frame
    triangles: NDArray[np.int64]  # F x 3
    part: NDArray[np.int64]  # F, index into PARTS
    eye_centers: dict[str, NDArray[np.float64]]
    num_mask: int

    def landmarks(self) -> dict[str, NDArray[np.float64]]:
        places = {name: self.vertices[vertex] for name, vertex in LANDMARKS.items()}
        places["hairline"] = places["hairline"] + (0, 0.012, -0.006)
        return places

    def uv(self) -> NDArray[np.float64]:
        """F x 3 x 2: turned about the spine and up, of every corner."""
        corners = self.vertices[self.triangles]
        across = np.arctan2(corners[..., 0], corners[..., 2] + 0.02)
        # A triangle behind the head, where the turn starts anew, is hidden by hair of one colour.
        spread = np.ptp(across, axis=1, keepdims=True) > np.pi
        across = np.where(spread & (across < 0), across + 2 * np.pi, across)
        for part in ("eye.L", "eye.R"):
            chosen = self.part == PARTS.index(part)
            across[chosen] = corners[chosen][..., 0]
        return np.stack([across, corners[..., 1]], axis=2)


def person(seed: int) -> HeadMesh:
    """The head of a person of this family."""
    mask, triangles = read_mask()
    return _whole(_warped(mask, seed), triangles)


def read_mask() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (468,3) in metres and triangles without those that seal lips and lids.

    Raises OSError where it has not been fetched.
    """
    path = FETCHED / "face.obj"
    if not path.is_file():
        raise FileNotFoundError(f"{path}: scripts/fetch_foreign_face fetches it")
    vertices, faces = read_mesh(path)
    triangles = np.asarray(faces)[:, :3].astype(np.int64)
    for ring in (*EYES.values(), LIPS):
        triangles = triangles[~np.isin(triangles, ring).all(1)]
    return vertices / 100 - ORIGIN, triangles


def _warped(mask: NDArray, seed: int) -> NDArray[np.float64]:
    """Proportions of one person: widths, lengths, depths, and what no such word names."""
    rng = np.random.default_rng([seed, 71])
    at = {name: mask[vertex] for name, vertex in LANDMARKS.items()}
    places = mask.copy()
    low = _smooth((at["nose_base"][1] - mask[:, 1]) / 0.05)
    places[:, 0] *= 1 + 0.05 * rng.normal() + 0.06 * rng.normal() * low
    below = np.minimum(0, mask[:, 1] - at["nose_tip"][1])
    places[:, 1] += 0.07 * rng.normal() * below
    places[:, 1] += 0.06 * rng.normal() * np.maximum(0, mask[:, 1] - at["brow_middle.L"][1])
    places[:, 2] *= 1 + 0.06 * rng.normal()
    middle_lips = (at["lip_upper"] + at["lip_lower"]) / 2
    features = [  # where, how wide, how far it goes (s.d.)
        (at["nose_tip"], 0.014, (0, 0.002, 0.003)),
        (at["nose_tip"] + (0, 0.02, -0.005), 0.012, (0, 0, 0.002)),
        (at["chin"], 0.018, (0, 0.002, 0.0035)),
        (middle_lips, 0.016, (0, 0.0015, 0.002)),
        *((at[f"{name}.{s}"], w, d) for s in "LR" for name, w, d in _PAIRS),
    ]
    for place, width, spread in features:
        sign = np.array([np.sign(place[0]) or 1, 1, 1])
        side = int(1e4 * abs(place[0]) + 1e4 * abs(place[1]))  # alike left and right
        drawn = np.random.default_rng([seed, 72, side]).normal(size=3) * spread * sign
        places += _near(mask, place, width)[:, None] * drawn
    for center in mask[rng.choice(len(mask), 20)]:
        places += _near(mask, center, 0.022)[:, None] * rng.normal(0, 0.0008, 3)
    for ring in UPPER_LIDS.values():  # the mask looks sleepy
        places[list(ring), 1] += 0.0015
    half = len(LIPS) // 2
    for lower, upper in zip(LIPS[1:half], LIPS[:half:-1], strict=True):  # and its lips are parted
        middle = places[[lower, upper], 1].mean()
        places[lower, 1], places[upper, 1] = middle - LIP_GAP / 2, middle + LIP_GAP / 2
    return places


_PAIRS = (
    ("brow_middle", 0.016, (0, 0.0025, 0.002)),
    ("zygion", 0.022, (0.002, 0, 0.003)),
    ("mouth_corner", 0.013, (0.002, 0.0008, 0.001)),
    ("ala", 0.008, (0.0012, 0, 0.001)),
    ("eye_outer", 0.016, (0.0012, 0.001, 0.001)),
)


def _whole(mask: NDArray, triangles: NDArray) -> HeadMesh:
    """The mask with a skull, sockets, eyeballs and the inside of the mouth."""
    vertices, faces, parts = [mask], [triangles], [np.zeros(len(triangles), np.int64)]

    def add(more: NDArray, new_faces: NDArray, part: str) -> None:
        vertices.append(more)
        faces.append(new_faces)
        parts.append(np.full(len(new_faces), PARTS.index(part)))

    def count() -> int:
        return sum(len(some) for some in vertices)

    ring = _outline(triangles)
    add(*_lofted(ring, _skull_rings(mask[ring]), count()), "scalp")
    centers = {}
    for side, eye in EYES.items():
        edge = mask[list(eye)]
        middle = edge.mean(0)
        front = mask[[eye[4], eye[12]], 2].max()
        centers[side] = np.array([middle[0], middle[1], front - 0.0005 - EYE_RADIUS])
        inner = [middle + (edge - middle) * (0.9, 0.9, 1) - (0, 0, 0.006)]
        inner.append(middle + (edge - middle) * 0.3 - (0, 0, 0.02))
        add(*_lofted(np.array(eye), inner, count()), "eye_socket")
        add(*_sphere(centers[side], count()), f"eye.{side}")
    lips = mask[list(LIPS)]
    middle = lips.mean(0)
    grown = [
        middle + (lips - middle) * (0.97, 1.1, 1) - (0, 0, 0.004),
        middle + (lips - middle) * (0.9, 3.0, 1) - (0, 0, 0.010),
        middle + (lips - middle) * (0.5, 1.0, 1) - (0, 0, 0.035),
    ]
    add(*_lofted(np.array(LIPS), grown, count()), "mouth_cavity")
    return HeadMesh(
        np.concatenate(vertices),
        np.concatenate(faces),
        np.concatenate(parts),
        centers,
        len(mask),
    )


def _outline(triangles: NDArray) -> NDArray[np.int64]:
    """The mask's outer ring of vertices in order, by its 36 edges that one triangle has."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    directed = {(int(a), int(b)) for a, b in edges}
    follows = {a: b for a, b in directed if (b, a) not in directed}
    ring = [LANDMARKS["hairline"]]
    while (after := follows[ring[-1]]) != ring[0]:
        ring.append(after)
    return np.array(ring)


def _skull_rings(edge: NDArray) -> list[NDArray[np.float64]]:
    """Rings from the mask's outline backward to one point."""
    center = np.array([0.0, 0.02, np.quantile(edge[:, 2], 0.2)])
    angle = np.arctan2(edge[:, 1] - center[1], edge[:, 0])
    rings = []
    for number in range(1, SKULL_RINGS + 1):
        turn = np.pi / 2 * number / SKULL_RINGS
        oval = np.stack(
            [
                SKULL[0] * np.cos(angle) * np.cos(turn),
                SKULL[1] * np.sin(angle) * np.cos(turn),
                np.full(len(edge), -SKULL[2] * np.sin(turn)),
            ],
            axis=1,
        )
        share = np.clip(1.6 * number / SKULL_RINGS, 0, 1)
        kept = center + (edge - center) * (1, 1, 1 - number / SKULL_RINGS)
        rings.append((1 - share) * kept + share * (center + oval))
    return rings


def _lofted(ring: NDArray, inner: list[NDArray], start: int) -> tuple[NDArray, NDArray]:
    """New vertices and triangles between a ring of old vertices and rings of new ones."""
    size = len(ring)
    rows = [ring, *(np.arange(size) + start + size * k for k in range(len(inner)))]
    faces = []
    for outer, row in pairwise(rows):
        after, row_after = np.roll(outer, -1), np.roll(row, -1)
        faces += [np.stack([after, outer, row], 1), np.stack([after, row, row_after], 1)]
    return np.concatenate(inner), np.concatenate(faces)


def _sphere(center: NDArray, start: int) -> tuple[NDArray, NDArray]:
    """An eyeball, its pole to the front."""
    rings = []
    for tilt in np.linspace(0.02, 0.75 * np.pi, 12):
        turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
        xy = np.sin(tilt) * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        rings.append(center + EYE_RADIUS * np.column_stack([xy, np.full(24, np.cos(tilt))]))
    more, faces = _lofted(np.arange(24) + start, rings[1:], start + 24)
    return np.concatenate([rings[0], more]), faces[:, ::-1]


def _near(points: NDArray, place: NDArray, width: float) -> NDArray[np.float64]:
    return np.exp(-((points - place) ** 2).sum(1) / (2 * width**2))


def _smooth(share: NDArray) -> NDArray[np.float64]:
    share = np.clip(share, 0, 1)
    return share * share * (3 - 2 * share)
