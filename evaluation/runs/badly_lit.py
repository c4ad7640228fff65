# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads fitted to real faces in bad light, beside marks made by hand.

    python -m evaluation.runs.badly_lit [--frames-a-clip N]

Of each marked clip frames spread over it are darkened as a whole, or to the right of the face and
then to the left of it, as a lamp at the other side would leave them, down to a share of their
light; shown in light of nearly one colour, and through fog that leaves a share of the contrast;
noise of a camera is added. Prints how many are made brighter for what looks at the face, in
how many a head is fitted and how far it lies from the marks, and, where scripts/face_mesh_env
works, the same of MediaPipe's mesh in its mode for stills.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from mimetic import _core
from mimetic.fit.fitting import judge_frame
from mimetic.media.footage import Footage
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.real_labels import CLIPS, POINTS, Labels, footage_of, read_labels
from evaluation.runs.real_methods import (
    REFINED_MESH_POINTS,
    face_meshes_of_stills,
    fitted_points,
)
from evaluation.runs.real_score import FACE_MESH, FEATURES, FIRST_FIT, in_face_frame
from evaluation.synthetic.noise import smoothstep

SHARES = (0.4, 0.2, 0.1, 0.05)  # of the light that is left
# Gains of red, green and blue
COLOURS = {"red": (1.0, 0.05, 0.03), "blue": (0.03, 0.05, 1.0), "deep blue": (0.0, 0.02, 0.9)}
CONTRASTS = (0.25, 0.12, 0.06)  # shares of it that are left
FOG = 190  # grey level that it is on
SOFTNESS = 0.55  # interpupillary distances over which light falls off
NOISE = 1.5  # grey levels
FAR = 12.0  # % of the interpupillary distance: a fit whose points lie as far on the mean is wrong
COLUMNS = {
    "raised": ("made brighter", ".0%"),
    "fitted": ("faces", ".0%"),
    "wrong": ("of them wrong", ".0%"),
    **{feature: (feature, ".1f") for feature in FEATURES},
}


@dataclass(frozen=True)
class Shown:
    """A picture of a marked frame, and the row of the labels that it belongs to."""

    light: str
    image: NDArray[np.uint8]
    labels: Labels  # of this frame alone


def beyond(labels: Labels, width: int) -> NDArray[np.float64]:
    """Of each column of a picture, how far it is to the right of a marked face's middle, 0 to 1."""
    middle = float(np.nanmean(labels.places[0, :, 0]))
    softness = SOFTNESS * float(labels.ipd[0])
    return smoothstep(middle - softness / 2, middle + softness / 2, np.arange(width))


def lights(labels: Labels, image: NDArray[np.uint8]) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Each light by name, and the picture in it, H x W x 3, not rounded."""
    right = beyond(labels, image.shape[1])[:, None]
    for share in SHARES:
        yield f"{share:g} of the light", image * share
    for share in SHARES:
        for side in (right, 1 - right):
            yield f"{share:g} of it on one side", image * (1 + (share - 1) * side)
    for colour, gains in COLOURS.items():
        yield f"{colour} light", image * np.array(gains)
    for share in CONTRASTS:
        yield f"fog, {share:g} of the contrast", image * share + FOG


def pictures(frames_a_clip: int) -> Iterator[Shown]:
    """All that is shown to the methods; raises InvalidInput where a clip was not fetched."""
    noise = np.random.default_rng(7)
    for clip in CLIPS:
        footage, labels = Footage(footage_of(clip)), read_labels(clip)
        assert labels is not None
        for row in np.unique(np.linspace(0, len(labels.frame) - 1, frames_a_clip).astype(int)):
            own = labels.rows(np.arange(len(labels.frame)) == row)
            image = footage.read(int(own.frame[0]))
            yield Shown("as filmed", image, own)
            for light, lit in lights(own, image):
                noisy = lit + noise.normal(0, NOISE, image.shape)
                yield Shown(light, np.clip(np.round(noisy), 0, 255).astype(np.uint8), own)


def is_raised(image: NDArray[np.uint8]) -> bool:
    """Whether finders and networks are shown another picture of the face that is found in it."""
    found = judge_frame(image)
    return found is not None and _core.well_lit(image, found.features) is not image


def figures(shown: list[Shown], places: list[NDArray[np.float64]]) -> dict[str, float]:
    """Of one method in pictures of one light. places: POINTS x 2 each, nan where it sees none."""
    off = np.concatenate(
        [
            in_face_frame(one.labels, seen[None] - one.labels.places)
            for one, seen in zip(shown, places, strict=True)
        ]
    )
    sizes = np.linalg.norm(off, axis=2)
    is_fitted = np.array([np.isfinite(seen).all() for seen in places])
    is_wrong = np.nanmean(sizes[is_fitted], axis=1) > FAR
    medians = {
        feature: float(np.nanmedian(sizes[:, [POINTS.index(name) for name in names]]))
        for feature, names in FEATURES.items()
    }
    return {"fitted": is_fitted.mean(), "wrong": is_wrong.mean(), **medians}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.badly_lit", description=__doc__)
    parser.add_argument("--frames-a-clip", type=int, default=4, help="default: 4")
    options = parser.parse_args(arguments)
    shown = list(pictures(options.frames_a_clip))
    print(f"{len(shown)} pictures", file=sys.stderr)
    places = {FIRST_FIT: [fitted_points(one.image) for one in shown]}
    if (python := face_mesh_python(lambda text: print(text, file=sys.stderr))) is not None:
        meshes = face_meshes_of_stills([one.image for one in shown], python)
        places[FACE_MESH] = list(meshes[:, [REFINED_MESH_POINTS[name] for name in POINTS]])
    for light in dict.fromkeys(one.light for one in shown):
        chosen = [i for i, one in enumerate(shown) if one.light == light]
        rows = {
            method: figures([shown[i] for i in chosen], [seen[i] for i in chosen])
            for method, seen in places.items()
        }
        rows[FIRST_FIT]["raised"] = np.mean([is_raised(shown[i].image) for i in chosen])
        print(text_table(f"{light}: {len(chosen)} pictures", COLUMNS, rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
