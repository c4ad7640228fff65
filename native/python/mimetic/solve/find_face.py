# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame of a clip that shows the face best, and the head fitted to it and a few others."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.fitting import NoFace
from mimetic.fit.known_lens import KnownLens, camera_with, cameras_to_try
from mimetic.fit.line_fit import with_lines
from mimetic.fit.rest_choice import RestChoice
from mimetic.fit.still_cover import StillCover
from mimetic.fit.upright import check_upright
from mimetic.fit.views import Candidate, choose_views
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import AttachedSkin, factored_skin
from mimetic.shared.parallel import both, in_turn
from mimetic.shared.progress import (
    ATTACHED,
    FITTED,
    JUDGED,
    NUM_TRIED,
    NUM_VIEWS,
    Progress,
    frame_text,
    stages,
)
from mimetic.solve.relief_sightings import with_relief
from mimetic.solve.rest_motion import Moved, moved_from
from mimetic.template.face_template import load_template

LEAST_CHANCE = 0.4  # of the best frame's chance; below it a frame is not tried
FAR_TURNED = math.radians(15.0)  # one half of a face turned as far is badly seen
NUM_TRIED_FRONTAL = 8
AT_REST = 0.5  # of `rest.usual_expression`, for lids and lips to be looked at
NUM_AT_REST = 4  # frames beside the reference, whose lids and lips are looked at
LEAST_FOLLOWED = 5  # frames, to say which of them is at rest
CLEARLY_BETTER = 0.2  # of `costs_of_rest`: by less, the frame that it is seen from stays
MOST_REFITTED = 3
LESS_COVERED = 0.25  # quantile of what is before the face that is usual in the clip
MORE_COVERED = 0.06  # share of the face; frames in which so much more is covered are left out

FitHead = Callable[[NDArray[np.uint8], int], FaceFit | None]  # image, frame -> head, if any


@dataclass(frozen=True)
class Rest:
    """A frame at rest, with the head fitted to it alone, among those in which a face was found."""

    fit: FaceFit
    candidates: list[Candidate]
    skin: AttachedSkin | None = None  # of nearly this head


def find_rest(
    footage: Footage,
    frame_numbers: set[int],
    progress: Progress,
    near: tuple[float, float] | None = None,
    lens: KnownLens | None = None,
) -> Rest | None:
    """The best frame at rest among those of `frame_numbers` to which a head can be fitted.

    near: as `mimetic.fit.fitting.find_face` has it; lens: that it was filmed with, if known
    """
    num_frames = len(frame_numbers)
    judging, fitting_heads, following = stages(
        *(progress, num_frames * JUDGED, NUM_TRIED * FITTED),
        ATTACHED + NUM_VIEWS * num_frames + FITTED,
    )
    (judgements, still_cover), _ = both(
        lambda: _judged(footage, frame_numbers, judging, near), fitting.prepare_models
    )
    if not judgements:
        return None
    frames = list(judgements)
    scores, expressions, details = _compared(judgements)
    chances = _core.chances_of_rest(scores, details, expressions)

    def fit_with(camera: _core.Camera, image: NDArray[np.uint8], frame: int) -> FaceFit | None:
        with contextlib.suppress(NoFace):
            faces = judgements[frame].faces
            fit = fitting.find_face(image, frame, camera=camera, near=near, faces=faces)
            return replace(fit, still_cover=still_cover)
        return None

    order = _core.distinct_first(chances, expressions)
    best_chance = float(chances.max()) or 1.0  # 0 where the finder is sure of no frame
    likely = [(frames[i], chances[i] / best_chance) for i in order]
    found = [face for judged in judgements.values() for face in judged.faces]
    for camera in cameras_to_try(lens, footage.size, found):
        fit_head = partial(fit_with, camera)
        if fits := _fitted_heads(footage, likely, fit_head, fitting_heads):
            break
    else:
        return None
    # A pose or expression mistaken for shape shows as unusual proportions.
    usual = best = min(fits, key=_unusualness)
    if _turn(best) > FAR_TURNED:
        best = _more_frontal(footage, best, frames, camera, near, fitting_heads)
    best = _explained(best, "usual" if best is usual else "frontal", judgements)
    best, skin = _relaxed(footage, best, fits, judgements, fit_head, following)
    rest = None if best.rest.why == "usual" else frames.index(best.frame)
    candidates = _candidates(judgements, _core.usual_expression(expressions, scores, rest))
    return Rest(best, candidates, skin)


def _fitted_heads(
    footage: Footage,
    candidates: Sequence[tuple[int, float]],
    fit_head: FitHead,
    progress: Progress,
) -> list[FaceFit]:
    """Heads fitted to the first frames, `NUM_TRIED` at most, those that are likely alone.

    candidates: frame and chance as a share of the best one's
    """

    def fitted(frame: int) -> FaceFit | None:
        return fit_head(images[frame], frame)

    left = deque(candidates)
    fits: list[FaceFit] = []
    while left and len(fits) < NUM_TRIED and (not fits or left[0][1] >= LEAST_CHANCE):
        batch = [left.popleft()]
        while left and len(fits) + len(batch) < NUM_TRIED and left[0][1] >= LEAST_CHANCE:
            batch.append(left.popleft())
        images = _images(footage, {frame for frame, _ in batch})
        for number, (frame, fit) in enumerate(in_turn(fitted, [frame for frame, _ in batch])):
            fraction = (len(fits) + number) / (len(fits) + len(batch))
            _go_on(progress, fraction, f"fitting the head: frame {frame}")
            fits += [fit] if fit is not None else []
    return fits


