# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate ablations`: the capture with one part at a time left out or set wrong."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, _core
from mimetic.fit.fitting import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import AnatomyPerturbation, attach_skin, modes_of
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.score import score
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture, smoothing, tracking
from mimetic.solve.capture_summary import CaptureSummary

from evaluation.runs.expressions import clips_of

COLUMNS = {
    "image": ("R2 image", ".3f"),
    "muscles": ("muscles alone", ".3f"),
    "surface": ("R2 in space", ".3f"),
    "groups": ("group corr.", ".3f"),
    "turn": ("turn deg", ".2f"),
    "held": ("in 90 % int.", ".3f"),
    "false": ("largest false", ".3f"),
}


@dataclass(frozen=True)
class Variant:
    """How a capture differs. tracker: TrackerOptions by name; stiffness: times the attachment."""

    tracker: dict[str, object] = field(default_factory=dict)
    smoothed: bool = True
    relief: bool = True
    lines: bool = True
    together: bool = True
    stiffness: float = 1.0

    def tracker_options(
        self, otherwise: _core.TrackerOptions | None = None
    ) -> _core.TrackerOptions:
        """These settings, and else those of `otherwise`, which is changed."""
        options = otherwise or _core.TrackerOptions()
        for name, value in self.tracker.items():
            setattr(options, name, value)
        return options


VARIANTS = {
    "as it is": Variant(),
    "no relief": Variant(relief=False),
    "lids and lips as in the first fit": Variant(lines=False),
    "no co-contraction": Variant(together=False),
    "no smoother": Variant(smoothed=False),
    "no flow between frames": Variant({"relative_flow": False}),
    "no further reference views": Variant({"max_key_views": 0}),
    "one iteration": Variant({"max_iterations": 1}),
    "probabilistic flow": Variant({"flow_method": _core.FlowMethod.probabilistic}),
    "image noise alone": Variant({"model_error": 1e-5, "shape_error": 1e-5}),
    "skin held twice as stiffly": Variant(stiffness=2.0),
    "skin held half as stiffly": Variant(stiffness=0.5),
}


def variant_of(settings: Iterable[str]) -> Variant:
    """TrackerOptions from words such as crop_height=400; raises InvalidInput."""
    options = _core.TrackerOptions()
    chosen: dict[str, object] = {}
    for setting in settings:
        name, _, text = setting.partition("=")
        default = getattr(options, name, None)
        if not isinstance(default, int | float):
            raise InvalidInput(f"--tracker {setting}: no number of TrackerOptions is called {name}")
        try:
            chosen[name] = type(default)(text)
        except ValueError:
            raise InvalidInput(f"--tracker {setting}: {text!r} is no number") from None
    return Variant(chosen)


class VariedCapture(clip_capture.ClipCapture):
    """The capture of a whole clip in one variant."""

    def __init__(self, footage: Footage, fit: FaceFit, variant: Variant) -> None:
        fit = fit if variant.relief else replace(fit, relief=[], depth=[], depth_std=[])
        fit = fit if variant.lines else replace(fit, lines=[])
        summary = CaptureSummary(fit=fit)
        super().__init__(footage, fit, (1, footage.num_frames), None, summary)
        self.variant = variant
        if variant.stiffness != 1:
            other = AnatomyPerturbation(stiffness_factor=variant.stiffness)
            self.anatomy = modes_of(attach_skin(self.neutral, self.template, other))
        if variant.stiffness != 1 or not variant.together:
            self.motion = tracking.face_motion(
                self.neutral,
                self.template,
                self.anatomy,
                self.detail,
                neutral_depth_std=fit.neutral_depth_std(self.template),
                together=variant.together,
            )

    def tracker_options(self, reference):
        return self.variant.tracker_options(super().tracker_options(reference))

    def smooth(self, estimates, before):
        if self.variant.smoothed:
            return super().smooth(estimates, before)
        return _as_they_are(estimates)


def _as_they_are(estimates) -> Iterator[smoothing.State]:
    last = None
    for frame, estimate in estimates:
        last = last if estimate is None else estimate
        if last is not None:
            yield smoothing.State(frame, last, held=estimate is None or estimate.held)


def capture_varied(path: Path, fit: FaceFit, variant: Variant) -> Performance:
    return VariedCapture(Footage(path), fit, variant).run()


def score_ablations(
    which: str, people: int | None, report: Callable[[str], None]
) -> dict[str, dict[str, float]]:
    """Figures by clip and variant; every variant of a clip starts from the same fit."""
    scores = {}
    for clip in clips_of(which, people, report):
        truth = Truth.load(clip.truth)
        if truth.units is None and truth.muscles is None:
            continue  # a still face
        fit = clip_capture.find_face(clip.footage)
        for name, variant in VARIANTS.items():
            report(f"{clip.name}: {name}")
            scores[f"{clip.name}: {name}"] = _figures(
                truth, capture_varied(clip.footage, fit, variant)
            )
    return scores


def _figures(truth: Truth, performance: Performance) -> dict[str, float]:
    result = score(truth, performance)
    groups = [curve["correlation"] for curve in result.groups.values()]
    image = {name: figures["nonrigid_r2"] for name, figures in result.image.items()}
    return {
        "image": image["mimetic"],
        "muscles": image.get("its muscles alone", math.nan),
        "surface": result.surface["r2"],
        "groups": statistics.median(groups) if groups else math.nan,
        "turn": float(np.mean([result.head[f"{axis}_deg"] for axis in ("pitch", "yaw", "roll")])),
        "held": result.overall.get("coverage_90", math.nan),
        "false": result.overall.get("largest_false", math.nan),
    }


def as_text(scores: dict[str, dict[str, float]]) -> str:
    return text_table("one part less", COLUMNS, scores)


def as_json(scores: dict[str, dict[str, float]]) -> str:
    variants = {name: str(asdict(variant)) for name, variant in VARIANTS.items()}
    return json_text({"variants": variants, "figures": scores})
