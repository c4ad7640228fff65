# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a performance plays on a character's own controls: `mimetic evaluate retarget`.

An actor of one identity moves by face units with known weights. What muscles can make of that
surface is fitted to it, without pictures, so that capture's errors stay out. The character is
another identity, meshed anew, turned and 1.3 times as large, with muscles attached by fifteen
landmarks and the 52 units as keys whose names say nothing. Its keys are fitted to the muscles'
motion; their values are compared with the actor's weights.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from mimetic import _core
from mimetic.character.foreign_head import ForeignHead, attach_foreign
from mimetic.character.shape import Shape
from mimetic.character.shapes import shapes_of_anatomy, shapes_of_extras
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.extras import attach_extras, gaze_rows, with_lip_shapes
from mimetic.retarget.controls import ControlSurface
from mimetic.retarget.playing import fit_of
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.anatomy.foreign_agreement import Disguised, disguise
from evaluation.anatomy.unit_muscles import COMPOSITES
from evaluation.synthetic.person import neutral_vertices, random_identity

# Seeds of actor and character. The fit's options were chosen on the one of "tuning"
SETS = {"tuning": ((11, 3),), "held-out": ((21, 5), (22, 6), (23, 7), (24, 8), (25, 9))}
IDENTITY = 0.3  # share of the modes' ranges, of characters
COURSE = (0.3, 0.7, 1.0, 0.7, 0.3, 0.0)
MIXTURES, UNITS_AT_ONCE = 150, 4
# One view sees neither the tongue behind the lips nor air; lips that stay shut over an opening jaw
# are seen, and muscles have no counterpart
UNSEEN = ("cheekPuff", "tongueOut", "mouthClose")
RIDGE = 0.01  # of the best linear reading, beside a unit's full value
WAYS = {"readings": _core.ControlFitOptions().unmatched_motion, "nearest surface": 1.0}

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class UnitScore:
    """One unit on one character, by one way of fitting."""

    way: str
    character: int
    unit: str
    correlation: float  # of the key's values with the actor's weights
    leak: float  # mean value in frames in which the unit rests
    full: float  # value where the actor shows it alone and in full
    # Of the actor, whoever plays it: correlation of the best linear reading of all values with the
    # weights, which is fitted to these very weights; share of the unit's motion that muscles make
    linear: float = 0.0
    made: float = 0.0


@dataclass(frozen=True)
class Course:
    """Weights of the units, T x 52; peaks: the row in which each unit is alone and full."""

    weights: Floats
    peaks: NDArray[np.int64]


def score_retargeting(which: str, report: Callable[[str], None]) -> Iterator[UnitScore]:
    """Each unit on each character of a set, by each way."""
    template = load_template()
    course = make_course(template)
    for actor, character in SETS[which]:
        report(f"actor {actor}, character {character}")
        source_names, acted, made = activations(template, course, actor)
        limits = linear_readings(acted, course.weights), made
        head = disguise(template, character, IDENTITY)
        bound = attach_foreign(head.vertices, head.faces, head.landmarks, template)
        for way, unmatched in WAYS.items():
            fitted = played(head, bound, template, source_names, acted, unmatched)
            yield from _scores(way, character, template.unit_names, course, fitted, limits)


def make_course(template: FaceTemplate) -> Course:
    """Each unit by itself, expressions of several, and mixtures at random."""
    units = template.unit_names
    stills = list(np.eye(len(units)))
    for shares in COMPOSITES.values():
        still = np.zeros(len(units))
        for name, share in shares.items():
            still[[unit in (name, f"{name}Left", f"{name}Right") for unit in units]] = share
        stills.append(still)
    rows = [height * still for still in stills for height in COURSE]
    random = np.random.default_rng(0)
    for _ in range(MIXTURES):
        row = np.zeros(len(units))
        on = random.choice(len(units), UNITS_AT_ONCE, replace=False)
        row[on] = random.uniform(0.2, 0.9, UNITS_AT_ONCE)
        rows.append(row)
    peaks = len(COURSE) * np.arange(len(units)) + COURSE.index(1.0)
    return Course(np.array(rows), peaks)


def activations(
    template: FaceTemplate, course: Course, seed: int
) -> tuple[list[str], Floats, Floats]:
    """Names of muscles, jaw, lids, lips and gaze, their values (T x S) nearest to the actor, and
    what share of each unit's motion (52) they make where it is alone and full."""
    identity = random_identity(template.identity_names, template.identity_limits, seed)
    neutral = neutral_vertices(template, identity, seed)
    skin = attach_skin(neutral, template)
    anatomy, extras = with_lip_shapes(modes_of(skin), skin), attach_extras(skin)
    shapes = shapes_of_anatomy(anatomy)
    shapes += [shape for shape in shapes_of_extras(extras) if shape.name.startswith(_looks())]
    options = _core.ControlFitOptions()
    options.sparsity, options.ridge, options.unmatched_motion = 0.001, 0.01, 1.0
    fit = _core.ControlFit(
        _offsets(shapes),
        np.asarray(template.unit_modes, dtype=np.float64),
        face_areas(neutral, template.faces),
        _ranges(shapes),
        _unit_ranges(len(template.unit_names)),
        options,
    )
    values = fit.frames(course.weights, np.zeros((len(course.weights), len(shapes))))
    made = [fit.explained(course.weights[[peak]], values[[peak]]) for peak in course.peaks]
    return [shape.name for shape in shapes], values, np.array(made)


