# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's skin and muscles from a few seconds of footage, by evidence.

The capture gives where the skin was seen; the factors of a `Calibration` are those under which
that is most probable, with muscles, pose and model error integrated out and a log-normal prior
about 1 on every factor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.muscles.articulators import JAW
from mimetic.muscles.calibration import LEAST, MOST, REGIONS, Calibration
from mimetic.muscles.response import ResponsiveModes, SkinResponse
from mimetic.skin.mesh import SkinMesh
from mimetic.solve.relief import fitted_skin
from mimetic.solve.tracking import ARTICULATOR_STD

Floats = NDArray[np.float64]
ACTIVATION_STD = 0.5  # of a muscle that is seen at work
AT_REST = 0.05  # up to it, a value counts as 0
LEAST_PEAK = 0.15  # of an activation: less says nothing of the muscle's strength
MOST_FRAMES = 8
# Root sum of squares of activations and jaw: of an expression, and between frames that count as
# different where expressions are strong; half the strongest where they are weak.
LEAST_SEEN, LEAST_APART = 0.15, 0.5
MOST_ROUNDS = 8
LARGEST_STEP = 0.4  # of a logarithm in one round: modes are linearised between rounds
# Change in a round, in standard deviations: below it what is linearised hardly matters, and some
# insertions go to and fro by .25 for ever.
SETTLED = 0.3
# With more of its prior's standard deviation left, a factor is not informed and stays at 1.
UNINFORMED = 0.9


@dataclass(frozen=True)
class CalibrationResult:
    """A calibration with what supports it.

    stiffness_std, strength_std: of the logarithms, by name, of every factor that was asked for;
    insertion_std: millimetres outwards and up, of the muscles of strength_std; gain: of the
    logarithm of the evidence, priors included, over all factors at 1; is_settled: whether the last
    round moved nothing by much, so that this is the maximum.
    """

    calibration: Calibration
    stiffness_std: dict[str, float]
    strength_std: dict[str, float]
    insertion_std: dict[str, tuple[float, float]]
    gain: float
    is_settled: bool = True


class NothingSeen(InvalidInput):
    """The footage shows too little motion for any estimate; the text says so."""


def choose(sightings: Sequence[_core.Sighting], num_moving: int) -> list[_core.Sighting]:
    """The frames that show most and differ most; raises NothingSeen.

    num_moving: the first so many values count, muscles and jaw; lids move no skin that is measured.
    """
    values = np.array([sighting.values[:num_moving] for sighting in sightings])
    values = np.vstack([np.zeros((1, num_moving)), values.reshape(-1, num_moving)])
    is_allowed = [True] * len(values)
    rest = [0]  # carries no information
    strongest = _core.spread_rows(values, rest, is_allowed, 2)[1:]
    largest = float(np.sqrt((values[strongest] ** 2).sum()))
    if largest < LEAST_SEEN:
        raise NothingSeen(
            "no expression was seen, so skin and muscles cannot be estimated: all factors stay at "
            "1; choose frames in which the face moves (--frames A:B), best every part of it"
        )
    apart = min(LEAST_APART, largest / 2)
    indices = _core.spread_rows(values, rest, is_allowed, 1 + MOST_FRAMES, apart)[1:]
    return [sightings[i - 1] for i in sorted(indices)]


def estimate(
    mesh: SkinMesh,
    sightings: Sequence[_core.Sighting],
    camera: _core.Camera,
    reference: Floats,
    progress: Callable[[float], bool] | None = None,
) -> CalibrationResult:
    """The most probable calibration.

    mesh: of the fitted head; sightings: of a capture without a calibration; reference: 4 x 4, pose
    of the fitted frame; progress: called with a fraction, False raises KeyboardInterrupt. Raises
    NothingSeen.
    """
    response = SkinResponse(mesh)
    skin = fitted_skin(mesh, camera, reference)
    selection = choose(sightings, len(response.names) + len(JAW))
    peaks = np.max([one.values[: len(response.names)] for one in selection], axis=0)
    strong = np.flatnonzero(peaks > LEAST_PEAK).tolist()
    num_values = len(response.names) + len(response.articulators)
    factors = Factors(response.names, _core.SkinFactors(len(REGIONS), strong, num_values))
    std = _prior_std(response)
    place = np.zeros(len(factors.prior))
    whitened_sightings: list[_core.WhitenedSighting] = []
    first, is_settled = 0.0, False

    def go_on(turn: int, fraction: float) -> bool:
        if progress and not progress((turn + fraction) / MOST_ROUNDS):
            raise KeyboardInterrupt
        return True

    for turn in range(MOST_ROUNDS):
        go_on(turn, 0.0)
        modes = response.evaluate(factors.about(place), strong)
        if turn == 0:
            own = np.ascontiguousarray(modes.modes)
            whitened_sightings = [_core.WhitenedSighting(skin, one, own) for one in selection]
        frames = _linear_frames(skin, whitened_sightings, modes, std)
        half = lambda fraction, turn=turn: go_on(turn, (1 + fraction) / 2)  # noqa: E731
        peak, before = _core.most_probable(frames, factors.core, place, LARGEST_STEP, half)
        if turn == 0:
            first = before
        is_settled = bool((np.abs(peak.place - place) < SETTLED * peak.std).all())
        place = peak.place
        if is_settled:
            break
    return _result(peak, factors, selection, first, is_settled)


