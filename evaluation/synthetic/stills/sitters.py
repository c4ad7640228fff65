# SPDX-License-Identifier: GPL-3.0-or-later
"""Who is photographed: pose, expression and light of a few shots a person, and where the parts are.

The last shot of a person shows the back of the head: everything of a portrait but the face.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import scene
from ..motion import rotation
from ..person import neutral_vertices
from ..recipes import Recipe

FACES_A_PERSON = 3
IMAGE_SIZE = (320, 240)
DRAWN_SIZE = (480, 360)  # of which a photograph is a part: shoulders reach its edges
PARTS = ("pupil.L", "pupil.R", "nose", "mouth")  # between the alae, between the corners
LARGEST = {"yaw": 30.0, "pitch": 12.0, "roll": 10.0}  # degrees
FACE_WIDTHS = (60.0, 112.0)  # pixels
EXPRESSIONS = (  # a name without a side moves both
    {},
    {"mouthSmile": 0.8, "cheekSquint": 0.5},
    {"jawOpen": 0.5, "browInnerUp": 0.8, "browOuterUp": 0.7},
    {"browDown": 0.9, "mouthFrown": 0.6},
    {"eyeLookInLeft": 0.5, "eyeLookOutRight": 0.5, "mouthPucker": 0.5},
    {"eyeSquint": 0.6, "noseSneerLeft": 0.5, "mouthLeft": 0.4},
)


@dataclass(frozen=True)
class Sitter:
    """One person's shots: what Blender draws, and what is where in each."""

    scene: scene.Scene
    textures: dict[str, np.ndarray]
    crop: np.ndarray  # shots x 2, left and top of the photograph in the drawing
    places: np.ndarray  # faces x parts x 2, pixels of the photograph
    ipd: np.ndarray  # faces, pixels: 63 mm at the eyes' distance from the camera, unforeshortened
    yaw: np.ndarray  # faces, degrees


def sitter(seed: int, template: FaceTemplate) -> Sitter:
    """The person of a seed, with FACES_A_PERSON shots from the front and one from behind."""
    rng = np.random.default_rng([seed, 51])
    focal_ratio = rng.uniform(0.8, 1.3)
    num_shots = FACES_A_PERSON + 1
    recipe = Recipe(
        "still", "still", seed, num_shots, image_size=DRAWN_SIZE, focal_ratio=focal_ratio
    )
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), seed)
    drawn = scene.build(recipe, template, neutral, scene.face_motion(recipe, template, neutral))
    moved = np.stack([expression_of(rng, template) for _ in range(FACES_A_PERSON)])
    moved = np.concatenate([moved, np.zeros((1, *neutral.shape))])
    focal = drawn.intrinsics[0, 0]
    yaw = np.append(rng.uniform(-1, 1, FACES_A_PERSON) * LARGEST["yaw"], 180 + rng.uniform(-35, 35))
    width = rng.uniform(*FACE_WIDTHS)
    distance = focal * scene.FACE_WIDTH / width
    poses = np.stack([_pose(rng, angle, distance) for angle in yaw])
    light = np.column_stack(
        [np.tile(toward_light(rng), (num_shots, 1)), rng.uniform(0.7, 1.25, num_shots)]
    )
    spare = (np.array(DRAWN_SIZE) - IMAGE_SIZE) / 2
    room = np.clip((np.array(IMAGE_SIZE) - (1.3 * width, 1.9 * width)) / 2, 0, spare)
    crop = np.round(spare + rng.uniform(-1, 1, (num_shots, 2)) * room).astype(int)
    drawn = replace(
        drawn,
        vertices=(drawn.vertices + moved).astype(np.float32),
        head_pose=poses,
        light=light,
    )
    in_head = np.stack(
        [part_places(template, neutral, neutral + m) for m in moved[:FACES_A_PERSON]]
    )
    turn, shift = poses[:FACES_A_PERSON, :3, :3], poses[:FACES_A_PERSON, :3, 3]
    in_camera = np.einsum("nij,npj->npi", turn, in_head) + shift[:, None]
    image = in_camera @ drawn.intrinsics.T
    return Sitter(
        scene=drawn,
        # At half the resolution of a clip's: these faces are small
        textures=scene.paint(recipe, template, neutral, step=2),
        crop=crop,
        places=image[..., :2] / image[..., 2:] - crop[:FACES_A_PERSON, None],
        ipd=focal * 0.063 / in_camera[:, :2, 2].mean(1),
        yaw=yaw[:FACES_A_PERSON],
    )


def expression_of(rng: np.random.Generator, template: FaceTemplate) -> np.ndarray:
    """Displacement of every control vertex (V,3)."""
    values = np.zeros(len(template.unit_names))
    strength = rng.uniform(0.6, 1.1)
    for name, value in EXPRESSIONS[rng.integers(len(EXPRESSIONS))].items():
        for i, unit in enumerate(template.unit_names):
            if unit in (name, f"{name}Left", f"{name}Right"):
                values[i] = min(1.0, strength * value)
    return np.tensordot(values, template.unit_modes, axes=1)


def _pose(rng: np.random.Generator, yaw: float, distance: float) -> np.ndarray:
    """camera_from_head (4,4), the head near the middle: the shoulders do not go with it."""
    tilt, lean = rng.uniform(-1, 1, 2) * (LARGEST["pitch"], LARGEST["roll"])
    pose = np.eye(4)
    pose[:3, :3] = np.diag((1, -1, -1)) @ rotation(*np.radians([yaw, tilt, lean]))
    pose[:3, 3] = (*rng.uniform(-0.01, 0.01, 2), distance * rng.uniform(0.97, 1.03))
    return pose


def toward_light(rng: np.random.Generator) -> np.ndarray:
    side, up = np.radians(rng.uniform((-65, 5), (65, 60)))
    return np.array([np.sin(side) * np.cos(up), np.sin(up), np.cos(side) * np.cos(up)])


def part_places(template: FaceTemplate, neutral: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """The parts (4,3) of a moved face (V,3) in the head frame. The pupils go with the eyeballs."""
    centers, radius = template.eye_spheres(neutral)
    places = []
    for name, center in zip(("eye.L", "eye.R"), centers, strict=True):
        ball = template.part_vertices(name)
        before = np.column_stack([neutral[ball], np.ones(len(ball))])
        turned = np.linalg.lstsq(before, vertices[ball], rcond=None)[0]
        places.append(np.append(center + np.array([0, 0, radius]), 1) @ turned)
    for pair in ("ala", "mouth_corner"):
        both = [vertices[template.landmark(f"{pair}.{side}")] for side in "LR"]
        places.append(np.mean(both, axis=0))
    return np.array(places)
