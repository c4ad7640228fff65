# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's skin and muscles from a few seconds of footage, by evidence.

The capture tells where the skin was seen; the factors of a `Calibration` are those under which
that is most probable, with muscles, pose and model error integrated out and a log-normal prior
about 1 on every factor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.muscles.articulators import JAW
from mimetic.muscles.calibration import LEAST, MOST, REGIONS, Calibration
from mimetic.muscles.response import ResponsiveModes, SkinResponse
from mimetic.skin.mesh import SkinMesh
from mimetic.solve.evidence import LARGEST_STEP, LinearFrame, Peak, linear_frame, maximise
from mimetic.solve.sightings import Sighting, Whitened, at_points, weigh, whiten
from mimetic.solve.tracking import ARTICULATOR_STD

Floats = NDArray[np.float64]
STIFFNESS_STD, STRENGTH_STD = 0.5, 0.2  # of the logarithms: priors
INSERTION_STD_MM = 2.0  # along either axis: prior
INSERTION_UNIT = 4.0  # mm
ACTIVATION_STD = 0.5  # of a muscle that is seen at work
AT_WORK = 0.05  # a smaller value counts as at rest
LEAST_PEAK = 0.15  # of an activation: less tells nothing of the muscle's strength
MOST_FRAMES = 8
# Root sum of squares of activations and jaw: of an expression, and between frames that count as
# different where expressions are strong; half the strongest where they are weak.
LEAST_SEEN, LEAST_APART = 0.15, 0.5
MOST_ROUNDS = 3
SETTLED = 0.03  # change of a logarithm
# With more of its prior's standard deviation left, a factor is not informed and stays at 1.
UNINFORMED = 0.9


@dataclass(frozen=True)
class Found:
    """A calibration with what supports it.

    stiffness_std, strength_std: of the logarithms, by name, of every factor that was asked for;
    gain: of the logarithm of the evidence, priors included, over all factors at 1.
    """

    calibration: Calibration
    stiffness_std: dict[str, float]
    strength_std: dict[str, float]
    gain: float


class NothingSeen(InvalidInput):
    """The footage shows too little motion to tell anything; the text says so."""


def choose(sightings: Sequence[Sighting], num_moving: int) -> list[Sighting]:
    """The frames that show most and differ most; raises NothingSeen.

    num_moving: the first so many values count, muscles and jaw; lids move no skin that is measured.
    """
    values = np.array([sighting.values[:num_moving] for sighting in sightings])
    largest = np.linalg.norm(values, axis=1).max() if len(values) else 0.0
    if largest < LEAST_SEEN:
        raise NothingSeen(
            "no expression was seen, so that skin and muscles cannot be told: all factors stay at "
            "1; choose frames in which the face moves (--frames A:B), best every part of it"
        )
    away = np.linalg.norm(values, axis=1)  # from rest, which tells nothing
    chosen: list[int] = []
    apart = min(LEAST_APART, largest / 2)
    while len(chosen) < MOST_FRAMES and away.max() >= apart:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, np.linalg.norm(values - values[chosen[-1]], axis=1))
    return [sightings[i] for i in sorted(chosen)]


def estimate(
    mesh: SkinMesh,
    sightings: Sequence[Sighting],
    intrinsics: Floats,
    reference: Floats,
    progress: Callable[[float], bool] | None = None,
) -> Found:
    """The most probable calibration.

    mesh: of the fitted head; sightings: of a capture without a calibration; intrinsics: 3 x 3,
    pixels; reference: 4 x 4, pose of the fitted frame; progress: called with a fraction, False
    raises KeyboardInterrupt. Raises NothingSeen.
    """
    response = SkinResponse(mesh)
    chosen = choose(sightings, len(response.names) + len(JAW))
    peaks = np.max([one.values[: len(response.names)] for one in chosen], axis=0)
    asked = Parameters(response.names, tuple(np.flatnonzero(peaks > LEAST_PEAK)))
    place = np.zeros(len(asked.prior))
    seen: list[Whitened] = []
    first = 0.0
    for turn in range(MOST_ROUNDS):
        if progress and not progress(turn / MOST_ROUNDS):
            raise KeyboardInterrupt
        modes = response.evaluate(asked.about(place), asked.strong)
        if turn == 0:
            seen = [_whitened(mesh, one, modes.modes, intrinsics, reference) for one in chosen]
        frames = [_linear(mesh, one, modes, response) for one in seen]
        problem = _Problem(frames, asked, place, len(modes.modes))
        if turn == 0:
            first = problem.height(place)
        peak = maximise(problem.height, place, LARGEST_STEP)
        settled = np.abs(peak.place - place).max() < SETTLED
        place = peak.place
        if settled:
            break
    return _found(peak, asked, chosen, first)


