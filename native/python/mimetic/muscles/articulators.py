# SPDX-License-Identifier: GPL-3.0-or-later
"""What bone and lids do and skin muscles do not: jaw and eyelids as displacement modes.

A mode is the displacement at value 1; a rotation is taken in full there, so that a closed lid
lies on the eye and an open jaw has not grown. Metres, radians, head frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mimetic.skin.mesh import SkinMesh, multiply

ARTICULATORS = {  # value range; jaw_side: positive to the subject's left
    "jaw_open": (0.0, 1.0),
    "jaw_side": (-1.0, 1.0),
    "jaw_thrust": (-0.3, 1.0),
    "lid_upper.L": (-0.4, 1.0),
    "lid_lower.L": (-0.3, 1.0),
    "lid_upper.R": (-0.4, 1.0),
    "lid_lower.R": (-0.3, 1.0),
}
JAW = ("jaw_open", "jaw_side", "jaw_thrust")
JAW_OPENING = np.radians(20)
JAW_GLIDE = np.array([0.0, -0.0015, 0.004])  # the condyle slides down its slope as the jaw opens
JAW_SIDE = 0.007
JAW_THRUST = 0.006
LIP_BLEND = 0.004
CORNER_BLEND = 0.018  # where the lips meet, both hang half on the jaw
CHEEK_BLEND = 0.025
NECK_START = 0.005
NECK_BLEND = 0.030
LOWER_LID_RAISE = 0.003
LID_REACH = 0.013  # from the margin to the fold of the upper lid
LOWER_TARSUS = 0.005  # the lower lid moves as one so far from its margin
LOWER_REACH = 0.020  # and less and less to the lower rim of the orbit, without a fold
CORNER_SHARPNESS = 4.0  # how soon a lid's motion ends where the other lid is nearer


def rotate(points: np.ndarray, centre: np.ndarray, axis: np.ndarray, angle) -> np.ndarray:
    """Points K x 3 turned about an axis (unit) through a centre; angle: one or K."""
    arm = points - centre
    along = np.outer(arm @ axis, axis)
    angle = np.broadcast_to(angle, len(points))[:, None]
    turned = np.cos(angle) * (arm - along) + np.sin(angle) * np.cross(axis, arm)
    return centre + along + turned


def smooth_step(value: np.ndarray) -> np.ndarray:
    """0 below 0, 1 above 1, with no kink."""
    value = np.clip(value, 0, 1)
    return value * value * (3 - 2 * value)


def carried(mesh: SkinMesh, point: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Where a point of the template lies on the person, as seen from the middle of vertices."""
    canonical = np.asarray(mesh.template.vertices)[vertices].mean(axis=0)
    return mesh.neutral[vertices].mean(axis=0) + mesh.size * (point - canonical)


def part_vertices(mesh: SkinMesh, name: str) -> np.ndarray:
    parts = list(mesh.template.part_names)
    return np.unique(mesh.template.faces[mesh.template.part == parts.index(name)])


