# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate fit`: heads fitted to portraits beside the true ones."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, _core
from mimetic.fit.canonical_image import canonical_image
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitting import NoFace, find_face
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import FaceTemplate
from numpy.typing import NDArray

from evaluation.runs.fit_score import YAW_BINS, Fitted, ShotScore, figures, score_shot
from evaluation.runs.portraits import Portraits

# What shape may do: (identity modes, residual warp)
VARIANTS = {
    "as shipped": (True, True),
    "without the residual warp": (True, False),
    "without the identity space": (False, True),
    "pose alone": (False, False),
}
TOGETHER = "a person's pictures together"
COLUMNS = {
    "node_median": ("node %", ".1f"),
    "node_p90": ("90 %", ".1f"),
    "mesh_median": ("mesh mm", ".2f"),
    "mesh_p90": ("90 %", ".2f"),
    "pitch": ("pitch deg", ".1f"),
    "pitch_mean": ("mean", "+.1f"),
    "yaw": ("yaw", ".1f"),
    "roll": ("roll", ".1f"),
    "focal": ("focal %", ".0f"),
}


@dataclass(frozen=True)
class FitScores:
    """Scores by variant and by yaw, and the average of the canonical pictures."""

    num_pictures: int
    num_found: int
    rows: dict[str, dict[str, float]]
    average: NDArray[np.uint8]  # S x S x 3


def score_fits(portraits: Portraits, template: FaceTemplate) -> FitScores:
    """Fits every portrait that a face is found in; the camera's focal length is unknown to it."""
    fits: dict[int, FaceFit] = {}
    for i, image in enumerate(portraits.images):
        try:
            fits[i] = find_face(image, i + 1, template=template)
        except NoFace:
            continue
    if not fits:
        raise InvalidInput("no face was found in any of the portraits")
    scores: dict[str, dict[int, ShotScore]] = {}
    for name, kinds in VARIANTS.items():
        scores[name] = {
            i: score_shot(one, portraits, i, template)
            for i, fit in fits.items()
            for one in [_refitted([fit], template, kinds)[0]]
        }
    scores[TOGETHER] = _together(fits, portraits, template)
    rows = {name: figures(list(by_shot.values())) for name, by_shot in scores.items()}
    for low, high in YAW_BINS:
        of_yaw = [s for i, s in scores["as shipped"].items() if low <= abs(portraits.yaw[i]) < high]
        if of_yaw:
            rows[f"as shipped, yaw {low} to {high}"] = figures(of_yaw)
    return FitScores(len(portraits.images), len(fits), rows, _average(fits, portraits, template))


def _refitted(
    fits: list[FaceFit], template: FaceTemplate, kinds: tuple[bool, bool]
) -> list[Fitted]:
    """Fits to the features that are known, sharing shape, of which only some kinds may change."""
    views = [fit.views[0].observed() for fit in fits]
    guess = fits[0].camera
    estimate = _core.fit_face(face_model(template, *kinds), views, guess)
    displacement = np.tensordot(estimate.identity, face_shape(template, *kinds).components, axes=1)
    neutral = template.vertices + displacement
    return [Fitted(neutral, np.array(pose), estimate.focal) for pose in estimate.camera_from_head]


def _together(
    fits: dict[int, FaceFit], portraits: Portraits, template: FaceTemplate
) -> dict[int, ShotScore]:
    scores = {}
    for person in np.unique(portraits.person):
        shots = [i for i in fits if portraits.person[i] == person]
        if len(shots) < 2:
            continue
        together = _refitted([fits[i] for i in shots], template, (True, True))
        for i, one in zip(shots, together, strict=True):
            scores[i] = score_shot(one, portraits, i, template)
    return scores


def _average(
    fits: dict[int, FaceFit], portraits: Portraits, template: FaceTemplate
) -> NDArray[np.uint8]:
    """Mean of the canonical pictures, one a person: the one that faces the camera most."""
    total: NDArray[np.float64] | float = 0.0
    count: NDArray[np.float64] | float = 0.0
    for person in np.unique(portraits.person):
        shots = [i for i in fits if portraits.person[i] == person]
        if not shots:
            continue
        i = min(shots, key=lambda i: abs(portraits.yaw[i]))
        picture, is_seen = canonical_image(fits[i], portraits.images[i], template=template)
        total = total + picture.astype(float)
        count = count + is_seen
    return np.round(total / np.maximum(count, 1)[..., None]).astype(np.uint8)


def as_text(scores: FitScores) -> str:
    title = f"{scores.num_found} of {scores.num_pictures} portraits fitted"
    return text_table(title, COLUMNS, scores.rows, cell=10)


def as_json(scores: FitScores) -> str:
    counts = {"pictures": scores.num_pictures, "found": scores.num_found}
    return json_text(counts | {"rows": scores.rows})


def write(scores: FitScores, folder: Path) -> None:
    """fit.json and fit_average.png, each whole or not at all; raises OSError."""
    from matplotlib.image import imsave

    folder.mkdir(parents=True, exist_ok=True)
    with whole_file(folder / "fit.json") as stream:
        stream.write(as_json(scores).encode() + b"\n")
    with whole_file(folder / "fit_average.png") as stream:
        imsave(stream, scores.average, format="png")