@dataclass(frozen=True)
class Parameters:
    """What is asked for, as one vector: logarithms of the stiffness by region, of the strength of
    each strong muscle, and its insertion, away from the midline and up, in INSERTION_UNIT.

    names: of all muscles; strong: indices of those that are seen at work.
    """

    names: tuple[str, ...]
    strong: tuple[int, ...]

    @property
    def prior(self) -> Floats:
        """Standard deviations about 0."""
        kinds = [STIFFNESS_STD] * len(REGIONS) + [STRENGTH_STD] * len(self.strong)
        return np.array(kinds + [INSERTION_STD_MM / INSERTION_UNIT] * 2 * len(self.strong))

    def split(self, place: Floats) -> tuple[Floats, Floats, Floats]:
        """Stiffness (R), strength (n), insertion (2 x n, millimetres)."""
        count, num = len(REGIONS), len(self.strong)
        shifts = INSERTION_UNIT * place[count + num :].reshape(2, num)
        return place[:count], place[count : count + num], shifts

    def about(self, place: Floats) -> Calibration:
        """That of the skin and the insertions alone: in strengths, modes are linear anyway."""
        count, num = len(REGIONS), len(self.strong)
        skin = place.copy()
        skin[count : count + num] = 0
        return self.calibration(skin, [], np.ones(len(place)))

    def calibration(self, place: Floats, frames: list[int], informed: NDArray) -> Calibration:
        stiffness, strength, shifts = self.split(place)
        of_stiffness, of_strength, of_shifts = self.split(informed.astype(float))
        muscles = [self.names[i] for i in self.strong]

        def factors(names, logs: Floats, known: Floats) -> dict[str, float]:
            values = np.clip(np.exp(logs), LEAST, MOST).tolist()
            return {n: v for n, v, k in zip(names, values, known, strict=True) if k}

        shown = of_shifts.any(axis=0)
        return Calibration(
            factors(REGIONS, stiffness, of_stiffness),
            factors(muscles, strength, of_strength),
            {n: (x, y) for n, x, y, k in zip(muscles, *shifts.tolist(), shown, strict=True) if k},
            frames,
        )


@dataclass(frozen=True)
class _Problem:
    """The logarithm of evidence and priors by the parameters, near `base`."""

    frames: list[LinearFrame]
    asked: Parameters
    base: Floats
    num_values: int

    def height(self, place: Floats) -> float:
        stiffness, _, shifts = self.asked.split(place - self.base)
        strength = np.zeros(self.num_values)
        shares = np.zeros((1 + len(stiffness) + 2, self.num_values))
        shares[0] = 1
        shares[1:-2] = stiffness[:, None]
        strong = list(self.asked.strong)
        shares[-2:, strong] = shifts
        strength[strong] = self.asked.split(place)[1]
        told = sum(frame.log_evidence(shares, strength) for frame in self.frames)
        return told - 0.5 * float(((place / self.asked.prior) ** 2).sum())


def _whitened(
    mesh: SkinMesh, sighting: Sighting, modes: Floats, intrinsics: Floats, reference: Floats
) -> Whitened:
    """modes: those that the capture used, M x S x 3."""
    neutral = mesh.neutral[None, : modes.shape[1]]
    rest, by_mode = (
        at_points(mesh, sighting.vertices, sighting.barycentric, one) for one in (neutral, modes)
    )
    return whiten(sighting, weigh(sighting, rest[:, :, 0], by_mode, intrinsics, reference))


def _linear(
    mesh: SkinMesh, seen: Whitened, found: ResponsiveModes, response: SkinResponse
) -> LinearFrame:
    """A frame's equations in the values at work there, the others being at rest."""
    columns = np.concatenate([found.modes[None], found.by_stiffness, found.by_insertion])
    std = [ACTIVATION_STD] * len(response.names)
    std += [ARTICULATOR_STD[name.split(".")[0]] for name in response.articulators]
    free = np.flatnonzero(np.abs(seen.sighting.values) > AT_WORK)
    moving = columns[:, free].reshape(-1, *columns.shape[2:])
    rows = at_points(mesh, seen.sighting.vertices, seen.sighting.barycentric, moving)
    rows = seen.by_point @ rows.reshape(-1, rows.shape[2])
    return linear_frame(rows, seen.displacement, free, np.array(std)[free])


def _found(peak: Peak, asked: Parameters, chosen: list[Sighting], first: float) -> Found:
    informed = peak.std < UNINFORMED * asked.prior
    place = np.where(informed, peak.place, 0.0)
    calibration = asked.calibration(place, [one.frame for one in chosen], informed)
    stiffness, strength, _ = asked.split(peak.std)
    muscles = [asked.names[i] for i in asked.strong]
    return Found(
        calibration,
        dict(zip(REGIONS, stiffness.tolist(), strict=True)),
        dict(zip(muscles, strength.tolist(), strict=True)),
        peak.height - first,
    )
