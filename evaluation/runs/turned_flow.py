# SPDX-License-Identifier: GPL-3.0-or-later
"""How far from its true place the skin of drawn people is measured, by how far the head is turned.

    .venv/bin/python -m evaluation.runs.turned_flow \\
        --tracker crop_height=300 sample_spacing=6 --tracker crop_height=400 sample_spacing=8

The swung people of `--set full-tuning` (or `consistency-tuning`), followed from their fits by one
reference texture, as a relief is looked for. The first row is the tracker as it is. Counted are
frames at rest; the true place of a measured point lies between those of the truth's points.
Printed by turn since the fitted frame: median and root mean square distance, pixels, also of the
points that the fitted frame shows head-on (cosine of normal and view above .7).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.tri import LinearTriInterpolator, Triangulation
from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy, factored_skin, modes_of
from mimetic.score.json_text import json_text
from mimetic.score.scores import project
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.skin.mesh import SkinMesh
from mimetic.solve import clip_capture, tracking
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.progress import to_stderr
from evaluation.runs.ablations import Variant, variant_of
from evaluation.runs.expressions import Take, seen_at_start, takes
from evaluation.runs.settings import AS_IT_IS

SETS = ("full-tuning", "consistency-tuning")
SWUNG = "turning"
TURNS = (0.0, 5.0, 10.0, 15.0, 30.0)  # degrees
AT_REST = 0.6e-3  # metres, that no point of the truth has moved by more
HEAD_ON = 0.7  # cosine
COLUMNS = {
    "frames": ("frames", ".0f"),
    "median": ("median px", ".2f"),
    "rms": ("rms px", ".2f"),
    "head_on_median": ("head-on median", ".2f"),
    "head_on_rms": ("head-on rms", ".2f"),
}


@dataclass(frozen=True)
class Person:
    """One clip with its truth and its fit."""

    footage: Footage
    truth: Truth
    fit: FaceFit
    mesh: SkinMesh
    anatomy: Anatomy

    @classmethod
    def of(cls, take: Take) -> Person:
        fit, template = clip_capture.find_face(take.clip.footage), load_template()
        skin = factored_skin(fit.neutral_vertices(template), template, fit.calibration, None)
        assert skin is not None  # nothing says to stop
        truth = seen_at_start(Truth.load(take.clip.truth))
        return cls(Footage(take.clip.footage), truth, fit, skin.mesh, modes_of(skin))


@dataclass(frozen=True)
class Measured:
    """Errors of K points in one frame."""

    turn: float  # degrees, since the fitted frame
    distance: NDArray[np.float64]  # K, pixels
    cosine: NDArray[np.float64]  # K, of normal and view in the fitted frame


def measured(person: Person, variant: Variant) -> Iterator[Measured]:
    """Of the frames at rest."""
    truth, at = person.truth, person.fit.frame - 1
    moved = np.linalg.norm(truth.points - truth.points[:1], axis=2).max(1)
    turns = np.degrees(np.ravel(_core.angles_from(truth.head_pose, truth.head_pose[at])))
    between = Triangulation(*truth.tracks[at].T)
    for sighting in _sightings(person, variant):
        i = sighting.frame - 1
        if moved[i] > AT_REST:
            continue
        pixels, cosine = _in_fitted_frame(person, sighting)
        motion = truth.tracks[i] - truth.tracks[at]
        true_motion = np.ma.stack(
            [LinearTriInterpolator(between, motion[:, axis])(*pixels.T) for axis in (0, 1)], axis=1
        ).filled(np.nan)
        distance = np.linalg.norm(np.asarray(sighting.pixels) - pixels - true_motion, axis=1)
        is_known = np.isfinite(distance)
        yield Measured(float(turns[i]), distance[is_known], cosine[is_known])


def _sightings(person: Person, variant: Variant) -> Iterator[_core.Sighting]:
    """From the fitted frame to the clip's ends."""
    options = variant.tracker_options()
    options.max_key_views = 0
    template, fit = load_template(), person.fit
    motion = tracking.face_motion(fit.neutral_vertices(template), template, person.anatomy)
    images = [np.ascontiguousarray(image) for _, image in person.footage]
    reference = images[fit.frame - 1]
    tracker = tracking.make_tracker(reference, fit, template, person.anatomy, motion, options)
    at_reference = tracker.advance(reference)
    for frames in (range(fit.frame + 1, len(images) + 1), range(fit.frame - 1, 0, -1)):
        tracker.restart(reference, at_reference)
        for frame in frames:
            estimate = tracker.advance(images[frame - 1])
            if not estimate.held:
                yield _core.Sighting.of(frame, estimate, tracker.observations())


def _in_fitted_frame(
    person: Person, sighting: _core.Sighting
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pixels (K, 2) of a sighting's points there, and cosines of their normals with the view."""
    under = _core.SkinPlaces(sighting.vertices, sighting.barycentric)
    fit, places = person.fit, under.positions(person.mesh.vertices)
    normals = under.values(person.mesh.normals)
    views = -fit.head_pose[:3, 3] @ fit.head_pose[:3, :3] - places
    cosine = (views * normals).sum(1)
    cosine /= np.linalg.norm(views, axis=1) * np.linalg.norm(normals, axis=1)
    return project(places, fit.head_pose, fit.intrinsics), cosine


def figures(frames: Sequence[Measured]) -> dict[str, float]:
    distance = np.concatenate([frame.distance for frame in frames])
    head_on = distance[np.concatenate([frame.cosine for frame in frames]) > HEAD_ON]
    return {
        "frames": float(len(frames)),
        "median": float(np.median(distance)),
        "rms": float(np.sqrt(np.mean(distance**2))),
        "head_on_median": float(np.median(head_on)),
        "head_on_rms": float(np.sqrt(np.mean(head_on**2))),
    }


def by_turn(frames: Sequence[Measured]) -> dict[str, dict[str, float]]:
    """Figures of the frames between two turns each, if there are any."""
    rows = {}
    for low, high in pairwise(TURNS):
        if some := [frame for frame in frames if low <= frame.turn < high]:
            rows[f"{low:.0f} to {high:.0f} degrees"] = figures(some)
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.turned_flow", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--set", choices=SETS, default=SETS[0])
    parser.add_argument(
        "--tracker", nargs="+", action="append", default=[], metavar="NAME=VALUE", help="a row more"
    )
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    tables: dict[str, dict[str, dict[str, float]]] = {}
    try:
        variants = {AS_IT_IS: Variant()}
        variants |= {" ".join(words): variant_of(words) for words in options.tracker}
        swung = [take for take in takes(options.set, None, to_stderr)[0] if take.head == SWUNG]
        people = [Person.of(take) for take in swung]
        for name, variant in variants.items():
            to_stderr(name)
            tables[name] = by_turn([one for person in people for one in measured(person, variant)])
    except (InvalidInput, OSError) as error:
        print(f"turned_flow: {error}", file=sys.stderr)
        return 2
    if options.json:
        print(json_text(tables))
    else:
        print("\n\n".join(text_table(name, COLUMNS, rows) for name, rows in tables.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
