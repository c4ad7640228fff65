# SPDX-License-Identifier: GPL-3.0-or-later
"""Albedo of a painted person: skin with grain, freckles and moles, brows, lips, stubble and hair.

Painted per texel from the neutral position under it, so that every mark sits at a known place of
the face and sticks to it. Without such detail a tracker would see only shading, and results on
the clip would say nothing about real skin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .noise import ValueNoise, smoothstep

SIZE = 1024
SAMPLES_PER_QUAD = 16
TONES = np.array([[232, 190, 165], [215, 168, 140], [190, 140, 112], [150, 103, 78]]) / 255.0
HAIRS = np.array([[38, 28, 24], [72, 50, 34], [24, 22, 24], [118, 86, 52]]) / 255.0


@dataclass(frozen=True)
class Look:
    """What a person's skin and hair look like, drawn from the seed."""

    seed: int
    tone: np.ndarray
    hair: np.ndarray
    freckles: int
    moles: int
    stubble: float

    @classmethod
    def random(cls, seed: int) -> Look:
        rng = np.random.default_rng([seed, 11])
        blend = rng.uniform(0, len(TONES) - 1)
        low = int(blend)
        tone = TONES[low] + (blend - low) * (TONES[min(low + 1, len(TONES) - 1)] - TONES[low])
        return cls(
            seed=seed,
            tone=tone * rng.uniform(0.95, 1.05),
            hair=HAIRS[rng.integers(len(HAIRS))],
            freckles=int(rng.integers(60, 350)),
            moles=int(rng.integers(8, 18)),
            stubble=float(rng.choice([0.0, 0.15, 0.35])),
        )


