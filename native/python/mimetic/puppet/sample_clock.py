# SPDX-License-Identifier: GPL-3.0-or-later
"""When a sound card took its samples, by another clock: the two drift apart."""

from __future__ import annotations

LEAST_SECONDS = 60.0  # of sound from which on a drift shows beside how unevenly chunks arrive
SHARE = 0.2  # of the sound, at its start and its end, that the drift is read from
LARGEST_DRIFT = 1e-3  # more than any card's: sound was lost


class SampleClock:
    """Chunks arrive when their last sample is taken, or later: the earliest of each second count.

    rate: nominal, samples a second.
    """

    def __init__(self, rate: int) -> None:
        self._rate = rate
        self._earliest: list[tuple[float, float]] = []  # seconds of sound, by how much it is late

    def arrive(self, at: float, num_samples: int) -> None:
        """at: seconds of the other clock; num_samples: with those before."""
        seconds = num_samples / self._rate
        late = at - seconds
        if self._earliest and int(self._earliest[-1][0]) == int(seconds):
            if late < self._earliest[-1][1]:
                self._earliest[-1] = seconds, late
        else:
            self._earliest.append((seconds, late))

    @property
    def has_begun(self) -> bool:
        return bool(self._earliest)

    @property
    def drift(self) -> float:
        """Seconds by which the sound grows too short in each of its seconds; 0 where unknown."""
        end = self._earliest[-1][0]
        if end < LEAST_SECONDS:
            return 0.0
        first = min((late, seconds) for seconds, late in self._earliest if seconds <= SHARE * end)
        last = min(
            (late, seconds) for seconds, late in self._earliest if seconds >= (1 - SHARE) * end
        )
        drift = (last[0] - first[0]) / (last[1] - first[1])
        return drift if abs(drift) <= LARGEST_DRIFT else 0.0

    @property
    def first_sample(self) -> float:
        """When it was taken, seconds of the other clock."""
        drift = self.drift
        return min(late - drift * seconds for seconds, late in self._earliest)
