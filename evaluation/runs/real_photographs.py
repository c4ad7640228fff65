# SPDX-License-Identifier: GPL-3.0-or-later
"""The first fit of the head beside points marked by hand on photographs of many people."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.real_labels import FOLDER, POINTS, Labels, marking, marks
from evaluation.runs.real_methods import (
    REFINED_MESH_POINTS,
    face_meshes_of_stills,
    fitted_points,
)
from evaluation.runs.real_score import (
    FACE_MESH,
    FEATURES,
    FIRST_FIT,
    RealScore,
    score_again,
    score_places,
    with_faces,
)
from evaluation.runs.rendered import CHECKOUT

STILLS = "stills"
PICTURES = CHECKOUT / "build" / "footage" / STILLS
SIDES = ("left", "top", "right", "bottom")
CELL = 14


@dataclass(frozen=True)
class Photograph:
    """One face: a picture, and which part of it the methods are shown where it has several."""

    picture: str
    box: tuple[int, int, int, int] | None = None  # SIDES, the last two excluded

    @property
    def name(self) -> str:
        """What the tables call it."""
        return f"{self.picture} from x = {self.box[0]}" if self.box else self.picture

    @property
    def corner(self) -> NDArray[np.float64]:
        """x, y of the left top that is shown."""
        return np.array((self.box or (0, 0))[:2], float)

    def read(self) -> NDArray[np.uint8]:
        """H x W x 3 of what is shown; raises InvalidInput if it was not fetched."""
        from PIL import Image

        path = PICTURES / self.picture
        if not path.is_file():
            raise InvalidInput(f"{self.picture} is not there; run scripts/fetch_footage --stills")
        with Image.open(path) as opened:
            picture = np.asarray(opened.convert("RGB"))
        if self.box is None:
            return picture
        left, top, right, bottom = self.box
        return picture[top:bottom, left:right]


def read_photographs(second: bool = False) -> tuple[list[Photograph], Labels]:
    """The faces, and their marking or the second one: a row a face. Raises InvalidInput."""
    path = FOLDER / f"{STILLS}{'.second' if second else ''}.csv"
    with marking(path) as rows:
        faces = [Photograph(row["picture"], _box(row)) for row in rows]
        labels = Labels(STILLS, np.arange(1, len(rows) + 1), *marks(rows))
    if len(set(faces)) < len(faces) or not faces:
        raise InvalidInput(f"{path}: each face must be in one row")
    return faces, labels


def _box(row: dict[str, str]) -> tuple[int, int, int, int] | None:
    if not row["left"]:
        return None
    left, top, right, bottom = (int(row[side]) for side in SIDES)
    if not (0 <= left < right and 0 <= top < bottom):
        raise ValueError(f"{row['picture']} has an empty box")
    return left, top, right, bottom


def score_photographs(
    images: list[NDArray[np.uint8]], python: Path | None, report: Callable[[str], None]
) -> list[RealScore]:
    """The fit, MediaPipe and the second marking. images: of all faces (`read_images`).

    python: of scripts/face_mesh_env, where it is available. Raises InvalidInput.
    """
    faces, labels = read_photographs()
    corners = np.array([face.corner for face in faces])[:, None]
    report(f"{STILLS}: fit, {len(faces)} faces")
    places = {FIRST_FIT: corners + np.stack([fitted_points(image) for image in images])}
    if python is not None:
        report(f"{STILLS}: {FACE_MESH}")
        meshes = face_meshes_of_stills(images, python)
        places[FACE_MESH] = corners + meshes[:, [REFINED_MESH_POINTS[name] for name in POINTS]]
    names = [face.name for face in faces]
    scores = [
        with_faces(score_places(labels, method, seen), names, labels, seen)
        for method, seen in places.items()
    ]
    return [*scores, marked_again(faces, labels)]


def read_images() -> list[NDArray[np.uint8]]:
    """What is shown of each face; raises InvalidInput if a picture was not fetched."""
    return [face.read() for face in read_photographs()[0]]


def marked_again(faces: list[Photograph], labels: Labels) -> RealScore:
    """How far the second marking is from the first."""
    again, second = read_photographs(second=True)
    first = labels.rows(np.array([face in again for face in faces]))
    order = [again.index(face) for face in faces if face in again]
    return score_again(first, second.places[order])


def faces_texts(scores: list[RealScore]) -> list[str]:
    """Two tables of photographs: mean errors of each face, and of each point; of a clip none."""
    known = [score for score in scores if score.faces]
    return [_by_face(known), _by_point(known)] if known else []


def _by_face(scores: list[RealScore]) -> str:
    columns, rows = {}, {name: {} for name in scores[0].faces}
    for feature in FEATURES:
        for score in scores:
            key = f"{feature} {score.method}"
            columns[key] = (feature if score is scores[0] else _short(score), ".1f")
            for name, figures in score.faces.items():
                rows[name][key] = figures[feature]
    return text_table(f"{scores[0].clip}, % of IPD: means of each face", columns, rows, CELL)


def _by_point(scores: list[RealScore]) -> str:
    columns, rows = {}, {name: {} for name in scores[0].points}
    for score in scores:
        for i, way in enumerate(("left", "down")):
            key = f"{score.method} {way}"
            columns[key] = (f"{_short(score)}, {way}", "+.1f")
            for name, means in score.points.items():
                rows[name][key] = means[i]
    return text_table(f"{scores[0].clip}, % of IPD: means of each point", columns, rows, 18)


def _short(score: RealScore) -> str:
    return score.method.split(",")[0]
