# SPDX-License-Identifier: GPL-3.0-or-later
"""Put the face template together: the arrays of `face.npz`, in metres and in the head frame."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .head import (
    INTERPUPILLARY_DISTANCE,
    PART_NAMES,
    Cut,
    cut_head,
    mirrored,
    neutral_base_mesh,
    sphere_center,
)
from .identity import identity_modes
from .regions import REGION_NAMES, paint_regions
from .source import Source
from .teeth import through_base_mesh, with_teeth_near_lips
from .unfold import unfold
from .units import unit_modes

# The hinge axis point lies 13 mm from the tragus on the line to the eye's outer corner and 5 mm
# under it (Beyron's point); the condyles' centres are about 104 mm apart on such a skull.
HINGE_BEFORE_TRAGUS = 0.013
HINGE_UNDER_LINE = 0.005
HINGE_HALF_WIDTH = 0.052


@dataclass(frozen=True)
class Frame:
    """Head frame: `position = (base - origin) * scale`."""

    origin: np.ndarray
    scale: float

    def place(self, base: np.ndarray) -> np.ndarray:
        return (base - self.origin) * self.scale


def read_landmarks(path: Path, cut: Cut) -> dict[str, int]:
    """Landmark name -> template vertex, paired ones with `.L` and `.R`."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    place = {int(b): i for i, b in enumerate(cut.base[:, 0]) if cut.weight[i] == 0}
    landmarks = {name: place[vertex] for name, vertex in table["midline"].items()}
    for name, vertex in table["paired"].items():
        landmarks[f"{name}.L"] = place[vertex]
        landmarks[f"{name}.R"] = int(cut.mirror[place[vertex]])
    return landmarks


def build_template(source: Source) -> dict[str, np.ndarray]:
    """All arrays of `face.npz` by key."""
    table = Path(__file__).with_name("landmarks.toml")
    nose_tip = tomllib.loads(table.read_text(encoding="utf-8"))["midline"]["nose_tip"]
    base = neutral_base_mesh(source)
    cut = cut_head(source, base, nose_tip)
    landmarks = read_landmarks(table, cut)

    placed = cut.carry(base)
    frame = head_frame(placed, cut, landmarks)
    vertices = look_ahead(frame.place(placed), cut)
    vertices = (vertices + mirrored(vertices, cut.mirror)) / 2
    eye_centers, eye_radius = eyeballs(vertices, cut)
    identity = identity_modes(source, cut, vertices, landmarks, frame.scale)
    unit_names, units = unit_modes(source, cut, frame.scale)
    return {
        "vertices": with_teeth_near_lips(through_base_mesh(vertices, cut), cut),
        "faces": cut.faces.astype(np.int32),
        "num_skin_vertices": np.int64(cut.num_skin_vertices),
        "num_skin_faces": np.int64(cut.num_skin_faces),
        "part": cut.part.astype(np.int8),
        "part_names": np.array(PART_NAMES),
        "uv": unfold(vertices, cut).astype(np.float32),
        "mirror": cut.mirror.astype(np.int32),
        "region": paint_regions(cut, vertices, landmarks).astype(np.int8),
        "region_names": np.array(REGION_NAMES),
        "landmark_names": np.array(list(landmarks)),
        "landmark_vertices": np.array(list(landmarks.values()), np.int32),
        "eye_centers": eye_centers,
        "eye_radius": np.float64(eye_radius),
        "jaw_hinge": jaw_hinge(vertices, landmarks),
        "identity_names": np.array(identity.names),
        "identity_modes": through_base_mesh(identity.modes, cut).astype(np.float32),
        "identity_limits": identity.limits,
        "unit_names": np.array(unit_names),
        "unit_modes": through_base_mesh(units, cut).astype(np.float32),
    }


def head_frame(base: np.ndarray, cut: Cut, landmarks: dict[str, int]) -> Frame:
    """Origin midway between the tragi, scale from the distance of the eyeballs' centres."""
    left, right = (sphere_center(base[cut.part_vertices(f"eye.{s}")])[0] for s in "LR")
    origin = (base[landmarks["tragus.L"]] + base[landmarks["tragus.R"]]) / 2
    return Frame(origin, float(INTERPUPILLARY_DISTANCE / np.linalg.norm(left - right)))


def eyeballs(vertices: np.ndarray, cut: Cut) -> tuple[np.ndarray, float]:
    """Centres (2,3), left first, and common radius."""
    left, right = (sphere_center(vertices[cut.part_vertices(f"eye.{s}")]) for s in "LR")
    return np.array([left[0], right[0]]), (left[1] + right[1]) / 2


def look_ahead(vertices: np.ndarray, cut: Cut) -> np.ndarray:
    """Turn the eyes, which diverge by three degrees in the base mesh, straight to the front."""
    turned = vertices.copy()
    for side in "LR":
        own = cut.part_vertices(f"eye.{side}")
        center, _ = sphere_center(vertices[own])
        relative = vertices[own] - center
        # The ring of vertices round the front pole is the iris; its mean is the optical axis.
        iris = relative[:, 2] > relative[:, 2].max() - 0.05 * np.ptp(relative[:, 2])
        axis = relative[iris].mean(0)
        axis /= np.linalg.norm(axis)
        turned[own] = center + relative @ _rotation_between(axis, np.array([0.0, 0.0, 1.0])).T
    return turned


def _rotation_between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Smallest rotation that takes unit vector `start` to unit vector `end` (not opposite)."""
    cross = np.cross(start, end)
    skew = np.array([[0, -cross[2], cross[1]], [cross[2], 0, -cross[0]], [-cross[1], cross[0], 0]])
    return np.eye(3) + skew + skew @ skew / (1 + start @ end)


def jaw_hinge(vertices: np.ndarray, landmarks: dict[str, int]) -> np.ndarray:
    """Centres of the condyles (2,3), left first."""
    tragus, canthus = vertices[landmarks["tragus.L"]], vertices[landmarks["eye_outer.L"]]
    along = (canthus - tragus)[1:] / np.linalg.norm((canthus - tragus)[1:])
    under = np.array([-along[1], along[0]])
    y, z = tragus[1:] + HINGE_BEFORE_TRAGUS * along - HINGE_UNDER_LINE * np.abs(under)
    return np.array([[HINGE_HALF_WIDTH, y, z], [-HINGE_HALF_WIDTH, y, z]])