def linear_readings(acted: Floats, weights: Floats) -> Floats:
    """52: how the best linear reading of the actor's values correlates with the true weights.

    It is fitted to these weights, which no mapping knows, so that it is a bound and no method.
    """
    inputs = np.hstack([acted, np.ones((len(acted), 1))])
    normal = inputs.T @ inputs + RIDGE * np.eye(inputs.shape[1])
    readings = inputs @ np.linalg.solve(normal, inputs.T @ weights)
    return np.array([np.corrcoef(*pair)[0, 1] for pair in zip(readings.T, weights.T, strict=True)])


def played(
    head: Disguised,
    bound: ForeignHead,
    template: FaceTemplate,
    source_names: list[str],
    acted: Floats,
    unmatched: float,
) -> Floats:
    """T x 52: the character's keys, fitted to what its own muscles do with these activations."""
    own = [*shapes_of_anatomy(bound.anatomy), *shapes_of_extras(bound.extras)]
    by_name = {shape.name: shape for shape in own}
    shapes = [by_name[name] for name in source_names]
    options = _core.ControlFitOptions()
    options.unmatched_motion = unmatched
    faces = np.asarray(head.faces)
    surface = ControlSurface(
        points=head.vertices,
        starts=np.arange(0, faces.size, faces.shape[1], dtype=np.int32),
        corners=faces.reshape(-1),
        control_names=list(template.unit_names),
        controls=np.ascontiguousarray(
            head.expected(np.asarray(template.unit_modes, dtype=np.float64))
        ),
        control_range=_unit_ranges(len(template.unit_names)),
        source_names=source_names,
        sources=_offsets(shapes),
        source_range=_ranges(shapes),
    )
    fit = fit_of(surface, options)
    return fit.frames(acted, np.zeros((len(acted), len(template.unit_names))))


def face_areas(points: Floats, faces: NDArray) -> Floats:
    """V: each face's area in equal parts for its corners. faces: F x 3 or F x 4."""
    faces = np.asarray(faces)
    starts = list(range(0, faces.size, faces.shape[1]))
    return _core.polygon_areas(points, starts, faces.reshape(-1).tolist())


def _offsets(shapes: Sequence[Shape]) -> Floats:
    return np.stack([shape.offsets for shape in shapes])


def _ranges(shapes: Sequence[Shape]) -> Floats:
    return np.array([(shape.lowest, shape.highest) for shape in shapes])


def _scores(
    way: str,
    character: int,
    units: list[str],
    course: Course,
    fitted: Floats,
    limits: tuple[Floats, Floats],
) -> Iterator[UnitScore]:
    """limits: of each unit's `linear` and `made`."""
    for k, unit in enumerate(units):
        weights, values = course.weights[:, k], fitted[:, k]
        moves = values.std() > 1e-9
        yield UnitScore(
            *(way, character, unit),
            float(np.corrcoef(weights, values)[0, 1]) if moves else 0.0,
            float(values[weights == 0].mean()),
            float(values[course.peaks[k]]),
            *(float(limit[k]) for limit in limits),
        )


def as_json(scores: list[UnitScore]) -> str:
    return json_text([asdict(score) for score in scores])


def as_text(scores: list[UnitScore]) -> str:
    """The ways side by side, by medians; then each unit over the characters, worst first."""
    columns = {
        "correlation": ("correlation", ".3f"),
        "low": ("below .8", ".0f"),
        "seen_low": ("seen of them", ".0f"),
        "leak": ("mean leak", ".3f"),
        "most_leak": ("largest leak", ".3f"),
        "full": ("at full", ".2f"),
    }
    texts = [text_table("ways", columns, {way: _summary(scores, way) for way in WAYS})]
    own = [score for score in scores if score.way == "readings"]
    by_unit = {score.unit: [s for s in own if s.unit == score.unit] for score in own}
    figures = {
        unit: {
            "correlation": float(np.median([s.correlation for s in rows])),
            "least": min(s.correlation for s in rows),
            "leak": max(s.leak for s in rows),
            "full": float(np.median([s.full for s in rows])),
            "linear": float(np.median([s.linear for s in rows])),
            "made": float(np.median([s.made for s in rows])),
        }
        for unit, rows in sorted(
            by_unit.items(), key=lambda item: np.median([s.correlation for s in item[1]])
        )
    }
    columns = {
        "correlation": ("correlation", ".2f"),
        "least": ("least", ".2f"),
        "leak": ("largest leak", ".3f"),
        "full": ("at full", ".2f"),
        "linear": ("best linear", ".2f"),
        "made": ("made", ".2f"),
    }
    return "\n\n".join([*texts, text_table("units", columns, figures)])


def _summary(scores: list[UnitScore], way: str) -> dict[str, float]:
    own = [score for score in scores if score.way == way]
    units = sorted({score.unit for score in own})
    medians = {u: float(np.median([s.correlation for s in own if s.unit == u])) for u in units}
    return {
        "correlation": float(np.median([score.correlation for score in own])),
        "low": sum(value < 0.8 for value in medians.values()),
        "seen_low": sum(value < 0.8 for unit, value in medians.items() if unit not in UNSEEN),
        "leak": float(np.mean([score.leak for score in own])),
        "most_leak": max(score.leak for score in own),
        "full": float(np.median([score.full for score in own])),
    }


def _looks() -> tuple[str, ...]:
    return tuple(row["name"] for row in gaze_rows())


def _unit_ranges(count: int) -> Floats:
    return np.tile([0.0, 1.0], (count, 1))