def _relaxed(
    footage: Footage,
    supposed: FaceFit,
    others: Sequence[FaceFit],
    judgements: Mapping[int, fitting.Judged],
    fit_head: FitHead,
    progress: Progress,
) -> tuple[FaceFit, AttachedSkin]:
    """The head in the frame that is best at rest by what moves, seen from a supposed rest.

    Seen from the most usual of `others` too, and the view is believed from which its own frame is
    more at rest: from a smile even a face at rest seems to contract. The supposed one where the
    face cannot be followed, or no head be fitted to what is better. With the skin of its head.
    """
    template = load_template()
    attaching, *viewing = stages(progress, ATTACHED, *NUM_VIEWS * [len(judgements)])
    skin = factored_skin(
        supposed.neutral_vertices(template), template, supposed.calibration, attaching
    )
    if skin is None:
        raise NoFace("stopped while looking for the face")
    widest = max(FAR_TURNED, _turn(supposed))
    usable = [fit for fit in others if fit.frame != supposed.frame and _turn(fit) <= widest]
    known = {fit.frame: fit for fit in (supposed, *sorted(usable, key=_unusualness))}
    least, costs = math.inf, {}
    for reference, view in zip(known.values(), viewing, strict=False):
        seen = _costs_seen_from(reference, footage, judgements, skin, view)
        if len(seen) < LEAST_FOLLOWED:
            continue
        seen[reference.frame] -= CLEARLY_BETTER
        if seen[reference.frame] < least:
            least, costs = seen[reference.frame], seen
    for frame in sorted(costs, key=costs.__getitem__)[:MOST_REFITTED]:
        fit = known[frame] if frame in known else fit_head(footage.read(frame), frame)
        if fit is not None and _turn(fit) <= widest:
            return _explained(fit, "relaxed", judgements), skin
    return supposed, skin


def _costs_seen_from(
    reference: FaceFit,
    footage: Footage,
    judgements: Mapping[int, fitting.Judged],
    skin: AttachedSkin,
    progress: Progress,
) -> dict[int, float]:
    """By frame to which the face can be followed: the less, the more likely it is at rest."""
    followed: dict[int, Moved] = {}
    for frame, moved in moved_from(footage, reference, set(judgements), skin):
        _go_on(progress, len(followed) / len(judgements), f"looking for rest: frame {frame}")
        followed[frame] = moved
    scores, _, details = _compared(judgements)
    rows = [list(judgements).index(frame) for frame in followed]
    values, lids = (
        np.array([getattr(m, n) for m in followed.values()]) for n in ("values", "lids")
    )
    costs = _core.costs_of_rest(values, lids, scores[rows], details[rows])
    return dict(zip(followed, costs.tolist(), strict=True))


def rest_asked_for(
    footage: Footage,
    frame: int,
    others: set[int],
    progress: Progress,
    near: tuple[float, float] | None = None,
    lens: KnownLens | None = None,
) -> Rest:
    """The head in the frame that is known to show rest; candidates are of `others` too.

    near, lens: as `find_rest` has them. Raises NoFace.
    """
    image = footage.read(frame)
    check_upright(footage, frame, image)
    camera = camera_with(lens, footage.size) if lens else None
    fit = fitting.find_face(image, frame, camera=camera, near=near)
    place = fit.head_place()
    judgements, still_cover = _judged(footage, {frame, *others}, progress, place, frame)
    scores, expressions, _ = _compared(judgements)
    usual = _core.usual_expression(expressions, scores, list(judgements).index(frame))
    fit = replace(fit, still_cover=still_cover)
    return Rest(_explained(fit, "asked for", judgements), _candidates(judgements, usual))


