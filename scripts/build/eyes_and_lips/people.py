# SPDX-License-Identifier: GPL-3.0-or-later
"""Who is drawn, what face they make in each shot, and where lids, irises and lips are then."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mimetic import _core
from mimetic.fit.face_model import limit_positions
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.muscles.feature_lines import feature_lines
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

from evaluation.synthetic import scene
from evaluation.synthetic.motion import rotation
from evaluation.synthetic.person import neutral_vertices
from evaluation.synthetic.recipes import Recipe
from evaluation.synthetic.speech.recipes import SHUT

SHOTS = 14
IMAGE_SIZE = (288, 288)
FACE_WIDTH_PX = 250.0
LARGEST_YAW, LARGEST_PITCH = 40.0, 22.0  # degrees
GAZE = (36.0, 22.0)  # degrees to the sides, and up or down
IRIS_ANGLES = (0.31, 0.43)  # radians from the eyeball's axis to the iris' rim
PART_SPREAD = 0.42  # s.d. of what makes eyes and mouths differ, of its limits
STATIONS = {"lid": 9, "lip": 11}
# A broad smile that bares the teeth, and by how much at most
GRIN = {"mouthSmile": 1.4, "mouthStretch": 0.7, "mouthUpperUp": 0.8, "mouthLowerDown": 0.9}
# Units of the mouth that are mixed; those of a pair mostly go together
MOUTH = (
    *("mouthSmile", "mouthFrown", "mouthStretch", "mouthDimple", "mouthPress", "mouthUpperUp"),
    *("mouthLowerDown", "mouthFunnel", "mouthPucker", "mouthRollLower", "mouthRollUpper"),
    *("mouthShrugLower", "mouthShrugUpper", "mouthLeft", "mouthRight", "jawLeft", "jawRight"),
    *("jawForward", "noseSneer", "cheekPuff", "cheekSquint"),
)
EYES = ("browDown", "browOuterUp", "browInnerUp", "eyeSquint", "eyeWide", "cheekSquint")


@dataclass(frozen=True)
class Person:
    """One person's shots: what Blender draws, and what is where. Pixels, N shots."""

    scene: scene.Scene
    lamps: np.ndarray  # N x L x 5
    ambient: float
    gloss: np.ndarray  # 2 x 2
    teeth: float  # how bright, beside those of clips
    lids: np.ndarray  # N x 2 (left first) x 2 (upper, lower) x 9 x 2, outer to inner corner
    irises: np.ndarray  # N x 2 x 5 x 2: middle, then four points of the rim
    lips: np.ndarray  # N x 4 x 11 x 2, as `FeatureSource` orders them
    anchors: np.ndarray  # 8 x 3, head frame: `feature_anchors`, then the mouth's corners