class Jaw:
    """The mandible: turns about the condyles; what is fixed to it follows."""

    def __init__(self, mesh: SkinMesh):
        self.mesh = mesh
        ears = np.array([mesh.landmark("tragus.L"), mesh.landmark("tragus.R")])
        self.hinge = carried(mesh, np.asarray(mesh.template.jaw_hinge).mean(axis=0), ears)

    @cached_property
    def rigid_vertices(self) -> np.ndarray:
        """Control vertices that are fixed to the bone: lower teeth, tongue."""
        return np.concatenate([part_vertices(self.mesh, p) for p in ("teeth_lower", "tongue")])

    def motion(self, name: str, points: np.ndarray) -> np.ndarray:
        """Displacement of points of the bone, K x 3, at value 1."""
        if name == "jaw_open":
            axis = np.array([1.0, 0.0, 0.0])
            return (
                rotate(points, self.hinge, axis, JAW_OPENING) - points + self.mesh.size * JAW_GLIDE
            )
        if name == "jaw_side":
            # About the condyle of the side it goes to: the chin swings, that condyle stays.
            chin = self.mesh.neutral[self.mesh.landmark("chin")]
            angle = self.mesh.size * JAW_SIDE / (chin[2] - self.hinge[2])
            return rotate(points, self.hinge, np.array([0.0, 1.0, 0.0]), angle) - points
        return np.broadcast_to(
            self.mesh.size * np.array([0.0, -0.1 * JAW_THRUST, JAW_THRUST]), points.shape
        )

    def under_skin(self, name: str) -> np.ndarray:
        """Displacement of the bone under each refined skin vertex, N x 3, at value 1."""
        return self.influence[:, None] * self.motion(name, self.mesh.vertices)

    @cached_property
    def influence(self) -> np.ndarray:
        """0 (skull) to 1 (jaw) for the bone under each refined skin vertex, N."""
        mesh, points = self.mesh, self.mesh.vertices
        corner = self._landmarks("mouth_corner.L", "mouth_corner.R") * [0, 1, 1]
        forward = (corner - self.hinge) / np.linalg.norm(corner - self.hinge)
        below = (points - self.hinge) @ np.cross([1.0, 0.0, 0.0], forward)
        ahead = (points - self.hinge) @ forward / np.linalg.norm(corner - self.hinge)
        # Between the lips the slit parts skull from jaw, in the cheek the change is gradual.
        half_mouth = abs(mesh.neutral[mesh.landmark("mouth_corner.L"), 0])
        aside = smooth_step((np.abs(points[:, 0]) - half_mouth) / (0.02 * mesh.size))
        blend = mesh.size * (LIP_BLEND + (CHEEK_BLEND - LIP_BLEND) * aside)
        slit = self._landmarks("lip_upper_inner", "lip_lower_inner")
        level = (slit - self.hinge) @ np.cross([1.0, 0.0, 0.0], forward) * (1 - aside)
        lip = 1.0 * mesh.in_region("lower_lip") - mesh.in_region("upper_lip")
        corners = mesh.vertices[[mesh.landmark(f"mouth_corner.{side}") for side in ("L", "R")]]
        gap = np.linalg.norm(points[:, None] - corners, axis=2).min(axis=1)
        which_lip = multiply(mesh.stencils, lip) * smooth_step(gap / (CORNER_BLEND * mesh.size))
        value = smooth_step(0.5 + (below - level) / blend + which_lip) * smooth_step(ahead / 0.3)
        # Below the lower edge of the mandible the neck takes over.
        angle, menton = self._landmarks("gonion.L", "gonion.R"), self._landmarks("menton")
        edge = (menton - angle) / np.linalg.norm(menton - angle)
        under = (points - menton) @ np.cross([1.0, 0.0, 0.0], edge)
        return value * smooth_step(1 - (under / mesh.size - NECK_START) / NECK_BLEND)

    def _landmarks(self, *names: str) -> np.ndarray:
        """Mean position of landmarks."""
        return self.mesh.neutral[[self.mesh.landmark(name) for name in names]].mean(axis=0)


