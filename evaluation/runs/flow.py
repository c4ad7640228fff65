# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate flow`: whether the covariances of optical flow are right.

Flow from frame to frame is compared with the true motion of the skin's points. Its normalised
error e' C^-1 e has the mean 2 where the covariance C is right, whatever its size: so it is
tabulated by decile of the uncertainty.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from mimetic._core import FlowMethod, FlowOptions, compute_flow
from mimetic.media.footage import Footage
from mimetic.score.json_text import json_text
from mimetic.score.luminance import GREY
from mimetic.score.sampling import sampled
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from numpy.typing import NDArray

from evaluation.runs.rendered import clips

METHODS = ("probabilistic", "dis")
STEPS = (1, 4)  # frames from one image to the other
DECILES = 10
MEDIAN_OF_TWO = 2 * math.log(2)  # median of chi squared with two degrees of freedom
COLUMNS = {
    "std": ("own s.d. px", ".3f"),
    "rms": ("error rms px", ".3f"),
    "median": ("error median px", ".3f"),
    "normalised": ("normalised", ".2f"),
    "typical": ("from median", ".2f"),
}


@dataclass(frozen=True)
class FlowErrors:
    """K measurements of one method: squared own s.d. an axis, error, normalised squared error."""

    variance: NDArray[np.float64]
    error: NDArray[np.float64]  # pixels
    normalised: NDArray[np.float64]


def score_flow(which: str, report: Callable[[str], None]) -> dict[str, FlowErrors]:
    """By method and step, over all clips of a set."""
    errors_by_method: dict[str, list[FlowErrors]] = {}
    for clip in clips(which, report):
        report(f"{clip.name}: flow")
        truth = Truth.load(clip.truth)
        greys = [np.round(image @ GREY).astype(np.uint8) for _, image in Footage(clip.footage)]
        for method in METHODS:
            for step in STEPS:
                name = f"{method}, {step} frame{'s' if step > 1 else ''}"
                errors_by_method.setdefault(name, []).extend(
                    flow_errors(truth, greys, method, step)
                )
    return {
        name: FlowErrors(
            *(np.concatenate([getattr(e, k) for e in errors]) for k in vars(errors[0]))
        )
        for name, errors in errors_by_method.items()
    }


def flow_errors(
    truth: Truth, greys: list[NDArray[np.uint8]], method: str, step: int
) -> Iterable[FlowErrors]:
    """Pair by pair, at the truth's points that are seen in both frames (no two pairs overlap)."""
    options = FlowOptions()
    options.method = getattr(FlowMethod, method)
    for i in range(0, len(greys) - step, step):
        is_visible = truth.visible[i] & truth.visible[i + step]
        at = truth.tracks[i, is_visible]
        field = compute_flow(greys[i], greys[i + step], options)
        off = sampled(np.asarray(field.flow), at) - (truth.tracks[i + step, is_visible] - at)
        xx, xy, yy = sampled(np.asarray(field.covariance), at).astype(np.float64).T
        determinant = xx * yy - xy**2
        quadratic = yy * off[:, 0] ** 2 - 2 * xy * off[:, 0] * off[:, 1] + xx * off[:, 1] ** 2
        error = np.linalg.norm(off, axis=1)
        yield FlowErrors((xx + yy) / 2, error, quadratic / determinant)


def by_decile(errors: FlowErrors) -> dict[str, dict[str, float]]:
    """From the surest tenth of the measurements to the least sure, and all."""
    order = np.argsort(errors.variance)
    parts = {f"tenth {i + 1}": rows for i, rows in enumerate(np.array_split(order, DECILES))}
    parts["all"] = order
    return {
        name: {
            "std": float(np.sqrt(errors.variance[rows].mean())),
            "rms": float(np.sqrt((errors.error[rows] ** 2).mean() / 2)),
            "median": float(np.median(errors.error[rows])),
            "normalised": float(errors.normalised[rows].mean()),
            "typical": float(2 * np.median(errors.normalised[rows]) / MEDIAN_OF_TWO),
        }
        for name, rows in parts.items()
    }


def as_text(errors: dict[str, FlowErrors]) -> str:
    """rms: an axis, as the s.d. is. from median: what the mean would be without outliers."""
    return "\n\n".join(text_table(name, COLUMNS, by_decile(e), 17) for name, e in errors.items())


def as_json(errors_by_method: dict[str, FlowErrors]) -> str:
    return json_text({name: by_decile(errors) for name, errors in errors_by_method.items()})
