# SPDX-License-Identifier: GPL-3.0-or-later
"""Paint the anatomical region of every skin vertex, from the mesh's rings and the landmarks."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .head import PART_NAMES, Cut
from .topology import rings

REGION_NAMES = (
    "forehead",
    "temple",
    "brow",
    "nasal_bridge",
    "nose",
    "eyelid",
    "cheek",
    "zygomatic",
    "upper_lip",
    "lower_lip",
    "chin",
    "jaw_line",
    "neck",
    "scalp",
    "ear",
    "mouth_cavity",
    "eye_socket",
)
# The base mesh has concentric rings round the mouth and the eyes; counted from the cavities' edges.
VERMILION_RINGS = 7
LID_RINGS = 6
# The left ear in the base mesh's texture plane: an ellipse (centre, half axes).
EAR_CENTER_UV = (0.851, 0.630)
EAR_HALF_AXES_UV = (0.0265, 0.0215)
# The head's island ends at this height in the texture plane; the neck's island lies above it.
HEAD_ISLAND_TOP = 0.85
JAW_LINE_WIDTH = 14.0
BROW_HALF_HEIGHT = 6.0


class RegionPainter:
    """Holds the geometry all rules look at, in millimetres from the mid-eye point, |x|."""

    def __init__(self, cut: Cut, vertices: np.ndarray, landmarks: Mapping[str, int]) -> None:
        self._cut = cut
        n = cut.num_skin_vertices
        eyes = [vertices[landmarks[f"eye_{c}.{s}"]] for c in ("inner", "outer") for s in "LR"]
        self._origin = np.mean(eyes, axis=0)
        points = (vertices[:n] - self._origin) * 1000
        self.points = points
        self.x, self.y, self.z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
        self.normal = vertex_normals(vertices, cut.faces[: cut.num_skin_faces])[:n]
        self.skin_corners = cut.faces[: cut.num_skin_faces].ravel()
        self.skin_uv = cut.uv[: cut.num_skin_faces].reshape(-1, 2)
        self._vertices = vertices
        self._landmarks = landmarks
        self.region = np.full(n, REGION_NAMES.index("cheek"), np.int8)

    def at(self, name: str) -> np.ndarray:
        """Landmark in millimetres from the mid-eye point, |x|."""
        point = (self._vertices[self._landmarks[name]] - self._origin) * 1000
        return np.array([abs(point[0]), point[1], point[2]])

    def paint(self, name: str, where: np.ndarray) -> None:
        self.region[where] = REGION_NAMES.index(name)

    def rings_from(self, part: str) -> np.ndarray:
        """Rings of visible faces from the edge of a cavity to each skin vertex, -1 elsewhere."""
        faces, parts = self._cut.faces, self._cut.part
        skin = faces[parts == PART_NAMES.index("skin")]
        edge = np.intersect1d(skin, faces[parts == PART_NAMES.index(part)])
        return rings(skin, edge, self._cut.num_skin_vertices)

    def only_in(self, part: str) -> np.ndarray:
        """Skin vertices that no visible skin face uses, in the given cavity."""
        inside = np.zeros(self._cut.num_skin_vertices, bool)
        inside[np.unique(self._cut.faces[self._cut.part == PART_NAMES.index(part)])] = True
        inside[np.unique(self._cut.faces[self._cut.part == PART_NAMES.index("skin")])] = False
        return inside


def paint_regions(cut: Cut, vertices: np.ndarray, landmarks: Mapping[str, int]) -> np.ndarray:
    """Region index of every skin vertex (Vs,), symmetric."""
    painter = RegionPainter(cut, vertices, landmarks)
    _paint_cranium_and_neck(painter)
    _paint_midface(painter)
    _paint_nose(painter)
    _paint_mouth_and_chin(painter)
    _paint_eyes(painter)
    painter.paint("ear", _ear(painter, cut.mirror))
    painter.paint("mouth_cavity", painter.only_in("mouth_cavity"))
    painter.paint("eye_socket", painter.only_in("eye_socket"))
    region = painter.region
    return np.minimum(region, region[cut.mirror[: cut.num_skin_vertices]])


def _paint_cranium_and_neck(p: RegionPainter) -> None:
    tragus, brow, hairline = p.at("tragus.L"), p.at("brow_outer.L"), p.at("hairline")
    gonion, menton = p.at("gonion.L"), p.at("menton")
    # Hairline: level across the forehead, then down in front of the ear.
    recess = np.clip((p.x - 35) / 30, 0, 1)
    above_hairline = p.y > hairline[1] - 28 * recess**2
    behind_ear = (p.z < tragus[2] + 12) & (p.y > tragus[1] - 15)
    forehead = (p.y > brow[1] - 4) & ~above_hairline
    p.paint("forehead", forehead)
    orbit_edge = brow[0] + 1
    p.paint("temple", (p.y > p.at("zygion.L")[1] + 16) & (p.x > orbit_edge) & ~above_hairline)
    p.paint("scalp", above_hairline | behind_ear)

    # Neck: all under the head's texture island, the floor of the mouth, what lies behind the jaw.
    below_island = np.zeros(len(p.x), bool)
    below_island[p.skin_corners[p.skin_uv[:, 1] > HEAD_ISLAND_TOP]] = True
    floor = (p.normal[:, 1] < -0.6) & (p.y < p.at("mouth_corner.L")[1] - 10) & (p.z < menton[2] + 2)
    behind_jaw = (p.z <= gonion[2] - 3) & (p.y <= tragus[1] - 18)
    p.paint("neck", below_island | floor | behind_jaw)
    neck = p.region == REGION_NAMES.index("neck")
    under_jaw = neck & (p.z > gonion[2] - 8)
    gap = np.linalg.norm(p.points[:, None] - p.points[None, under_jaw], axis=2).min(1)
    p.paint(
        "jaw_line", ~neck & (gap < JAW_LINE_WIDTH) & (p.z > gonion[2] - 6) & (p.y < gonion[1] + 16)
    )


def _paint_midface(p: RegionPainter) -> None:
    zygion, outer = p.at("zygion.L"), p.at("eye_outer.L")
    cheek = p.region == REGION_NAMES.index("cheek")
    # The bone's ridge runs from under the eye's outer corner back to the arch before the ear.
    back = np.clip((outer[2] - p.z) / (outer[2] - zygion[2]), 0, 1)
    ridge = (outer[1] - 22) + back * (zygion[1] + 4 - (outer[1] - 22))
    p.paint("zygomatic", cheek & (p.x > 30) & (np.abs(p.y - ridge) < 14 - 3 * back))


def _paint_nose(p: RegionPainter) -> None:
    nasion, tip, base, ala = (p.at(n) for n in ("nose_bridge", "nose_tip", "nose_base", "ala.L"))
    down = np.clip((nasion[1] - p.y) / (nasion[1] - base[1]), 0, 1)
    root = p.at("eye_inner.L")[0] - 4
    half_width = root + down * (ala[0] + 1.5 - root)
    # The lower edge rises from the septum to the wings' feet.
    edge = base[1] - 0.5 + 3.5 * np.clip(p.x / ala[0], 0, 1)
    on_nose = (
        (p.y < p.at("brow_outer.L")[1] - 4)
        & (p.y > edge)
        & (p.x < half_width)
        & (p.z > ala[2] - 22)
    )
    middle = nasion[1] + 0.5 * (tip[1] - nasion[1])
    p.paint("nasal_bridge", on_nose & (p.y >= middle))
    p.paint("nose", on_nose & (p.y < middle))


def _paint_mouth_and_chin(p: RegionPainter) -> None:
    corner, base, ala = p.at("mouth_corner.L"), p.at("nose_base"), p.at("ala.L")
    lower, menton = p.at("lip_lower"), p.at("menton")
    fold = lower[1] - 4
    on_nose = np.isin(p.region, [REGION_NAMES.index(n) for n in ("nose", "nasal_bridge")])
    # Between the nasolabial folds, which run from the nostril wings past the corners of the mouth.
    fold_x = ala[0] + np.clip((base[1] - p.y) / (base[1] - corner[1]), 0, 1) * (
        corner[0] + 5 - ala[0]
    )
    front = p.z > corner[2] - 8
    p.paint(
        "upper_lip", front & ~on_nose & (p.y <= base[1] + 1) & (p.y > corner[1]) & (p.x < fold_x)
    )
    p.paint("lower_lip", front & (p.y <= corner[1]) & (p.y > fold) & (p.x < corner[0] + 4))
    chin = (p.y <= fold) & (p.y > menton[1] - 1) & (p.x < 21) & (p.z > menton[2] - 6)
    p.paint("chin", chin)

    # The vermilion by rings: heights say nothing where the lips touch.
    ring = p.rings_from("mouth_cavity")
    vermilion = (ring >= 0) & (ring <= VERMILION_RINGS)
    p.paint("upper_lip", vermilion & _upper_lip(p, ring))
    p.paint("lower_lip", vermilion & ~_upper_lip(p, ring))


def _upper_lip(p: RegionPainter, ring: np.ndarray) -> np.ndarray:
    """Vermilion above the slit: told on the outermost ring, handed inwards along the columns."""
    faces = p._cut.faces[p._cut.part == PART_NAMES.index("skin")]
    upper = (ring == VERMILION_RINGS) & (p.y > p.at("mouth_corner.L")[1] - 0.3)
    pairs = np.concatenate([faces[:, [i, (i + 1) % 4]] for i in range(4)])
    for inner in range(VERMILION_RINGS - 1, -1, -1):
        radial = pairs[(ring[pairs[:, 0]] == inner + 1) & (ring[pairs[:, 1]] == inner)]
        upper[radial[:, 1]] |= upper[radial[:, 0]]
    return upper


def _paint_eyes(p: RegionPainter) -> None:
    inner, middle, outer = (p.at(f"brow_{n}.L") for n in ("inner", "middle", "outer"))
    canthus_inner, canthus_outer = p.at("eye_inner.L"), p.at("eye_outer.L")
    arch = np.polyfit(*np.array([inner, middle, outer])[:, :2].T, 2)
    above = p.y - np.polyval(arch, np.clip(p.x, inner[0] - 6, outer[0]))
    beside_nose = p.region != REGION_NAMES.index("nasal_bridge")
    in_front = p.z > canthus_outer[2] - 8
    # The upper lid reaches up to the brow, the lower one as far as the rings that fold.
    under_brow = (above < 0) & (p.y > canthus_outer[1] - 1) & (p.x > canthus_inner[0] - 5)
    ring = p.rings_from("eye_socket")
    near = (ring >= 0) & (ring <= LID_RINGS)
    p.paint("eyelid", near | (under_brow & (p.x < outer[0] + 1) & in_front & beside_nose))
    on_brow = (np.abs(above) < BROW_HALF_HEIGHT) & (p.x > inner[0] - 8) & (p.x < outer[0] + 7)
    p.paint("brow", on_brow & in_front & beside_nose & ~near)


def _ear(p: RegionPainter, mirror: np.ndarray) -> np.ndarray:
    """The ear by its place in the texture plane, where it is unfolded; the right is its mirror."""
    inside = (((p.skin_uv - EAR_CENTER_UV) / EAR_HALF_AXES_UV) ** 2).sum(1) < 1
    left = np.zeros(len(p.x), bool)
    left[p.skin_corners[inside]] = True
    return left | left[mirror[: len(left)]]


def vertex_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Unit normals (V,3), area-weighted; zero where no face is."""
    corner = vertices[faces]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    total = np.zeros_like(vertices)
    np.add.at(total, faces.ravel(), np.repeat(normal, 4, axis=0))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.divide(total, length, out=np.zeros_like(total), where=length > 0)
