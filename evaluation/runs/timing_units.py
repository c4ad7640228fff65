# SPDX-License-Identifier: GPL-3.0-or-later
"""What a capture adds to a face that moves by an action unit alone: energy outside it is error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

from mimetic.analyse.comparison import compare
from mimetic.analyse.timing import analyse_timing
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

from evaluation.runs.kept_captures import KeptCaptures
from evaluation.synthetic.timing.action_units import SETS, unit_motion
from evaluation.synthetic.timing.films import timing_clip


@dataclass(frozen=True)
class UnitClip:
    """Shares of energy; the truth's intensity is .8, its energy outside is none."""

    clip: str
    unit: str
    intensity: float
    inside_explained: float
    outside: float
    outside_significant: float
    outside_far: float
    rank_one: float


def score_units(which: str, kept: KeptCaptures) -> list[UnitClip]:
    template = load_template()
    scores = []
    for recipe in SETS[which]:
        render = partial(timing_clip, recipe, template, kept.report, unit_motion)
        performance = kept.of(recipe.name, render)
        scores.append(score_unit(recipe.name, recipe.phases[0].control, performance))
    return scores


def score_unit(name: str, unit: str, performance: Performance) -> UnitClip:
    """The strongest event of the unit's group beside the unit."""
    comparison = compare(
        analyse_timing(performance, kinds=("group",)), unit, load_template(), only_certain=False
    )
    spatial = comparison.spatial
    return UnitClip(
        *(name, unit, spatial.intensity, spatial.inside_explained, spatial.outside_share),
        *(spatial.outside_significant_share, spatial.outside_far_share),
        comparison.temporal.rank_one_share,
    )


def unit_rows(scores: list[UnitClip]) -> list[tuple[str, str]]:
    return [
        (
            f"{one.unit} alone, {one.clip}",
            f"energy outside {_percent(one.outside)} ({_percent(one.outside_far)} farther than "
            f"15 mm, {_percent(one.outside_significant)} of what is significant), "
            f"intensity {one.intensity:.2f} (truth .8), "
            f"explained inside {one.inside_explained:.2f}",
        )
        for one in scores
    ]


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if math.isfinite(share) else "none"