@dataclass(frozen=True)
class EyeFrame:
    """One eye: centre, axis through which its lids turn, and the vertices that follow them."""

    mesh: SkinMesh
    side: str

    @cached_property
    def centre(self) -> np.ndarray:
        eye = part_vertices(self.mesh, f"eye.{self.side}")
        index = 0 if self.side == "L" else 1
        return carried(self.mesh, np.asarray(self.mesh.template.eye_centers)[index], eye)

    @cached_property
    def axis(self) -> np.ndarray:
        """From the inner to the outer corner (left eye; the right eye's points inwards): a positive
        angle turns the front of the eye down."""
        inner, outer = (
            self.mesh.neutral[self.mesh.landmark(f"{name}.{self.side}")]
            for name in ("eye_inner", "eye_outer")
        )
        across = outer - inner if self.side == "L" else inner - outer
        across[2] = 0  # corners lie at different depths; lids close straight down
        return across / np.linalg.norm(across)

    @cached_property
    def lash_roots(self) -> tuple[np.ndarray, np.ndarray]:
        """Lash vertices and the vertex of the lid's margin that each follows."""
        lashes = part_vertices(self.mesh, f"lashes.{self.side}")
        margin = self.margin
        gap = self.mesh.neutral[lashes, None] - self.mesh.neutral[None, margin]
        return lashes, margin[np.argmin(np.linalg.norm(gap, axis=2), axis=1)]

    @cached_property
    def margin(self) -> np.ndarray:
        """Control vertices on the edge of this eye's lids."""
        edge = self.mesh.vertices_between("skin", "eye_socket")
        return edge[
            self.mesh.neutral[edge, 0] > 0 if self.side == "L" else self.mesh.neutral[edge, 0] < 0
        ]

    def polar(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position along the axis (m), elevation (radians) and distance from the axis (m)."""
        arm = points - self.centre
        along = arm @ self.axis
        up = np.cross(np.array([0.0, 0.0, 1.0]), self.axis)
        height, front = arm @ up, arm[:, 2]
        return along, np.arctan2(height, front), np.hypot(height, front)


def eye_frames(mesh: SkinMesh) -> tuple[EyeFrame, EyeFrame]:
    return EyeFrame(mesh, "L"), EyeFrame(mesh, "R")


class EyeLids:
    """Upper lid closing onto the lower one, lower lid rising: both turn about the eye."""

    def __init__(self, frame: EyeFrame):
        self.frame = frame
        margin = frame.margin
        along, elevation, _ = frame.polar(frame.mesh.neutral[margin])
        inner, outer = np.argmin(along), np.argmax(along)
        chord = np.interp(along, along[[inner, outer]], elevation[[inner, outer]])
        is_corner = np.isin(np.arange(len(margin)), [inner, outer])
        self.upper = margin[(elevation >= chord) | is_corner]
        self.lower = margin[(elevation < chord) | is_corner]

    def modes(self) -> list[np.ndarray]:
        """Upper and lower lid at value 1, V x 3 each."""
        return [self.turn(angle) for angle in self.angles()]

    def opening(self, along: np.ndarray) -> np.ndarray:
        """Angle between the margins, radians, by the position along the axis; 0 at the corners."""
        angles = []
        for margin in (self.upper, self.lower):
            where, elevation, _ = self.frame.polar(self.frame.mesh.neutral[margin])
            order = np.argsort(where)
            angles.append(np.interp(along, where[order], elevation[order]))
        return np.maximum(angles[0] - angles[1], 0)

    def _raise(self, along: np.ndarray) -> np.ndarray:
        where, _, radius = self.frame.polar(self.frame.mesh.neutral[self.lower])
        widest = self.opening(np.linspace(where.min(), where.max(), 50)).max()
        return (
            -LOWER_LID_RAISE
            * self.frame.mesh.size
            / radius.max()
            * np.sqrt(self.opening(along) / widest)
        )

    def angles(self) -> list[np.ndarray]:
        """How far the skin turns about the eye with the upper and the lower lid, S radians each."""
        return [
            self._angle(self.upper, self.opening, 0, LID_REACH),
            self._angle(self.lower, self._raise, LOWER_TARSUS, LOWER_REACH),
        ]

    def _angle(self, margin: np.ndarray, angle_at, full: float, end: float) -> np.ndarray:
        """Skin turns in full within `full` of the margin, less and less up to `end`, metres."""
        frame, mesh = self.frame, self.frame.mesh
        count = int(mesh.template.num_skin_vertices)
        other = self.lower if margin is self.upper else self.upper
        other = np.setdiff1d(other, margin)  # without the corners
        far = 0.03 * mesh.size
        own, across = (
            np.minimum(mesh.whole_surface.distances(mesh.vertices[edge], far)[:count], far)
            for edge in (margin, other)
        )
        behind = mesh.in_region("eye_socket")
        full = mesh.size * np.where(behind, 0, full)
        end = mesh.size * np.where(behind, LID_REACH / 2, end)
        # Round the corner lies the other lid, which stays.
        nearer = CORNER_SHARPNESS * (across - own) / (across + own)
        share = smooth_step((end - own) / (end - full)) * smooth_step(nearer)
        return share * angle_at(frame.polar(mesh.neutral[:count])[0])

    def turn(self, angle: np.ndarray) -> np.ndarray:
        """V x 3: skin turned about the eye by angles (S, down), lashes with their roots."""
        frame, mesh = self.frame, self.frame.mesh
        skin = mesh.neutral[: len(angle)]
        mode = np.zeros_like(mesh.neutral)
        mode[: len(angle)] = rotate(skin, frame.centre, frame.axis, angle) - skin
        lashes, roots = frame.lash_roots
        hair = mesh.neutral[lashes]
        mode[lashes] = rotate(hair, frame.centre, frame.axis, angle[roots]) - hair
        return mode
