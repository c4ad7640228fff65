# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance composed of kept expressions alone."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.library.expression import Expression, columns_in, limits_of
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.extras import with_lip_shapes
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.performance.document import Performance
from mimetic.performance.gaze import EYE_KEYS, GAZE, modes_with_gaze
from mimetic.template.face_template import load_template

USUAL_FPS = 30.0
STILL_SECONDS = 1.2
STILL_RISE, STILL_FALL = 0.25, 0.4  # shares of a still's length in which it comes and goes
STILL_FINER = 4  # rows of a still's motion for each frame
MOST_SECONDS = 3600.0
PICTURE, FOCAL, DISTANCE = (640, 480), 900.0, 0.75  # pixels; metres of the head from the camera
NUMBER = r"[-+]?\d+(?:\.\d+)?"
PLACING = re.compile(
    rf"(?P<name>[^@*/]+)(?:@(?P<start>{NUMBER}))?(?:\*(?P<strength>{NUMBER}))?(?:/(?P<seconds>{NUMBER}))?"
)


@dataclass(frozen=True)
class Placing:
    """Where an expression of a library is in a composition."""

    name: str
    start: float = 0.0  # seconds at which it begins to move
    strength: float = 1.0
    seconds: float | None = None  # how long it lasts; None: as captured, STILL_SECONDS of a still


def parse_placing(text: str) -> Placing:
    """NAME[@START][*STRENGTH][/SECONDS]; raises InvalidInput."""
    match = PLACING.fullmatch(text.strip())
    if match is None:
        raise InvalidInput(
            f"{text!r} is no expression of a composition: NAME@START*STRENGTH/SECONDS, as in "
            "smile@0.5*0.8/2, of which NAME alone is needed"
        )
    values = {
        key: float(value) for key, value in match.groupdict().items() if key != "name" and value
    }
    if not 0 <= values.get("strength", 1) <= 10:
        raise InvalidInput(f"{text!r}: the strength must lie between 0 and 10")
    if not 0.05 <= values.get("seconds", 1) <= MOST_SECONDS:
        raise InvalidInput(f"{text!r}: an expression lasts from .05 to {MOST_SECONDS:g} seconds")
    if abs(values.get("start", 0)) > MOST_SECONDS:
        raise InvalidInput(f"{text!r}: it starts beyond {MOST_SECONDS:g} seconds")
    return Placing(match["name"], **values)


def compose(
    placings: Sequence[Placing],
    expression_of: Callable[[str], Expression],
    person: Performance | None = None,
    fps: float = USUAL_FPS,
    seconds: float | None = None,
    options: _core.CompositionOptions | None = None,
) -> Performance:
    """A performance of expressions played together.

    expression_of: gives the one of a name; person: whose head plays it, the canonical head's if
    None; seconds: that the whole lasts, starts and lengths being stretched; None leaves them.
    Where expressions move the same muscle, `_core.CompositionOptions` says which prevails. Raises
    InvalidInput.
    """
    pairs = [(placing, expression_of(placing.name)) for placing in placings]
    person = canonical_person() if person is None else person
    names = [*person.muscles, *person.articulators]
    values, stds = play(pairs, names, fps, seconds, options)
    notes = _notes(pairs, names, _stretch(pairs, seconds))
    return played_by(person, values, stds, fps, notes)


def played_by(
    person: Performance,
    values: NDArray[np.float64],
    stds: NDArray[np.float64],
    fps: float,
    notes: Iterable[str] = (),
) -> Performance:
    """What a person does of values and s.d. (N x C each, muscles, then articulators): those within
    their ranges, facing the camera, without detail."""
    values = np.clip(values, *limits_of([*person.muscles, *person.articulators], person.muscles))
    num_frames, num_muscles = len(values), len(person.muscles)
    return Performance(
        frame=np.arange(1, num_frames + 1),
        fps=fps,
        head_pose=_facing(num_frames),
        head_pose_cov=np.zeros((num_frames, 6, 6)),
        activations=values[:, :num_muscles],
        activations_std=stds[:, :num_muscles],
        articulator_values=values[:, num_muscles:],
        articulator_values_std=stds[:, num_muscles:],
        quality=np.ones(num_frames),
        notes=list(notes),
        **_head_of(person),
    )


