# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame of a clip that shows the face best, and the head fitted to it and a few others."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mimetic import fit as fitting
from mimetic.face_fit import FaceFit
from mimetic.face_shape import face_shape
from mimetic.face_template import load_template
from mimetic.fit import NoFace
from mimetic.footage import Footage
from mimetic.reference_views import Candidate, choose_views
from mimetic.relief_sightings import with_relief
from mimetic.rest import usual_expression

NUM_TRIED = 5  # of the candidates: the most promising
LEAST_CHANCE = 0.4  # of the best one's, to be tried


def best_fit(
    footage: Footage,
    wanted: set[int],
    progress: Callable[[float, str], bool] | None,
    near: tuple[float, float] | None = None,
) -> FaceFit | None:
    """The fit to the best of the wanted frames that can be fitted at all, joined with others.

    near: as `mimetic.fit.find_face` has it
    """
    frames: list[int] = []
    judged: list[fitting.Judged] = []
    for frame, image in footage.frames(min(wanted), max(wanted)):
        if frame in wanted:
            if progress and not progress(0.0, f"looking for the face: frame {frame}"):
                raise NoFace("stopped while looking for the face")
            found = fitting.judge_frame(image, near)
            if found is not None:
                frames.append(frame)
                judged.append(found)
    if not judged:
        return None
    scores = np.array([one.score for one in judged])
    usual = usual_expression(np.array([one.expression for one in judged]), scores)
    chances = scores * usual
    fits = []
    for i in np.argsort(-chances):
        if len(fits) == NUM_TRIED or (fits and chances[i] < LEAST_CHANCE * chances.max()):
            break
        with contextlib.suppress(NoFace):
            image = footage.read(frames[i])
            fits.append(fitting.find_face(image, frames[i], near=near))
    if not fits:
        return None
    # Pose or expression taken for shape asks for unusual proportions.
    best = min(fits, key=_unusualness)
    candidates = [
        Candidate(frame, one.features, float(share))
        for frame, one, share in zip(frames, judged, usual, strict=True)
    ]
    return with_relief(footage, _joined(footage, best, candidates), candidates, progress)


def _joined(footage: Footage, best: FaceFit, candidates: list[Candidate]) -> FaceFit:
    reference = next(c for c in candidates if c.frame == best.frame)
    views = {view.frame: view.features for view in choose_views(reference, candidates)}
    if not views:
        return best
    needed = {best.frame, *views}
    images: dict[int, NDArray[np.uint8]] = {
        frame: image for frame, image in footage.frames(min(needed), max(needed)) if frame in needed
    }
    others = [(frame, features, images[frame]) for frame, features in views.items()]
    return fitting.join_views(best, images[best.frame], others)


def _unusualness(fit: FaceFit) -> float:
    """Minus twice the logarithm of the prior."""
    values = face_shape(load_template()).joined(fit.identity, fit.residual)
    return float(values @ values)
