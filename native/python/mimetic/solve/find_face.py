# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame of a clip that shows the face best, and the head fitted to it and a few others."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from collections.abc import Callable, Sequence
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
    stages,
)
from mimetic.solve.judged_frames import NEAR_ENOUGH, JudgedFrames, judged_frames, widths_away
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

    near: a place (x, y) in pixels where the face is in one of them at least, the largest without;
    lens: that it was filmed with, if known
    """
    num_frames = len(frame_numbers)
    judging, fitting_heads, following = stages(
        *(progress, num_frames * JUDGED, NUM_TRIED * FITTED),
        ATTACHED + NUM_VIEWS * num_frames + FITTED,
    )
    judged, _ = both(
        lambda: judged_frames(footage, frame_numbers, partial(_go_on, judging), near),
        fitting.prepare_models,
    )
    if not judged.clear:
        return None
    frames = list(judged.clear)
    scores, expressions, details = judged.compared()
    chances = _core.chances_of_rest(scores, details, expressions)

    def fit_with(camera: _core.Camera, image: NDArray[np.uint8], frame: int) -> FaceFit | None:
        with contextlib.suppress(NoFace):
            faces = judged.clear[frame].faces
            fit = fitting.find_face(image, frame, camera=camera, near=near, faces=faces)
            return replace(fit, still_cover=judged.still_cover)
        return None

    order = _core.distinct_first(chances, expressions)
    best_chance = float(chances.max()) or 1.0  # 0 where the finder is sure of no frame
    likely = [(frames[i], chances[i] / best_chance) for i in order]
    found = [face for one in judged.clear.values() for face in one.faces]
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
    best = judged.explained(best, "usual" if best is usual else "frontal")
    best, skin = _relaxed(footage, best, fits, judged, fit_head, following)
    rest = None if best.rest.why == "usual" else frames.index(best.frame)
    candidates = judged.candidates(_core.usual_expression(expressions, scores, rest))
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
    judged: JudgedFrames,
    fit_head: FitHead,
    progress: Progress,
) -> tuple[FaceFit, AttachedSkin]:
    """The head in the frame that is best at rest by what moves, seen from a supposed rest.

    Seen from the most usual of `others` too, and the view is believed from which its own frame is
    more at rest: from a smile even a face at rest seems to contract. The supposed one where the
    face cannot be followed, or no head be fitted to what is better. With the skin of its head.
    """
    template = load_template()
    num_followed = len(judged.clear) + len(judged.covered)
    attaching, *viewing = stages(progress, ATTACHED, *NUM_VIEWS * [num_followed])
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
        seen = _costs_seen_from(reference, footage, judged, skin, view)
        if len(seen) < LEAST_FOLLOWED:
            continue
        seen[reference.frame] -= CLEARLY_BETTER
        if seen[reference.frame] < least:
            least, costs = seen[reference.frame], seen
    for frame in sorted(costs, key=costs.__getitem__)[:MOST_REFITTED]:
        fit = known[frame] if frame in known else fit_head(footage.read(frame), frame)
        if fit is not None and _turn(fit) <= widest:
            return judged.explained(fit, "relaxed"), skin
    return supposed, skin


def _costs_seen_from(
    reference: FaceFit,
    footage: Footage,
    judged: JudgedFrames,
    skin: AttachedSkin,
    progress: Progress,
) -> dict[int, float]:
    """By clear frame to which the face can be followed: the less, the more likely it is at rest."""
    followed: dict[int, Moved] = {}
    frames = judged.clear.keys() | judged.covered
    for frame, moved in moved_from(footage, reference, frames, skin):
        _go_on(progress, len(followed) / len(frames), f"looking for rest: frame {frame}")
        followed[frame] = moved
    scores, _, details = judged.compared()
    clear = [frame for frame in followed if frame in judged.clear]
    rows = [list(judged.clear).index(frame) for frame in clear]
    values = np.array([followed[frame].values for frame in clear])
    lids, covered_lids = (
        np.array([followed[frame].lids for frame in some]).reshape(-1, 2)
        for some in (clear, sorted(followed.keys() - judged.clear.keys()))
    )
    costs = _core.costs_of_rest(values, lids, scores[rows], details[rows], covered_lids)
    return dict(zip(clear, costs.tolist(), strict=True))


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
    if near is not None and widths_away(fit.views[0].measured, near) > NEAR_ENOUGH:
        raise NoFace(
            f"no frontal face found near ({near[0]:.0f}, {near[1]:.0f}) in frame {frame}, which is "
            "to show rest: name a place where the face is in that frame"
        )
    place = fit.head_place()
    judged = judged_frames(footage, {frame, *others}, partial(_go_on, progress), place, frame)
    scores, expressions, _ = judged.compared()
    usual = _core.usual_expression(expressions, scores, list(judged.clear).index(frame))
    fit = replace(fit, still_cover=judged.still_cover)
    return Rest(judged.explained(fit, "asked for"), judged.candidates(usual))


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