def play(
    pairs: Sequence[tuple[Placing, Expression]],
    names: list[str],
    fps: float,
    seconds: float | None = None,
    options: _core.CompositionOptions | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values and s.d. (N x len(names) each) of muscles and articulators, frame by frame from 0 s.

    seconds: that the whole lasts, starts and lengths being stretched. Raises InvalidInput.
    """
    stretch = _stretch(pairs, seconds)
    whole = _whole(pairs)
    if not 0 < whole * stretch <= MOST_SECONDS:
        raise InvalidInput(
            f"the composition would last {whole * stretch:.6g} seconds; it must be above 0 and at "
            f"most {MOST_SECONDS:g}"
        )
    parts = [_part(placing, expression, names, stretch, fps) for placing, expression in pairs]
    num_steps = math.ceil(whole * stretch * fps - 1e-6)  # so that the last row is at rest again
    times = np.arange(max(2, num_steps + 1)) / fps
    return _core.compose_expressions(parts, times, options or _core.CompositionOptions())


def _stretch(pairs: Sequence[tuple[Placing, Expression]], seconds: float | None) -> float:
    """What starts and lengths are multiplied by; raises InvalidInput."""
    if not pairs:
        raise InvalidInput("name an expression to compose")
    whole = _whole(pairs)
    if whole <= 0:
        raise InvalidInput(
            "nothing is left to compose: every expression ends before 0 s; begin one of them later"
        )
    return 1.0 if seconds is None else seconds / whole


def _whole(pairs: Sequence[tuple[Placing, Expression]]) -> float:
    """Seconds until the last expression ends, before they are stretched."""
    return max(_end(placing, expression) for placing, expression in pairs)


def _onset(placing: Placing, expression: Expression) -> float:
    """Seconds from the expression's first row to where it begins to move, as placed."""
    if expression.is_still or placing.seconds is None:
        return expression.onset_seconds
    return expression.onset_seconds * placing.seconds / expression.seconds


def _length(placing: Placing, expression: Expression) -> float:
    if placing.seconds is not None:
        return placing.seconds
    return STILL_SECONDS if expression.is_still else expression.seconds


def _end(placing: Placing, expression: Expression) -> float:
    return placing.start - _onset(placing, expression) + _length(placing, expression)


def _part(
    placing: Placing, expression: Expression, names: list[str], stretch: float, fps: float
) -> _core.ExpressionPart:
    values, stds = columns_in(expression, names)
    length = stretch * _length(placing, expression)
    if expression.is_still:
        values, stds = (_still_rows(rows[0], length, fps) for rows in (values, stds))
    start = stretch * (placing.start - _onset(placing, expression))
    return _core.ExpressionPart(values, stds, start, length, placing.strength)


def motion_of_still(still: Expression, fps: float) -> Expression:
    """A still as a motion of STILL_SECONDS, from rest to rest."""
    values, stds = (
        _still_rows(rows[0], STILL_SECONDS, fps / STILL_FINER)
        for rows in (still.values, still.stds)
    )
    rate = (len(values) - 1) / STILL_SECONDS
    return Expression(still.channels, values, stds, rate, source=still.source)


def _still_rows(values: NDArray[np.float64], seconds: float, fps: float) -> NDArray[np.float64]:
    num_rows = max(5, math.ceil(STILL_FINER * fps * seconds))  # finer than frames, against corners
    shares = ((num_rows - 1) * STILL_RISE, (num_rows - 1) * STILL_FALL)
    return _core.still_motion(values, num_rows, *shares)


def _notes(
    pairs: list[tuple[Placing, Expression]], names: list[str], stretch: float
) -> Iterator[str]:
    for placing, expression in pairs:
        start, length = stretch * placing.start, stretch * _length(placing, expression)
        yield (
            f"composed: {placing.name} at {start:.4g} s, {length:.4g} s long, strength "
            f"{placing.strength:g}"
        )
        missing = [name for name in expression.channels if name not in names]
        if missing:
            yield f"{placing.name}: this head has no {', '.join(missing)}"


def _facing(num_frames: int) -> np.ndarray:
    """N x 4 x 4: the head before the camera, facing it."""
    pose = np.diag([1.0, -1, -1, 1])
    pose[2, 3] = DISTANCE
    return np.tile(pose, (num_frames, 1, 1))


def _head_of(person: Performance) -> dict[str, Any]:
    """Shape, muscles and camera of a person, for another performance of theirs."""
    keys = (
        *("muscles", "muscle_modes", "groups", "articulators", "articulator_modes"),
        *("neutral_vertices", "faces", "image_size", "intrinsics"),
        *EYE_KEYS,
    )
    return {key: getattr(person, key) for key in keys}


@lru_cache(maxsize=1)
def canonical_person() -> Performance:
    """Our own head as a performance of one frame at rest; made once."""
    template = load_template()
    skin = attach_skin(template.vertices, template)
    anatomy = with_lip_shapes(modes_of(skin), skin)  # all that a capture estimates
    width, height = PICTURE
    middle = [(width - 1) / 2, (height - 1) / 2]
    num_muscles = len(anatomy.muscle_names)
    eyes = eye_geometry(template.vertices, template)
    articulators = [*anatomy.articulator_names, *GAZE]
    return Performance(
        frame=np.array([1]),
        fps=USUAL_FPS,
        image_size=np.array(PICTURE),
        intrinsics=np.array([[FOCAL, 0, middle[0]], [0, FOCAL, middle[1]], [0, 0, 1]]),
        head_pose=_facing(1),
        head_pose_cov=np.zeros((1, 6, 6)),
        muscles=list(anatomy.muscle_names),
        muscle_modes=anatomy.muscle_modes,
        groups=anatomy.groups,
        activations=np.zeros((1, num_muscles)),
        activations_std=np.zeros((1, num_muscles)),
        articulators=articulators,
        articulator_values=np.zeros((1, len(articulators))),
        articulator_modes=modes_with_gaze(anatomy.articulator_modes),
        neutral_vertices=template.vertices,
        faces=template.faces.astype(np.int64),
        quality=np.ones(1),
        **eyes.fields((per_degree, 0.0) for per_degree in eyes.lid_per_degree),
    )