def person(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> Person:
    """The shots of a recipe's person; the same for the same seed."""
    rng = np.random.default_rng([recipe.seed, 303])
    frames = [_face(rng, template, neutral) for _ in range(recipe.num_frames)]
    vertices = np.stack([face for face, _ in frames])
    gaze = np.stack([angles for _, angles in frames])
    still = scene.Motion([], np.zeros((len(gaze), 0)), np.zeros(0, int), vertices - neutral)
    drawn = scene.build(recipe, template, neutral, still)
    distance = drawn.intrinsics[0, 0] * scene.FACE_WIDTH / recipe.face_width_px
    poses = np.stack([_pose(rng, distance) for _ in gaze])
    drawn = replace(drawn, head_pose=poses)
    lines = [_lines(template, v) for v in vertices]
    eyes = [_irises(template, neutral, angles, iris_angle(recipe)) for angles in gaze]

    def seen(points: np.ndarray, shot: int) -> np.ndarray:
        at = (points @ poses[shot, :3, :3].T + poses[shot, :3, 3]) @ drawn.intrinsics.T
        return at[..., :2] / at[..., 2:]

    names = [f"eye_{end}.{side}" for side in "LR" for end in ("outer", "inner")]
    names = ["hairline", "menton", *names, "mouth_corner.R", "mouth_corner.L"]
    return Person(
        scene=drawn,
        lamps=np.stack([_lamps(rng) for _ in gaze]),
        ambient=float(rng.uniform(0.08, 0.5)),
        teeth=float(rng.uniform(0.7, 1.5)),
        gloss=np.array([[rng.uniform(0.01, 0.1), rng.uniform(0.3, 0.6)], [0.06, 0.08]]),
        lids=np.stack(
            [
                _stations(seen, i, each[0], STATIONS["lid"]).reshape(2, 2, -1, 2)
                for i, each in enumerate(lines)
            ]
        ),
        irises=np.stack([seen(each, i) for i, each in enumerate(eyes)]),
        lips=np.stack(
            [_met(_stations(seen, i, each[1], STATIONS["lip"])) for i, each in enumerate(lines)]
        ),
        anchors=neutral[[template.landmark(name) for name in names]],
    )


def recipe_of(seed: int) -> Recipe:
    rng = np.random.default_rng([seed, 304])
    return Recipe(
        "person",
        "still",
        seed,
        SHOTS,
        image_size=IMAGE_SIZE,
        face_width_px=FACE_WIDTH_PX,
        focal_ratio=float(np.exp(rng.uniform(np.log(0.9), np.log(2.5)))),
    )


def neutral_of(recipe: Recipe, template: FaceTemplate) -> np.ndarray:
    """A person whose eyes and mouth differ more from the template's than those of clips."""
    rng = np.random.default_rng([recipe.seed, 305])
    identity = scene.identity_of(recipe, template)
    for i, name in enumerate(template.identity_names):
        if name.startswith(("eye_", "mouth_")):
            identity[i] = np.clip(rng.normal(0, PART_SPREAD), *template.identity_limits[i])
    return neutral_vertices(template, identity, recipe.seed)


def iris_angle(recipe: Recipe) -> float:
    return float(np.random.default_rng([recipe.seed, 306]).uniform(*IRIS_ANGLES))


def _face(
    rng: np.random.Generator, template: FaceTemplate, neutral: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V,3) of one expression, and both eyes' yaw and pitch (4), degrees."""
    names = list(template.unit_names)
    values = np.zeros(len(names))

    def set_unit(stem: str, value: float) -> None:
        skew = rng.uniform(0.6, 1.0) if rng.random() < 0.6 else rng.uniform(0.0, 1.0)
        sides = [1.0, skew] if rng.random() < 0.5 else [skew, 1.0]
        for name, share in zip((f"{stem}Left", f"{stem}Right"), sides, strict=True):
            if name in names:
                values[names.index(name)] = max(values[names.index(name)], share * value)
        if stem in names:
            values[names.index(stem)] = max(values[names.index(stem)], value)

    if rng.random() < 0.2:
        for stem, most in GRIN.items():
            set_unit(stem, most * rng.uniform(0.3, 1))
    else:
        for stem in rng.choice(MOUTH, rng.choice((0, 1, 2, 3, 4)), replace=False):
            set_unit(stem, rng.uniform(0, 1) ** 1.3)
    jaw = rng.choice([0.0, rng.uniform(0, 0.2), rng.uniform(0, 0.8)], p=(0.45, 0.3, 0.25))
    set_unit("jawOpen", jaw)
    if jaw and rng.random() < 0.25:  # lips shut over parted teeth
        set_unit("mouthClose", jaw * rng.uniform(0.3, 1))
    for stem in rng.choice(EYES, rng.choice((0, 1, 2)), replace=False):
        set_unit(stem, rng.uniform(0, 1))
    looks = rng.random()
    yaw, pitch = rng.uniform(-1, 1, 2) * GAZE if looks < 0.7 else rng.normal(0, 3, 2)
    lids = [0.0, 0.0]
    kind = rng.random()
    if kind < 0.25:
        lids = [rng.uniform(0, 0.3)] * 2
    elif kind < 0.5:
        lids = [rng.uniform(0, 1)] * 2
    elif kind < 0.62:
        lids = [1.0, 1.0]
    elif kind < 0.75:
        lids[rng.integers(2)] = rng.choice([1.0, rng.uniform(0.2, 1)])
    for side, shut in zip(("Left", "Right"), lids, strict=True):
        index = names.index(f"eyeBlink{side}")
        values[index] = SHUT * shut
        for other in ("eyeSquint", "eyeWide"):
            values[names.index(f"{other}{side}")] *= 1 - shut
    vertices = neutral + np.tensordot(values, template.unit_modes, axes=1)
    vergence = rng.uniform(0, 6)
    gaze = np.array([yaw - vergence / 2, pitch, yaw + vergence / 2, pitch])
    eyes = eye_geometry(neutral, template)
    turned = _core.turned_eyeballs(neutral, eyes.eye_of_vertex, eyes.centers, gaze)
    vertices += turned - neutral
    for eye, frame in enumerate(eye_frames(SkinMesh(template, neutral))):
        lid = EyeLids(frame)
        down = _core.Gaze(np.array([1.0, 0.0, 0.0]), -np.radians(pitch))
        # A lid that has come down already has less of its way left
        vertices += (1 - lids[eye]) * lid.turn(_core.lid_angle(lid, down))
    return vertices, gaze


def _lines(template: FaceTemplate, vertices: np.ndarray) -> tuple[list, list]:
    """Lids' margins (2 x 2 lines, from corner to corner) and lips' edges (4), on the surface."""
    surface = limit_positions(template)(vertices[: template.num_skin_vertices])
    lines = feature_lines(template)
    lids = []
    for side in "LR":
        ends = [template.landmark(f"eye_{end}.{side}") for end in ("outer", "inner")]
        for lid in ("upper", "lower"):
            middle = [v for v in lines[f"lid_{lid}.{side}"] if v not in ends]
            lids.append(surface[[ends[0], *middle, ends[1]]])
    edges = ("upper", "upper_inner", "lower_inner", "lower")
    return lids, [surface[lines[f"lip_{edge}"]] for edge in edges]


def _irises(
    template: FaceTemplate, neutral: np.ndarray, gaze: np.ndarray, rim: float
) -> np.ndarray:
    """2 x 5 x 3: the middle of the eyeball's front, and the rim to the right, up, left and down."""
    eyes = eye_geometry(neutral, template)
    points = []
    for eye, angles in enumerate((gaze[:2], gaze[2:])):
        front = _core.gaze_direction(*angles)
        across = np.cross((0.0, 1.0, 0.0), front)
        across /= np.linalg.norm(across)
        up = np.cross(front, across)
        axis = [front]
        for side in (across, up, -across, -up):
            axis.append(np.cos(rim) * front + np.sin(rim) * side)
        points.append(eyes.centers[eye] + eyes.radii[eye] * np.array(axis))
    return np.array(points)


def _stations(seen, shot: int, lines: list[np.ndarray], count: int) -> np.ndarray:
    """Lines (K x count x 2) at even distances in the picture."""
    made = []
    for line in lines:
        places = seen(line, shot)
        way = np.r_[0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))]
        at = np.linspace(0, way[-1], count)
        made.append(np.column_stack([np.interp(at, way, places[:, axis]) for axis in (0, 1)]))
    return np.array(made)