def positions_by_texel(vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Neutral position under every texel (SIZE,SIZE,3); row 0 is v = 0, bare texels are nan.

    vertices V x 3, faces F x 4, uv F x 4 x 2 in [0, 1].
    """
    steps = (np.arange(SAMPLES_PER_QUAD) + 0.5) / SAMPLES_PER_QUAD
    s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
    weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    texel = np.clip(np.einsum("fcd,cs->fsd", uv, weights) * SIZE, 0, SIZE - 1).astype(int)
    position = np.einsum("fcd,cs->fsd", vertices[faces], weights)
    painted = np.full((SIZE, SIZE, 3), np.nan)
    painted[texel[..., 1], texel[..., 0]] = position
    return _grown(painted, steps=6)


def _grown(painted: np.ndarray, steps: int) -> np.ndarray:
    """Bare texels next to painted ones take their value: filtering never reads a bare one."""
    for _ in range(steps):
        for axis, shift in ((0, 1), (0, -1), (1, 1), (1, -1)):
            bare = np.isnan(painted[..., 0])
            painted[bare] = np.roll(painted, shift, axis)[bare]
    return painted


class SkinPainter:
    """Paints one person; `landmarks` are the neutral positions (3,) by name, metres, head frame."""

    def __init__(self, look: Look, landmarks: dict[str, np.ndarray]) -> None:
        self._look = look
        self._at = landmarks
        self._noise = ValueNoise(look.seed)
        self._rng = np.random.default_rng([look.seed, 12])

    def albedo(self, points: np.ndarray) -> np.ndarray:
        """Linear-light reflectance (N,3) at neutral positions (N,3) of the skin."""
        color = self._bare_skin(points)
        color = self._spots(color, points)
        color = _mix(color, 0.25 * self._look.hair + 0.5 * self._look.tone, self._stubble(points))
        lips = (
            self._look.tone * (0.86, 0.68, 0.66) * (1 + 0.12 * self._lip_creases(points))[:, None]
        )
        color = _mix(color, lips, self._lips(points))
        color = _mix(color, 0.3 * self._look.tone, 0.75 * self._lid_margins(points))
        strands = self._look.hair * (1 + 0.45 * self._strands(points))[:, None]
        color = _mix(color, strands, np.maximum(self._brows(points), self._scalp(points)))
        return np.clip(color, 0, 1) ** 2.2

    def hairiness(self, points: np.ndarray) -> np.ndarray:
        """How much scalp hair stands on a neutral position, 0 to 1 (N,)."""
        return self._scalp(points)

    def _bare_skin(self, points: np.ndarray) -> np.ndarray:
        tone = np.tile(self._look.tone, (len(points), 1))
        blotches = self._noise.octaves(points, (0.035, 0.014, 0.006))
        grain = self._noise.octaves(points + 1.0, (0.0032, 0.0018, 0.0011))
        tone *= (1 + 0.045 * blotches + 0.05 * grain)[:, None]
        flushed = sum(
            np.exp(-(_distance(points, place) ** 2) / (2 * size**2))
            for place, size in (
                (self._at["nose_tip"], 0.014),
                (self._cheek("L"), 0.020),
                (self._cheek("R"), 0.020),
                (self._at["chin"], 0.014),
            )
        )
        red = np.clip(flushed * (0.7 + 0.5 * self._noise(points, 0.009)), 0, 1)
        return tone * (1 + red[:, None] * (0.04, -0.13, -0.12))

    def _cheek(self, side: str) -> np.ndarray:
        return (2 * self._at[f"ala.{side}"] + self._at[f"zygion.{side}"]) / 3

    def _spots(self, color: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Freckles over the middle of the face, moles anywhere in front."""
        low, high = self._at["menton"], self._at["hairline"]
        front = np.flatnonzero(
            (points[:, 2] > 0.3 * self._at["nose_tip"][2])
            & (points[:, 1] > low[1])
            & (points[:, 1] < high[1])
        )
        front = front[np.argsort(points[front, 0])]
        ordered = points[front, 0]
        kinds = (
            (self._look.freckles, 0.0006, 0.0013, 0.24),
            (self._look.moles, 0.001, 0.002, 0.62),
        )
        for number, smallest, largest, depth in kinds:
            for center in points[self._rng.choice(front, number)]:
                radius = self._rng.uniform(smallest, largest)
                first, last = np.searchsorted(ordered, center[0] + (-3 * radius, 3 * radius))
                near = front[first:last]
                dark = np.exp(-((_distance(points[near], center) / radius) ** 2))
                strength = depth * self._rng.uniform(0.5, 1)
                color[near] *= 1 - strength * dark[:, None] * (0.8, 1.0, 1.1)
        return color

    def _stubble(self, points: np.ndarray) -> np.ndarray:
        mouth = (self._at["lip_upper"] + self._at["lip_lower"]) / 2
        below = smoothstep(self._at["nose_base"][1], mouth[1], points[:, 1])
        front = smoothstep(0.0, 0.03, points[:, 2])
        dots = np.clip(0.5 + 1.2 * self._noise(points + 2.0, 0.0012), 0, 1)
        return self._look.stubble * below * front * (0.4 + 0.6 * dots)

    def _lips(self, points: np.ndarray) -> np.ndarray:
        """The vermilion: two parabolas between the corners of the mouth."""
        left, right = self._at["mouth_corner.L"], self._at["mouth_corner.R"]
        middle = (left + right) / 2
        across = (points[:, 0] - middle[0]) / (abs(left[0] - right[0]) / 2)
        arch = np.clip(1 - across**2, 0, None)
        bow = 1 - 0.18 * np.exp(-((across / 0.16) ** 2))
        upper = middle[1] + (self._at["lip_upper"][1] - middle[1]) / 0.82 * arch**0.7 * bow
        lower = middle[1] + (self._at["lip_lower"][1] - middle[1]) * arch**0.8
        inside = np.minimum(upper - points[:, 1], points[:, 1] - lower)
        front = points[:, 2] > middle[2] - 0.02
        return smoothstep(-0.0012, 0.0012, inside) * front * (arch > 0)

    def _lip_creases(self, points: np.ndarray) -> np.ndarray:
        return self._noise.octaves(points, ((0.0016, 0.008, 0.008), (0.003, 0.003, 0.003)))

    def _lid_margins(self, points: np.ndarray) -> np.ndarray:
        """Roots of the lashes: a dark line along both lids."""
        dark = np.zeros(len(points))
        for side in "LR":
            for lid, width in (("lid_upper", 0.0022), ("lid_lower", 0.0010)):
                names = (f"eye_inner.{side}", f"{lid}.{side}", f"eye_outer.{side}")
                line = _arc(*(self._at[name] for name in names))
                dark = np.maximum(dark, np.exp(-((_distance_to(line, points) / width) ** 2)))
        return dark

    def _brows(self, points: np.ndarray) -> np.ndarray:
        cover = np.zeros(len(points))
        for side in "LR":
            names = (f"brow_inner.{side}", f"brow_middle.{side}", f"brow_outer.{side}")
            line = _arc(*(self._at[name] for name in names))
            length = abs(line[-1, 0] - line[0, 0])
            along = np.clip(np.abs(points[:, 0] - line[0, 0]) / length, 0, 1)
            width = 0.0062 * (1 - 0.55 * along)
            cover = np.maximum(
                cover, 1 - smoothstep(0.55, 1.25, _distance_to(line, points) / width)
            )
        hairs = self._noise.octaves(points, ((0.0035, 0.0012, 0.004), (0.0011, 0.0022, 0.004)))
        return cover * np.clip(0.8 + 0.45 * hairs, 0, 1)

    def _scalp(self, points: np.ndarray) -> np.ndarray:
        """Above a line that runs from the hairline, down the temples and behind the ears."""
        top, ear = self._at["hairline"], self._at["tragus.L"]
        forward = (points[:, 2] - ear[2]) / (top[2] - ear[2])
        side = np.abs(points[:, 0]) / abs(ear[0])
        edge = np.interp(forward, (-1.0, -0.35, 0.1, 0.3, 1.0), (-0.35, 0.1, 0.25, 0.72, 0.97))
        edge = edge - 0.10 * smoothstep(0.2, 0.7, side) * smoothstep(0.5, 1.0, forward)
        height = (points[:, 1] - ear[1]) / (top[1] - ear[1])
        ragged = 0.05 * self._noise(points, 0.006) + 0.03 * self._noise(points, 0.0025)
        from_ear = np.column_stack([np.abs(points[:, 0]), points[:, 1:]]) - ear
        on_ear = np.linalg.norm((from_ear - (0.008, 0.004, -0.012)) / (0.017, 0.038, 0.03), axis=1)
        bare = smoothstep(0.85, 1.05, on_ear)
        return bare * smoothstep(-0.03, 0.05, height - edge + ragged)

    def _strands(self, points: np.ndarray) -> np.ndarray:
        return self._noise.octaves(
            points, ((0.0016, 0.009, 0.009), (0.004, 0.016, 0.016), (0.02, 0.02, 0.02))
        )


def eye_albedo(points: np.ndarray, center: np.ndarray, radius: float, seed: int) -> np.ndarray:
    """Sclera, iris and pupil (N,3), linear light, at neutral positions of one eyeball."""
    rng = np.random.default_rng([seed, 13])
    iris = np.array([[70, 45, 28], [70, 92, 104], [84, 88, 56]])[rng.integers(3)] / 255.0
    noise = ValueNoise(seed + 1)
    off_axis = (points - center) / radius
    angle = np.arccos(np.clip(off_axis[:, 2] / np.linalg.norm(off_axis, axis=1), -1, 1))
    fibres = 1 + 0.35 * noise(
        np.column_stack([np.arctan2(*off_axis[:, :2].T) * 12, angle * 2, angle]), 1
    )
    color = np.array([0.86, 0.83, 0.80]) * (1 - 0.10 * smoothstep(0.5, 1.2, angle))[:, None]
    color = _mix(color, 0.45 * iris, smoothstep(0.40, 0.36, angle))
    color = _mix(color, iris * fibres[:, None], smoothstep(0.36, 0.32, angle))
    color = _mix(color, np.full(3, 0.02), smoothstep(0.16, 0.13, angle))
    return np.clip(color, 0, 1) ** 2.2


def _mix(base: np.ndarray, top: np.ndarray, share: np.ndarray) -> np.ndarray:
    return base + np.clip(share, 0, 1)[:, None] * (top - base)


def _distance(points: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points - place, axis=1)


def _arc(start: np.ndarray, through: np.ndarray, end: np.ndarray) -> np.ndarray:
    """A parabola through three points (41,3)."""
    s = np.linspace(0, 1, 41)[:, None]
    split = np.linalg.norm(through - start)
    split /= split + np.linalg.norm(end - through)
    bend = (through - (1 - split) * start - split * end) / (split * (1 - split))
    return (1 - s) * start + s * end + s * (1 - s) * bend


def _distance_to(line: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Distance of points (N,3) to the nearest of a line's points, inf beyond 15 mm."""
    nearest = np.full(len(points), np.inf)
    reach = 0.015
    close = np.flatnonzero(((points > line.min(0) - reach) & (points < line.max(0) + reach)).all(1))
    for place in line:
        nearest[close] = np.minimum(nearest[close], _distance(points[close], place))
    return nearest
