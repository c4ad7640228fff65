# SPDX-License-Identifier: GPL-3.0-or-later
"""A recipe made into arrays: everything the renderer draws, in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .motion import control_values
from .person import random_identity
from .recipes import Recipe
from .texture import Look, SkinPainter, eye_albedo, positions_by_texel

HAIR_THICKNESS = 0.011
FACE_WIDTH = 0.145
KEY_LIGHT = (0.45, 0.55, 0.75)  # towards the light: camera's right, up, towards the camera


@dataclass(frozen=True)
class Motion:
    """Controls of the face over time and the displacements they cause."""

    names: list[str]
    values: np.ndarray  # N x U
    groups: np.ndarray  # U, 0 where a control has none
    displacements: np.ndarray  # N x V x 3, metres


@dataclass(frozen=True)
class Scene:
    """What one clip shows. Metres; `vertices` in the head frame, hair volume included."""

    vertices: np.ndarray  # N x V x 3 float32
    neutral: np.ndarray  # V x 3
    faces: np.ndarray  # F x 4
    part: np.ndarray  # F, index into part_names
    part_names: np.ndarray
    uv: np.ndarray  # F x 4 x 2
    head_pose: np.ndarray  # N x 4 x 4, camera_from_head
    intrinsics: np.ndarray  # 3 x 3
    image_size: np.ndarray  # width, height
    light: (
        np.ndarray
    )  # N x 4: direction to the key light (x right, y up, z to the camera), strength
    body_color: np.ndarray  # 3, linear
    body_rings: np.ndarray  # R x 4: height, depth of the middle, half width, half depth
    hairiness: np.ndarray  # V, 0 to 1

    def save(self, path: Path) -> None:
        np.savez(path, **{f.name: getattr(self, f.name) for f in fields(self)})


def identity_of(recipe: Recipe, template: FaceTemplate) -> np.ndarray:
    return random_identity(template.identity_names, template.identity_limits, recipe.seed)


def face_motion(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> Motion:
    """Controls and displacements of the recipe's face, none from the estimator's own basis."""
    times = np.arange(recipe.num_frames) / recipe.fps
    if recipe.kind == "muscles":
        return _muscle_motion(recipe, template, neutral, times)
    names = template.unit_names if recipe.kind == "units" else []
    values = control_values(recipe.phases, names, times)
    modes = template.unit_modes if names else np.zeros((0, *neutral.shape))
    moved = np.tensordot(values, modes, axes=1)
    return Motion(names, values, np.zeros(len(names), int), moved)


def _muscle_motion(
    recipe: Recipe, template: FaceTemplate, neutral: np.ndarray, times: np.ndarray
) -> Motion:
    """Muscles attached elsewhere, in a skin of other stiffness than the estimator assumes."""
    from mimetic.muscles.anatomy import AnatomyPerturbation, attach

    other = AnatomyPerturbation(insertion_mm=3.0, stiffness_factor=2.0, seed=recipe.seed)
    anatomy = attach(neutral, template, perturbation=other)
    names = [*anatomy.muscle_names, *anatomy.articulator_names]
    values = control_values(recipe.phases, names, times)
    modes = np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes])
    groups = np.concatenate([anatomy.groups, np.zeros(len(anatomy.articulator_names), int)])
    return Motion(names, values, groups, np.tensordot(values, modes, axes=1))


def build(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray, motion: Motion) -> Scene:
    """The arrays of one clip."""
    rng = np.random.default_rng([recipe.seed, 31])
    width, height = recipe.image_size
    focal = recipe.focal_ratio * width
    times = np.arange(recipe.num_frames) / recipe.fps
    distance = focal * FACE_WIDTH / recipe.face_width_px
    hair = painter(recipe, template, neutral).hairiness(neutral)
    hair[template.num_skin_vertices :] = 0
    volume = HAIR_THICKNESS * hair[:, None] * vertex_normals(neutral, template.faces)
    swing = recipe.light_swing * np.sin(2 * np.pi * 0.3 * times + rng.uniform(0, 6))
    toward = np.array(KEY_LIGHT) * (rng.choice((-1, 1)), 1, 1)
    return Scene(
        vertices=(neutral + volume + motion.displacements).astype(np.float32),
        neutral=neutral,
        faces=template.faces,
        part=template.part,
        part_names=np.array(template.part_names),
        uv=template.uv,
        head_pose=recipe.head_motion.poses(times, distance, recipe.seed),
        intrinsics=np.array(
            [[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1.0]]
        ),
        image_size=np.array(recipe.image_size),
        light=np.column_stack([np.tile(toward, (len(times), 1)), 1 + swing]),
        body_color=rng.uniform(0.05, 0.5, 3),
        body_rings=_body_rings(neutral[: template.num_skin_vertices]),
        hairiness=hair,
    )


def _body_rings(skin: np.ndarray) -> np.ndarray:
    """A collar about the end of the neck and shoulders under it (R,4)."""
    end = skin[:, 1].min()
    neck = skin[skin[:, 1] < end + 0.025]
    depth, half_depth = np.ptp(neck[:, 2]) / 2 + neck[:, 2].min(), np.ptp(neck[:, 2]) / 2
    half_width = np.ptp(neck[:, 0]) / 2
    grown = ((0.022, -0.012, -0.015), (0.020, 0.008, 0.006), (0.0, 0.025, 0.014))
    rings = [(end + up, depth, half_width + w, half_depth + d) for up, w, d in grown]
    shoulders = (
        (-0.03, 0.160, 0.085),
        (-0.06, 0.200, 0.098),
        (-0.12, 0.230, 0.110),
        (-0.6, 0.24, 0.13),
    )
    return np.array(rings + [(end + up, depth, w, d) for up, w, d in shoulders])


def paint(
    recipe: Recipe, template: FaceTemplate, neutral: np.ndarray, step: int = 1
) -> dict[str, np.ndarray]:
    """Textures by name (S,S,3) float32, linear light; row 0 is v = 0. Every `step`-th texel."""
    eye_centers, eye_radius = template.eye_spheres(neutral)
    skin_painter = painter(recipe, template, neutral)
    textures = {}
    for name in ("skin", "eye.L", "eye.R"):
        chosen = template.part_faces(name)
        uv = _stretched(template.uv[chosen])
        points = positions_by_texel(neutral, template.faces[chosen], uv)[::step, ::step]
        covered = ~np.isnan(points[..., 0])
        image = np.zeros((*covered.shape, 3), np.float32)
        if name == "skin":
            image[covered] = skin_painter.albedo(points[covered])
        else:
            center = eye_centers["LR".index(name[-1])]
            image[covered] = eye_albedo(points[covered], center, eye_radius, recipe.seed)
        textures[name] = image
    return textures


def _stretched(uv: np.ndarray) -> np.ndarray:
    """Texture coordinates of one part, made to fill the image; the renderer does the same."""
    low, high = uv.reshape(-1, 2).min(0), uv.reshape(-1, 2).max(0)
    return (uv - low) / (high - low)


def painter(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> SkinPainter:
    """Who paints this person's skin and knows where hair grows."""
    places = zip(template.landmark_names, template.landmark_vertices, strict=True)
    landmarks = {str(name): neutral[vertex] for name, vertex in places}
    return SkinPainter(Look.random(recipe.seed), landmarks)


def vertex_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """V x 3, of length 1; vertices V x 3, faces F x 4."""
    a, b, c, d = (vertices[faces[:, i]] for i in range(4))
    facing = np.cross(c - a, d - b)
    normals = np.zeros_like(vertices)
    for i in range(4):
        np.add.at(normals, faces[:, i], facing)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1)
