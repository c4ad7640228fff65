# SPDX-License-Identifier: GPL-3.0-or-later
"""What smoothing of curves takes off real clips, and what it leaves of their motion.

python -m evaluation.runs.curve_smoothing [--performances DIR]   DIR has NAME.npz

Lids are smoothed here, too, to show what becomes of blinks.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from mimetic.character.curve_settings import CurveSettings, edited
from mimetic.character.sparse_curves import USUAL_TOLERANCE, count_keys
from mimetic.performance.document import Performance
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.real_captures import captured, kept_clips

WIDTHS = (0.0, 0.04, 0.08, 0.15, 0.3)  # seconds
LEAST_PEAK = 0.2  # of an activation, in curves whose peaks are looked at
BLINK = 0.6  # closure of a lid that is a blink


@dataclass(frozen=True)
class SmoothingScore:
    clip: str
    seconds: float
    frames: int
    jitter: float  # rms of second differences of all curves, of the captured ones'
    peaks: float  # of muscles' largest values, of the captured ones'; the median
    blinks: float  # of blinks' largest closures, of the captured ones'; the median
    keys: float  # few keys, of the dense ones
    milliseconds: float  # for the whole clip


def scores_of(clip: str, performance: Performance) -> Iterator[SmoothingScore]:
    lids = [i for i, name in enumerate(performance.articulators) if name.startswith("lid_upper")]
    peaks = performance.activations.max(axis=0)
    for seconds in WIDTHS:
        start = time.perf_counter()
        smooth = edited(performance, CurveSettings(smoothing=seconds, smooths_lids=True))
        elapsed = time.perf_counter() - start
        raw, now = (
            np.hstack([p.activations, p.articulator_values[:, lids]]) for p in (performance, smooth)
        )
        count = count_keys(smooth, USUAL_TOLERANCE)
        kept = smooth.activations.max(axis=0)[peaks > LEAST_PEAK] / peaks[peaks > LEAST_PEAK]
        blinks = [
            share
            for lid in lids
            for share in _blinks_kept(
                performance.articulator_values[:, lid], smooth.articulator_values[:, lid]
            )
        ]
        yield SmoothingScore(
            *(clip, seconds, performance.num_frames, _jitter(now) / _jitter(raw)),
            *(float(np.median(kept)), float(np.median(blinks)) if blinks else np.nan),
            *(count.few / count.dense, 1e3 * elapsed),
        )


def _jitter(values: NDArray[np.float64]) -> float:
    return float(np.sqrt((np.diff(values, n=2, axis=0) ** 2).mean()))


def _blinks_kept(raw: NDArray[np.float64], smooth: NDArray[np.float64]) -> list[float]:
    """Of each run of frames in which a lid is closed: its largest closure now, of before."""
    edges = np.flatnonzero(np.diff(np.r_[False, raw > BLINK, False])).reshape(-1, 2)
    return [float(smooth[a:b].max() / raw[a:b].max()) for a, b in edges]


def as_text(scores: list[SmoothingScore]) -> str:
    columns = {
        "frames": ("frames", ".0f"),
        "jitter": ("jitter left", ".0%"),
        "peaks": ("muscles' peaks", ".0%"),
        "blinks": ("blinks' peaks", ".0%"),
        "keys": ("few keys", ".1%"),
        "milliseconds": ("ms", ".0f"),
    }
    rows = {f"{score.clip}, {score.seconds:g} s": asdict(score) for score in scores}
    figures = {name: {key: row[key] for key in columns} for name, row in rows.items()}
    return text_table("curves smoothed", columns, figures)


def run(
    folder: Path | None, report: Callable[[str], None], last: int = 700
) -> list[SmoothingScore]:
    clips = kept_clips(folder)
    return [s for clip in clips for s in scores_of(clip, captured(clip, last, report, folder))]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--performances", type=Path, help="folder of NAME.npz")
    arguments = parser.parse_args()
    print(as_text(run(arguments.performances, lambda text: print(text, file=sys.stderr))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
