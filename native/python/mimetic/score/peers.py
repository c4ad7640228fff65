# SPDX-License-Identifier: GPL-3.0-or-later
"""Simple ways to follow points through footage, scored beside ours in the same table."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mimetic._core import FlowMethod, FlowOptions, compute_flow
from mimetic.score import luminance
from mimetic.score.sampling import sampled

GREY = luminance.GREY.astype(np.float32)


def dis_tracks(
    images: Iterable[NDArray[np.uint8]], start: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Tracks (N,K,2) of start pixels (K,2) by OpenCV's dense inverse search, two ways.

    `chain` adds up flow from frame to frame; `direct` takes flow from the first frame to each,
    started from the chained field: no drift, but it must bridge the whole motion at once.
    images: N RGB uint8 (H,W,3).
    """
    options = FlowOptions()
    options.method = FlowMethod.dis
    tracks: dict[str, list] = {"chained": [start], "direct": [start]}
    first = previous = np.zeros((0, 0), np.uint8)
    chain = np.zeros((0, 0, 2), np.float32)
    for image in images:
        grey = np.round(image @ GREY).astype(np.uint8)
        if not first.size:
            first = previous = grey
            chain = np.zeros((*grey.shape, 2), np.float32)
            continue
        step = np.asarray(compute_flow(previous, grey, options).flow)
        chain = np.ascontiguousarray(chain + sampled(step, _pixels(grey.shape) + chain))
        direct = np.asarray(compute_flow(first, grey, options, chain).flow)
        tracks["chained"].append(start + sampled(chain, start))
        tracks["direct"].append(start + sampled(direct, start))
        previous = grey
    return {name: np.array(rows, np.float64) for name, rows in tracks.items()}


def _pixels(shape: tuple[int, int]) -> NDArray[np.float32]:
    x, y = np.meshgrid(np.arange(shape[1]), np.arange(shape[0]))
    return np.stack([x, y], axis=2).astype(np.float32)
