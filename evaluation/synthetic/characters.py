# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads of other makes with true landmarks: people meshed anew, stylised, and a fetched mask."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from mimetic import _core
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.muscles.eyeballs import limit_of
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.anatomy.foreign_agreement import collapse_edges
from evaluation.anatomy.mesh_file import read_mesh

FETCHED = Path(__file__).resolve().parents[2] / "build" / "foreign_face"
SETS = ("held-out", "tuning", "small")
KINDS = OTHER, SKIN, EYEBALL = range(3)
LEFT, UP, FRONT = np.eye(3)


@dataclass(frozen=True)
class Character:
    """A mesh that the programs under test see; truth: name -> place, L of them.

    kind: V, what the evaluation knows each vertex to be of (`KINDS`); empty if it does not.
    """

    name: str
    vertices: NDArray[np.float64]  # V x 3, any axes and unit
    triangles: NDArray[np.int32]
    truth: dict[str, NDArray[np.float64]]
    pupil_distance: float  # in its unit
    kind: NDArray[np.int8] = field(default_factory=lambda: np.zeros(0, np.int8))


@dataclass(frozen=True)
class Style:
    """How a person is drawn: eyes and nose by factors, forehead by a share of its height; of coarse
    meshes alone, sealed: skin instead of eyes, mask: the face without the head behind it."""

    eyes: float = 1.0
    nose: float = 1.0
    forehead: float = 0.0
    jaw: float = 1.0  # width
    is_sealed: bool = False
    is_mask: bool = False


@dataclass(frozen=True)
class Recipe:
    """kept: share of the fine skin's vertices; 0 takes the coarse control mesh; axes: where the
    head's left, up and front go."""

    name: str
    seed: int
    identity: float  # share of the identity modes' ranges
    kept: float
    axes: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    unit: float = 1.0  # of a metre
    style: Style = Style()


BLENDER = (LEFT, FRONT, -UP)  # where left, up and front of the head go: x, z, -y
GLTF = (LEFT, UP, FRONT)
ODD = (UP, -LEFT, FRONT)  # a head that lies on its side

RECIPES = {
    "held-out": (
        Recipe("person, half of the edges gone", 901, 0.5, 0.5, BLENDER),
        Recipe("person, subdivided, y up", 902, 0.5, 1.0, GLTF, 100.0),
        Recipe("person, coarse, on its side", 903, 0.5, 0.0, ODD),
        Recipe(
            "stylised: eyes 1.5, forehead", 904, 0.3, 0.6, BLENDER, 1, Style(1.5, 0.8, 0.3, 0.85)
        ),
        Recipe("mask of a person, with lashes", 905, 0.5, 0.0, GLTF, 1, Style(is_mask=True)),
    ),
    "tuning": (
        *(
            Recipe(f"person {seed}", seed, 0.4, kept, axes)
            for seed, kept, axes in (
                (100, 0.0, BLENDER),
                (101, 0.5, GLTF),
                (102, 1.0, ODD),
                (103, 0.0, BLENDER),
                (104, 0.5, BLENDER),
                (105, 0.0, GLTF),
            )
        ),
        Recipe("eyes 1.3", 110, 0.2, 0.0, BLENDER, 1, Style(1.3)),
        Recipe("eyes 1.8, little nose", 111, 0.2, 0.0, BLENDER, 1, Style(1.8, 0.4, 0.4)),
        Recipe("no nose", 112, 0.2, 0.0, GLTF, 1, Style(1.2, 0.1, 0.2, 1.2)),
        Recipe("long forehead", 113, 0.2, 0.0, BLENDER, 1, Style(1.0, 1.3, 0.8)),
        Recipe("sealed eyes", 114, 0.3, 0.0, BLENDER, 1, Style(is_sealed=True)),
        Recipe("sealed large eyes", 115, 0.3, 0.0, GLTF, 1, Style(1.4, 0.7, is_sealed=True)),
        *(
            Recipe(f"mask {seed}", seed, 0.4, 0.0, axes, 1, Style(is_mask=True))
            for seed, axes in ((116, GLTF), (117, BLENDER), (118, ODD), (119, GLTF))
        ),
    ),
    "small": (Recipe("person", 120, 0.3, 0.0, BLENDER),),
}


def characters(which: str) -> Iterator[Character]:
    """The heads of a set; the fetched mask, if it is there, among the held-out ones."""
    template = load_template()
    for recipe in RECIPES[which]:
        yield made(recipe, template)
    if which == "held-out" and (FETCHED / "face.obj").is_file():
        yield fetched()


def fetched() -> Character:
    """The canonical face of MediaPipe (`scripts/fetch_foreign_face`), centimetres, y up."""
    vertices, faces = read_mesh(FETCHED / "face.obj")
    rows = json.loads((FETCHED / "landmarks.json").read_text(encoding="utf-8"))
    triangles = _core.cut_faces(np.ascontiguousarray(vertices), faces)[0]
    truth = {name: vertices[rows[name]] for name in REQUIRED}
    eyes = [(truth[f"eye_inner.{side}"] + truth[f"eye_outer.{side}"]) / 2 for side in "LR"]
    return Character(
        "fetched mask", vertices, triangles, truth, float(np.sqrt(((eyes[0] - eyes[1]) ** 2).sum()))
    )