def _prior_std(response: SkinResponse) -> Floats:
    """Of muscles that are seen at work, then of articulators."""
    std = [ACTIVATION_STD] * len(response.names)
    std += [ARTICULATOR_STD[name.split(".")[0]] for name in response.articulators]
    return np.array(std)


def _linear_frames(
    skin: _core.FittedSkin,
    sightings: Sequence[_core.WhitenedSighting],
    modes: ResponsiveModes,
    std: Floats,
) -> list[_core.LinearFrame]:
    columns = np.concatenate([modes.modes[None], modes.by_stiffness, modes.by_insertion])
    return [_core.LinearFrame(skin, one, columns, std, AT_REST) for one in sightings]


@dataclass(frozen=True)
class Factors:
    """The core's vector of factors, by name. names: of all muscles."""

    names: tuple[str, ...]
    core: _core.SkinFactors

    @property
    def prior(self) -> Floats:
        """Standard deviations about 0."""
        return self.core.prior_std

    def split(self, place: Floats) -> tuple[Floats, Floats, Floats]:
        """Stiffness (R), strength (n), insertion (2 x n, millimetres)."""
        count, num = len(REGIONS), len(self.core.strong)
        shifts = self.core.INSERTION_UNIT * place[count + num :].reshape(2, num)
        return place[:count], place[count : count + num], shifts

    def about(self, place: Floats) -> Calibration:
        """That of the skin and the insertions alone: in strengths, modes are linear anyway."""
        count, num = len(REGIONS), len(self.core.strong)
        skin = place.copy()
        skin[count : count + num] = 0
        return self.calibration(skin, [], np.ones(len(place)))

    def calibration(self, place: Floats, frames: list[int], is_informed: NDArray) -> Calibration:
        stiffness, strength, shifts = self.split(place)
        of_stiffness, of_strength, of_shifts = self.split(is_informed.astype(float))
        muscles = [self.names[i] for i in self.core.strong]

        def factors(names: Iterable[str], logs: Floats, flags: Floats) -> dict[str, float]:
            values = np.clip(np.exp(logs), LEAST, MOST).tolist()
            return {n: v for n, v, k in zip(names, values, flags, strict=True) if k}

        has_shift = of_shifts.any(axis=0)
        return Calibration(
            factors(REGIONS, stiffness, of_stiffness),
            factors(muscles, strength, of_strength),
            {
                n: (x, y)
                for n, x, y, k in zip(muscles, *shifts.tolist(), has_shift, strict=True)
                if k
            },
            frames,
        )


def _result(
    peak: _core.Peak,
    factors: Factors,
    selection: list[_core.Sighting],
    first: float,
    is_settled: bool,
) -> CalibrationResult:
    is_informed = peak.std < UNINFORMED * factors.prior
    place = np.where(is_informed, peak.place, 0.0)
    calibration = factors.calibration(place, [one.frame for one in selection], is_informed)
    stiffness, strength, shifts = factors.split(peak.std)
    muscles = [factors.names[i] for i in factors.core.strong]
    return CalibrationResult(
        calibration,
        dict(zip(REGIONS, stiffness.tolist(), strict=True)),
        dict(zip(muscles, strength.tolist(), strict=True)),
        {name: (x, y) for name, x, y in zip(muscles, *shifts.tolist(), strict=True)},
        peak.height - first,
        is_settled,
    )
