# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the reduced skin in time is from the whole one, on what is seen at 30 frames a second.

    python -m evaluation.anatomy.motion_table [--modes N ...] [--seconds S]

Both take steps of 1/240 s from the same activations: a smile, a brow flash, speech, a startle. The
difference is the largest over frames of the RMS over all visible vertices, over the same of the
motion; its largest single vertex is in millimetres. `static` is the response without mass, damping
and relaxation.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass

import numpy as np
from mimetic.muscles.articulators import smooth_step
from mimetic.muscles.motion import SUBSTEPS, LoadedSkin, dynamics_options, load_skin, substeps
from mimetic.skin.mesh import multiply

FPS = 30
# Clip: actuator (both sides of a pair): onset, rise, hold, fall in seconds, amplitude
CLIPS = {
    "smile": {
        "zygomaticus_major": (0.1, 0.5, 0.6, 0.6, 0.9),
        "zygomaticus_minor": (0.15, 0.5, 0.5, 0.6, 0.5),
        "orbicularis_oculi_lateral": (0.2, 0.4, 0.6, 0.5, 0.7),
    },
    "brow flash": {
        "frontalis_medial": (0.1, 0.1, 0.15, 0.15, 1.0),
        "frontalis_middle": (0.1, 0.1, 0.15, 0.15, 1.0),
        "frontalis_lateral": (0.1, 0.1, 0.15, 0.15, 1.0),
    },
    "speech": {
        "jaw_open": (0.05, 0.1, 0.02, 0.1, 0.4),
        "orbicularis_oris": (0.3, 0.08, 0.05, 0.1, 0.8),
        "depressor_labii_inferioris": (0.5, 0.07, 0.0, 0.08, 0.7),
        "levator_labii_superioris": (0.65, 0.07, 0.02, 0.1, 0.5),
        "risorius": (0.8, 0.08, 0.05, 0.1, 0.6),
    },
    "startle": {
        "risorius": (0.1, 1 / 30, 0.1, 0.3, 1.0),
        "corrugator_supercilii": (0.1, 1 / 30, 0.1, 0.3, 1.0),
        "orbicularis_oculi_inferior": (0.1, 1 / 30, 0.1, 0.3, 1.0),
        "jaw_open": (0.1, 2 / 30, 0.1, 0.3, 0.3),
    },
}


def clip_values(clip: str, names: tuple[str, ...], seconds: float) -> np.ndarray:
    """Values of a clip, frames x L."""
    times = np.arange(round(seconds * FPS) + 1) / FPS
    values = np.zeros((len(times), len(names)))
    for actuator, (onset, rise, hold, fall, amplitude) in CLIPS[clip].items():
        up = smooth_step((times - onset) / rise)
        down = smooth_step((times - onset - rise - hold) / fall)
        for column, name in enumerate(names):
            if name.split(".")[0] == actuator:
                values[:, column] = amplitude * (up - down)
    return values


def visible_motion(skin: LoadedSkin, advance, values: np.ndarray) -> np.ndarray:
    """Displacements of the visible vertices, frames x K x 3; advance: L values -> 3C unknowns."""
    stencils = skin.visible_stencils()
    frames = []
    for i, now in enumerate(substeps(values)[1:], 1):
        unknowns = advance(now)
        if i % SUBSTEPS == 0:
            frames.append(multiply(stencils, unknowns.reshape(-1, 3)))
    return np.array(frames)


@dataclass(frozen=True)
class Difference:
    """share: RMS over vertices, worst frame, of the motion's; largest_mm: one vertex, any frame."""

    share: float
    largest_mm: float


def difference(motion: np.ndarray, truth: np.ndarray) -> Difference:
    def worst_frame(field):
        return np.sqrt((field**2).sum(axis=2).mean(axis=1)).max()

    return Difference(
        worst_frame(motion - truth) / worst_frame(truth),
        1e3 * np.linalg.norm(motion - truth, axis=2).max(),
    )


def compare(skin: LoadedSkin, values: np.ndarray, mode_counts: list[int]) -> list[Difference]:
    """Of the static response and of the reduced skin with each count of modes."""
    options = dynamics_options()
    whole = skin.dynamics(options)
    truth = visible_motion(skin, lambda now: whole.advance(skin.loads @ now), values)
    responses = skin.skin.model.solve(skin.forces.reshape(len(skin.forces), -1).T)
    errors = [difference(visible_motion(skin, lambda now: responses @ now, values), truth)]
    for count in mode_counts:
        reduced_skin = skin.reduced(options, count)
        shapes = reduced_skin.shapes
        motion = visible_motion(
            skin, lambda now, r=reduced_skin, s=shapes: s @ r.advance(now), values
        )
        errors.append(difference(motion, truth))
    return errors


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m evaluation.anatomy.motion_table")
    parser.add_argument("--modes", type=int, nargs="+", default=[0, 8, 32])
    parser.add_argument("--seconds", type=float, default=2.0)
    options = parser.parse_args(arguments)
    if not 0.1 <= options.seconds <= 60 or not all(0 <= n <= 500 for n in options.modes):
        print("motion_table: --seconds is 0.1 to 60, --modes 0 to 500 each", file=sys.stderr)
        return 2
    from mimetic.template.face_template import load_template

    template = load_template()
    skin = load_skin(template.vertices, template)
    heads = ["static", *(f"{n} modes" for n in options.modes)]
    print(f"{'clip':12}" + "".join(f"{head:>20}" for head in heads))
    for clip in CLIPS:
        start = time.perf_counter()
        errors = compare(skin, clip_values(clip, skin.names, options.seconds), options.modes)
        cells = (f"{100 * d.share:8.3f} % {d.largest_mm:6.3f} mm" for d in errors)
        print(f"{clip:12}" + "".join(f"{cell:>20}" for cell in cells), flush=True)
        print(f"  {time.perf_counter() - start:.1f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