def _met(lips: np.ndarray) -> np.ndarray:
    """Lips that have passed each other are seen to meet midway."""
    along = lips[0, -1] - lips[0, 0]
    down = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    down = down if down[1] > 0 else -down
    apart = (lips[2] - lips[1]) @ down
    shift = np.minimum(apart, 0)[:, None] / 2 * down
    lips = lips.copy()
    lips[1] += shift
    lips[2] -= shift
    return lips


def _pose(rng: np.random.Generator, distance: float) -> np.ndarray:
    yaw = np.clip(rng.normal(0, 17), -LARGEST_YAW, LARGEST_YAW)
    pitch = np.clip(rng.normal(0, 10), -LARGEST_PITCH, LARGEST_PITCH)
    pose = np.eye(4)
    turn = rotation(*np.radians([yaw, pitch, rng.normal(0, 5)]))
    pose[:3, :3] = np.diag((1, -1, -1)) @ turn
    pose[:3, 3] = -pose[:3, :3] @ (0, -0.02, 0.09) + (0, 0, distance)
    return pose


def _lamps(rng: np.random.Generator) -> np.ndarray:
    """One to three lamps that shine: towards the lamp, strength, degrees."""
    lamps = []
    for share in (
        1.0,
        rng.choice([0.0, rng.uniform(0.1, 0.8)]),
        rng.choice([0.0, rng.uniform(0, 0.5)]),
    ):
        side, up = np.radians((rng.uniform(-75, 75), rng.uniform(-15, 75)))
        toward = (np.sin(side) * np.cos(up), np.sin(up), np.cos(side) * np.cos(up))
        lamps.append((*toward, share * rng.uniform(1.0, 2.4), rng.choice([2.0, 10.0, 30.0])))
    return np.array(lamps)