def _compared(
    judgements: Mapping[int, fitting.Judged],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Scores, expressions and details of the frames, in their order."""
    rows = judgements.values()
    expressions, details = (
        np.array([getattr(one, n) for one in rows]) for n in ("expression", "detail")
    )
    return _core.rest_scores([one.signs for one in rows]), expressions, details


def _candidates(
    judgements: Mapping[int, fitting.Judged], usual: NDArray[np.float64]
) -> list[Candidate]:
    return [
        Candidate(frame, one.features, float(share))
        for (frame, one), share in zip(judgements.items(), usual, strict=True)
    ]


def _explained(fit: FaceFit, why: str, judgements: Mapping[int, fitting.Judged]) -> FaceFit:
    """The fit with the reason why its frame was taken."""
    _, expressions, _ = _compared(judgements)
    alike = _core.num_alike(expressions, list(judgements).index(fit.frame))
    return replace(fit, rest=RestChoice(why, len(judgements), alike))


def _more_frontal(
    footage: Footage,
    turned: FaceFit,
    frames: list[int],
    camera: _core.Camera,
    near: tuple[float, float] | None,
    progress: Progress,
) -> FaceFit:
    """The least turned head of frames all over the clip, if by half, that fits at least as well.

    What the finder measures before a head is fitted hardly tells a turned face from a frontal one,
    and proportions look the more usual the less of them is seen.
    """
    frontal = turned
    for frame in frames[:: max(1, len(frames) // NUM_TRIED_FRONTAL)]:
        _go_on(progress, 1.0, f"fitting the head: frame {frame}")
        with contextlib.suppress(NoFace):
            fit = fitting.find_face(footage.read(frame), frame, camera=camera, near=near)
            if fit.error <= turned.error:
                frontal = min(frontal, replace(fit, still_cover=turned.still_cover), key=_turn)
    return frontal if _turn(frontal) <= _turn(turned) / 2 else turned


def _turn(fit: FaceFit) -> float:
    """Radians between where the face looks and the camera, up and down aside."""
    to_camera = -fit.head_pose[:3, :3].T @ fit.head_pose[:3, 3]
    return float(abs(np.arctan2(to_camera[0], to_camera[2])))


def joined_with_others(footage: Footage, rest: Rest, progress: Progress) -> FaceFit:
    """The head fitted to the frame at rest and to others in which it is turned otherwise.

    Lids and lips are then moved to where they are seen in frames at rest.
    """
    fit = with_relief(
        *(footage, _joined(footage, rest.fit, rest.candidates), rest.candidates, progress),
        skin=rest.skin,
    )
    return with_lines(fit, _others_at_rest(footage, fit, rest.candidates), load_template())


def _judged(
    footage: Footage,
    frame_numbers: set[int],
    progress: Progress,
    near: tuple[float, float] | None,
    asked: int | None = None,
) -> tuple[dict[int, fitting.Judged], StillCover]:
    """What is measured in those of `frame_numbers` that show a face with nothing more before it
    than is usual in the clip: no hand that passes. asked: the frame that stays nevertheless.

    And what stands still in the picture before it, in all of them."""
    first, last = min(frame_numbers), max(frame_numbers)
    images = ((f, image) for f, image in footage.frames(first, last) if f in frame_numbers)
    judgements = {}
    still = _core.StillCoverWatch()
    judged = in_turn(lambda numbered: fitting.judge_frame(numbered[1], near), images)
    for num_seen, ((frame, image), judgement) in enumerate(judged):
        text = f"looking for the face: {frame_text(frame, first, last)}"
        _go_on(progress, num_seen / len(frame_numbers), text)
        if judgement is not None:
            judgements[frame] = judgement
            still.add(np.ascontiguousarray(image), judgement.features)
    if not judgements:
        return judgements, StillCover()
    usual = np.quantile([one.covered for one in judgements.values()], LESS_COVERED)
    kept = {
        frame: one
        for frame, one in judgements.items()
        if frame == asked or one.covered <= usual + MORE_COVERED
    }
    return kept, StillCover.of(still.found())


def _go_on(progress: Progress, fraction: float, text: str) -> None:
    if not progress(fraction, text):
        raise NoFace("stopped while looking for the face")


def _joined(footage: Footage, best: FaceFit, candidates: list[Candidate]) -> FaceFit:
    reference = next(c for c in candidates if c.frame == best.frame)
    views = {view.frame: view.features for view in choose_views(reference, candidates)}
    if not views:
        return best
    images = _images(footage, {best.frame, *views})
    others = [(frame, features, images[frame]) for frame, features in views.items()]
    return fitting.join_views(best, images[best.frame], others)


def _images(footage: Footage, frames: set[int]) -> dict[int, NDArray[np.uint8]]:
    """By frame, in one pass: each by itself would be decoded from the clip's start."""
    images = {f: image for f, image in footage.frames(min(frames), max(frames)) if f in frames}
    return images | {f: footage.read(f) for f in frames - images.keys()}  # which says what is wrong


def _others_at_rest(
    footage: Footage, fit: FaceFit, candidates: list[Candidate]
) -> list[FittedView]:
    """The frames of the most usual expression beside the reference, as far as one is at rest."""
    usual = sorted(candidates, key=lambda c: -c.usual)
    chosen = [c for c in usual if c.usual >= AT_REST and c.frame != fit.frame][:NUM_AT_REST]
    if not chosen:
        return []
    template, images = load_template(), _images(footage, {c.frame for c in chosen})
    views = in_turn(
        lambda c: fitting.lone_view(c.frame, images[c.frame], c.features, fit.camera, template),
        sorted(chosen, key=lambda c: c.frame),
    )
    return [view for _, view in views if view is not None]


def _unusualness(fit: FaceFit) -> float:
    """Minus twice the logarithm of the prior."""
    values = face_shape(load_template()).joined(fit.identity, fit.residual)
    return float(values @ values)
