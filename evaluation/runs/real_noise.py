# SPDX-License-Identifier: GPL-3.0-or-later
"""What the networks' points are off by, in sides of their crops: for locate/feature_noise.hpp.

*Jitter*: standard deviation where the face keeps still, the pose's motion removed; independent from
frame to frame. *Error*: what is left beside the marked points once the person's bias is known,
the 68th percentile; it stays while pose and expression do, and the marking's own error is in it.
Both along the line of the eye or the mouth and across it; along margins nothing is marked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic import _core
from mimetic.performance.document import Performance
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.real_labels import POINTS, Labels
from evaluation.runs.real_score import without_bias
from evaluation.runs.real_still import crops_of, in_crops, jitter

POINTS_OF = {
    "upper_lid": ("lid_upper.R", "lid_upper.L"),
    "lower_lid": ("lid_lower.R", "lid_lower.L"),
    "eye_corner": tuple(f"eye_{part}.{side}" for side in "RL" for part in ("outer", "inner")),
    "iris": ("iris.R", "iris.L"),
    "mouth_corner": ("mouth_corner.R", "mouth_corner.L"),
    "outer_lip": ("lip_outer_upper", "lip_outer_lower"),
    "inner_lip": ("lip_inner_upper", "lip_inner_lower"),
}
IN_EYES = ("upper_lid", "lower_lid", "iris")
MARGINS = ("upper_lid", "lower_lid", "outer_lip", "inner_lip")
SHRUNK = (1, 2, 4, 6)  # times, to see what small faces cost
ONE_DEVIATION = 0.683
KEYS = ("jitter", "error", "core jitter", "core error")


@dataclass(frozen=True)
class Sightings:
    """What the networks say of one clip, its picture made smaller, in sides of the crops."""

    times: int  # smaller
    sides: dict[str, float]  # of the crops, by feature; pixels, the median
    jitter: dict[str, NDArray[np.float64]]  # R x 2 variances, by feature
    errors: dict[str, NDArray[np.float64]]  # N x points x 2, the person's bias taken away


def sightings(
    every: Labels,
    performance: Performance,
    runs: NDArray[np.int64],
    places: NDArray[np.float64],
    times: int,
) -> Sightings:
    """places: N x POINTS x 2, pixels, of a picture so many times smaller. runs: R x RUN frames in
    which the face keeps still."""
    crops = crops_of(performance, every.frame)
    still = np.searchsorted(every.frame, runs)
    sides, jitters, errors = {}, {}, {}
    for feature, names in POINTS_OF.items():
        shares, off = [], []
        for name in names:
            own = [_crop(each, feature, name) for each in crops]
            at = POINTS.index(name)
            shares.append(in_crops(places[:, [at]], own))
            off.append(shares[-1] - in_crops(every.places[:, [at]], own))
            sides[feature] = float(np.median([crop.side for crop in own])) / times
        jitters[feature] = np.nanmean(jitter(np.concatenate(shares, axis=1)[still]), axis=1)
        errors[feature] = without_bias(np.concatenate(off, axis=1))
    return Sightings(times, sides, jitters, errors)


def _crop(crops: _core.FeatureCrops, feature: str, name: str) -> _core.FeatureCrop:
    return crops.eyes["LR".index(name[-1])] if feature in IN_EYES else crops.face


def noise_text(all_sightings: list[Sightings]) -> str:
    """All clips together, a table for each size of the picture; what the core says beside it."""
    return "\n\n".join(
        _table(times, [one for one in all_sightings if one.times == times])
        for times in sorted({one.times for one in all_sightings})
    )


def _table(times: int, all_sightings: list[Sightings]) -> str:
    columns = {"side": ("crop, px", ".0f")}
    for key in KEYS:
        columns[f"{key} 0"] = (f"{key} along", ".3f")
        columns[f"{key} 1"] = ("across", ".3f")
    rows = {}
    for feature in POINTS_OF:
        side = float(np.median([one.sides[feature] for one in all_sightings]))
        spread = np.sqrt(
            np.nanmedian(np.concatenate([one.jitter[feature] for one in all_sightings]), axis=0)
        )
        off = np.abs(np.concatenate([one.errors[feature].reshape(-1, 2) for one in all_sightings]))
        error = np.nanquantile(off, ONE_DEVIATION, axis=0)
        if feature in MARGINS:
            error[0] = np.nan
        ours = _core.feature_noise(feature, side)
        figures = (spread, error, ours.jitter, ours.error)
        rows[feature] = {"side": side} | {
            f"{key} {i}": 100 * pair[i]
            for key, pair in zip(KEYS, figures, strict=True)
            for i in range(2)
        }
    return text_table(f"networks, % of crop, picture 1/{times}", columns, rows, cell=18)
