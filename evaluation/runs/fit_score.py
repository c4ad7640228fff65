# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a fitted head is from the true one: in the picture, in space, in pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.skin.mesh import quad_normals
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE
from numpy.typing import NDArray

from evaluation.runs.portraits import Portraits
from evaluation.runs.projection import project_points

AXES = ("pitch", "yaw", "roll")
YAW_BINS = ((0, 10), (10, 20), (20, 30))  # degrees
PUPIL_DISTANCE = 0.063


@dataclass(frozen=True)
class Fitted:
    """A head as fitted to one picture."""

    neutral: NDArray[np.float64]  # V x 3, metres, head frame
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head
    focal: float  # pixels


@dataclass(frozen=True)
class ShotScore:
    """One picture's errors."""

    nodes: NDArray[np.float64]  # of the face's nodes that the camera sees, % of the pupil distance
    mesh: NDArray[np.float64]  # of the face's nodes in space after alignment, mm
    turn: NDArray[np.float64]  # 3, pitch, yaw, roll, signed, degrees, camera axes
    focal: float  # error of the focal length, %


def score_shot(fit: Fitted, portraits: Portraits, i: int, template: FaceTemplate) -> ShotScore:
    """Compares a fit with what picture `i` shows."""
    true = portraits.neutral_vertices[portraits.person[i]]
    pose, camera = portraits.head_pose[i], portraits.intrinsics[i]
    face = np.flatnonzero(template.in_region(*FACE))
    visible = face[_facing(true, template, pose)[face]]
    found_camera = camera * [[fit.focal / camera[0, 0]], [fit.focal / camera[1, 1]], [1]]
    found_camera[:2, 2] = camera[:2, 2]
    pixels = project_points(fit.neutral[visible], fit.head_pose, found_camera)[0]
    off = np.linalg.norm(pixels - project_points(true[visible], pose, camera)[0], axis=1)
    eyes = template.eye_spheres(true)[0].mean(axis=0) @ pose[:3, :3].T + pose[:3, 3]
    pupils = camera[0, 0] * PUPIL_DISTANCE / eyes[2]
    turn = _rotation_vector(fit.head_pose[:3, :3] @ pose[:3, :3].T)
    return ShotScore(
        nodes=100 * off / pupils,
        mesh=1000 * np.linalg.norm(laid_on(fit.neutral[face], true[face]) - true[face], axis=1),
        turn=np.degrees(turn),
        focal=100 * (fit.focal / camera[0, 0] - 1),
    )


def laid_on(points: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (K,3) turned, moved and scaled onto the target (K,3), least squares [Umeyama 1991]."""
    middle, aim = points.mean(axis=0), target.mean(axis=0)
    u, values, vt = np.linalg.svd((target - aim).T @ (points - middle))
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    scale = (values * sign).sum() / ((points - middle) ** 2).sum()
    return scale * (points - middle) @ (u * sign @ vt).T + aim


def figures(scores: list[ShotScore]) -> dict[str, float]:
    """Medians and 90th percentiles over all nodes, mean absolute turns and the mean pitch."""
    nodes = np.concatenate([s.nodes for s in scores])
    mesh = np.concatenate([s.mesh for s in scores])
    turn = np.array([s.turn for s in scores])
    return {
        "node_median": float(np.median(nodes)),
        "node_p90": float(np.percentile(nodes, 90)),
        "mesh_median": float(np.median(mesh)),
        "mesh_p90": float(np.percentile(mesh, 90)),
        **{name: float(np.abs(turn[:, k]).mean()) for k, name in enumerate(AXES)},
        "pitch_mean": float(turn[:, 0].mean()),
        "focal": float(np.mean([abs(s.focal) for s in scores])),
    }


def _facing(vertices, template: FaceTemplate, pose) -> NDArray[np.bool_]:
    """V: whether the camera looks at the front of the surface there."""
    in_camera = vertices @ pose[:3, :3].T + pose[:3, 3]
    return (quad_normals(in_camera, template.faces) * in_camera).sum(axis=1) < 0


def _rotation_vector(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    skew = (rotation - rotation.T) / 2
    axis = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    sine = np.linalg.norm(axis)
    angle = np.arctan2(sine, (np.trace(rotation) - 1) / 2)
    return axis * (angle / sine if sine > 1e-12 else 1.0)