def made(recipe: Recipe, template: FaceTemplate) -> Character:
    """A person of the identity space, drawn in a style and meshed anew."""
    random = np.random.default_rng(recipe.seed)
    limits = np.asarray(template.identity_limits)
    values = recipe.identity * random.uniform(limits[:, 0], limits[:, 1])
    neutral = template.vertices + np.tensordot(values, template.identity_modes, axes=1)
    neutral = stylised(neutral, template, recipe.style)
    skin, skin_faces = _skin(recipe, template, neutral.copy(), random)
    for ball in (template.part_vertices(f"eye.{side}") for side in "LR"):
        neutral[ball] = limit_of(
            neutral, template, ball
        )  # its control vertices lie before the lids
    is_loose = np.arange(len(template.faces)) >= int(template.num_skin_faces)
    if recipe.style.is_sealed:
        is_loose[template.part_faces("eye.L", "eye.R", "lashes.L", "lashes.R")] = False
    loose = template.faces[is_loose]
    loose = np.concatenate([loose[:, :3], loose[:, [0, 2, 3]]]) + len(skin)
    vertices = np.concatenate([skin, neutral])
    rotation = np.column_stack(recipe.axes)  # of the head's x, y, z
    places = recipe.unit * vertices @ rotation.T
    eyes, _ = template.eye_spheres(neutral)
    distance = recipe.unit * float(np.sqrt(((eyes[0] - eyes[1]) ** 2).sum()))
    truth = {name: recipe.unit * rotation @ neutral[template.landmark(name)] for name in REQUIRED}
    triangles = np.concatenate([skin_faces, loose])
    used, numbers = np.unique(triangles, return_inverse=True)
    triangles = np.ascontiguousarray(numbers.reshape(-1, 3), np.int32)
    kind = np.full(len(vertices), OTHER, np.int8)
    kind[: len(skin)] = SKIN
    kind[len(skin) + template.part_vertices("eye.L", "eye.R")] = EYEBALL
    mesh = np.ascontiguousarray(places[used])
    return Character(recipe.name, mesh, triangles, truth, distance, kind[used])


def _skin(recipe: Recipe, template: FaceTemplate, neutral, random):
    """Vertices and triangles of the skin at the recipe's density; landmarks stay vertices."""
    if not recipe.kept:
        quads = template.skin_faces
        if recipe.style.is_sealed:
            return _sealed(template, neutral)
        if recipe.style.is_mask:
            quads = quads[_is_of_mask(template)[quads].all(axis=1)]
        return neutral, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    mesh = SkinMesh(template, neutral)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # folds of a random person are repaired
        fine = mesh.vertices
    anchors = {int(template.landmark(name)) for name in REQUIRED}
    if recipe.kept == 1:
        return fine, mesh.triangles
    return fine, collapse_edges(fine, mesh.triangles, recipe.kept, random, anchors)


def _is_of_mask(template: FaceTemplate) -> NDArray[np.bool_]:
    """V: skin before the ears, under the hair and above the neck."""
    places = template.vertices
    eyes, _ = template.eye_spheres(places)
    is_front = (places[:, 2] > eyes[:, 2].mean() - 0.03) & (places[:, 1] < 0.055)
    is_front[: int(template.num_skin_vertices)] &= ~template.in_region("scalp", "neck", "ear")
    return is_front


def _sealed(template: FaceTemplate, neutral: NDArray[np.float64]):
    """The coarse skin with a lid over each eye from margin to margin, and no socket behind it."""
    sockets = template.part_faces("eye_socket")
    is_kept = np.ones(int(template.num_skin_faces), bool)
    is_kept[sockets[sockets < len(is_kept)]] = False
    quads = template.skin_faces[is_kept]
    triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    inside = np.unique(template.faces[sockets])
    margins = set(np.intersect1d(inside, quads).tolist())
    sides = {
        (int(a), int(b))
        for face in quads
        for a, b in zip(face, np.roll(face, -1), strict=True)
        if {int(a), int(b)} <= margins
    }
    rim = np.array([(a, b) for a, b in sides if (b, a) not in sides])
    lids, middles = [triangles], []
    for sign in (1, -1):
        own = rim[sign * neutral[rim[:, 0], 0] > 0]
        middles.append(neutral[own[:, 0]].mean(axis=0) + 0.002 * FRONT)
        top = np.full(len(own), len(neutral) + len(middles) - 1)
        lids.append(np.column_stack([own[:, ::-1], top]))
    return np.concatenate([neutral, middles]), np.concatenate(lids)


def stylised(neutral: NDArray[np.float64], template: FaceTemplate, style: Style):
    """A head with other proportions, V x 3; lids and eyeballs stay together."""
    places = neutral.copy()
    for side in "LR":
        corners = [places[template.landmark(f"eye_{end}.{side}")] for end in ("inner", "outer")]
        middle = np.mean(corners, axis=0) - [0, 0, 0.008]
        near = np.exp(-((((places - middle) / [0.022, 0.022, 0.03]) ** 2).sum(1) ** 2))
        places += (style.eyes - 1) * near[:, None] * (places - middle)
    tip = places[template.landmark("nose_tip")]
    base = (places[template.landmark("ala.L")] + places[template.landmark("ala.R")]) / 2
    near = np.exp(-(((places - tip) / [0.016, 0.03, 0.03]) ** 2).sum(1))
    places[:, 2] += (style.nose - 1) * near * np.maximum(0, places[:, 2] - base[2])
    brow = places[template.landmark("brow_middle.L"), 1]
    places[:, 1] += style.forehead * np.maximum(0, places[:, 1] - brow - 0.01)
    low = np.clip((template.vertices[:, 1] + 0.01) / -0.06, 0, 1)
    places[:, 0] *= 1 + (style.jaw - 1) * low
    return places
