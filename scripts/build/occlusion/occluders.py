# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be before a face: hands, microphones, cups and cloth, hair, painted into a picture.

Places and lengths are shares of the picture's side, x to the right and y down; colours are grey
levels. Each painter returns colours (H x W x 3) and how far they cover (H x W, 0 to 1).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

Layer = tuple[np.ndarray, np.ndarray]
# Metres over the square's side of .19 m: half widths and lengths of fingers, the palm, an arm
FINGER, FINGER_LENGTHS, PALM = 0.045, (0.38, 0.43, 0.41, 0.33), 0.21
EDGE = 0.02  # of a part of the hand, in its radii
TOP = np.array([0.5, 0.06])  # where hair hangs from


def noise(size: int, cells: int, rng: np.random.Generator, channels: int = 1) -> np.ndarray:
    """Smooth noise of about unit deviation with so many cells along a side, H x W x C."""
    coarse = rng.normal(0, 1, (cells + 1, cells + 1, channels)).astype(np.float32)
    grown = [
        Image.fromarray(coarse[..., i]).resize((size, size), Image.Resampling.BICUBIC)
        for i in range(channels)
    ]
    return np.stack([np.asarray(one) for one in grown], -1)


def textured(
    size: int, colour: np.ndarray, rng: np.random.Generator, strength: float
) -> np.ndarray:
    """A colour with noise of several scales, mostly of brightness."""
    made = np.zeros((size, size, 3), np.float32) + colour
    for cells in (3, 9, 30, 90):
        share = strength * rng.uniform(0, 1)
        made = made * (1 + share * noise(size, cells, rng)) + 60 * share * 0.2 * noise(
            size, cells, rng, 3
        )
    return made


def _grid(size: int) -> np.ndarray:
    steps = (np.arange(size) + 0.5) / size
    return np.stack(np.meshgrid(steps, steps), -1)


def _capsule(grid: np.ndarray, ends: np.ndarray, radii: tuple[float, float]) -> tuple:
    """Distance from the axis and the way to the side, both in radii, and the share along."""
    along = ends[1] - ends[0]
    share = np.clip(((grid - ends[0]) @ along) / (along @ along), 0, 1)
    off = grid - (ends[0] + share[..., None] * along)
    radius = radii[0] + share * (radii[1] - radii[0])
    return np.linalg.norm(off, axis=-1) / radius, off / radius[..., None], share


def _rounded(distance: np.ndarray, off: np.ndarray, light: np.ndarray, dark: float) -> np.ndarray:
    """Shading of a round bar: how bright, by its normal."""
    height = np.sqrt(np.clip(1 - distance**2, 0, 1))
    return np.clip(1 - dark + dark * (off @ light[:2] + height * light[2]), 0.15, 1.35)


class _RoundParts:
    """Round bars one before another: how bright, and how far they cover (H x W both).

    light: (3,) towards it; dark: how much less there is aside; seam: share of light between bars
    """

    def __init__(self, size: int, light: np.ndarray, dark: float, seam: float) -> None:
        self.shade, self.cover = np.ones((size, size)), np.zeros((size, size))
        self._grid, self._light, self._dark, self._seam = _grid(size), light, dark, seam

    def add(self, ends: np.ndarray, radii: tuple[float, float], light_share: float) -> None:
        distance, off, way = _capsule(self._grid, ends, radii)
        own = np.clip((1 - distance) / EDGE, 0, 1)
        bright = light_share * _rounded(distance, off, self._light, self._dark)
        bright = np.where(distance > 0.82, bright * self._seam, bright)
        if radii[0] < 0.09:  # a finger's joints
            for joint in (0.42, 0.7):
                bright = bright * (1 - 0.25 * np.exp(-(((way - joint) / 0.02) ** 2)))
        self.shade = self.shade * (1 - own) + bright * own
        self.cover = np.maximum(self.cover, own)


def hand(size: int, skin: np.ndarray, rng: np.random.Generator) -> Layer:
    """A hand of about the face's colour: fingers, spread or together, a palm, a forearm."""
    turn = rng.uniform(0, 2 * np.pi)
    ahead = np.array([np.cos(turn), np.sin(turn)])
    beside = np.array([-ahead[1], ahead[0]]) * rng.choice([-1, 1])
    scale = rng.uniform(0.75, 1.15)
    tips = rng.uniform(0.2, 0.8, 2) * (1, 0.9) + (0, 0.1)
    wrist = tips - scale * ahead * rng.uniform(0.3, 0.62)
    light = rng.normal(0, 1, 3)
    light[2] = abs(light[2]) + 0.4
    light /= np.linalg.norm(light)
    dark = rng.choice([rng.uniform(0, 0.15), rng.uniform(0.15, 0.6)], p=(0.25, 0.75))
    tone = skin * rng.uniform(0.72, 1.3) * rng.uniform(0.93, 1.07, 3)
    picture = textured(size, tone, rng, rng.uniform(0.02, 0.08))
    parts = _RoundParts(size, light, dark, seam=rng.uniform(0.45, 0.9))
    arm = wrist - ahead * 0.9
    if rng.random() < 0.85:
        parts.add(np.array([arm, wrist]), (0.24 * scale, 0.15 * scale), rng.uniform(0.8, 1.05))
    palm = wrist + scale * ahead * 0.15
    parts.add(
        np.array([palm - 0.05 * scale * beside, palm + 0.07 * scale * beside]),
        (PALM * 0.7 * scale, PALM * 0.65 * scale),
        rng.uniform(0.9, 1.05),
    )
    spread = rng.uniform(-0.02, 0.22)
    bent = rng.uniform(0.35, 1.0)
    for number, length in enumerate(FINGER_LENGTHS):
        from_middle = number - 1.5
        root = palm + scale * (0.1 * ahead + 0.08 * from_middle * beside)
        way = ahead + spread * from_middle * beside + rng.normal(0, 0.05, 2)
        way /= np.linalg.norm(way)
        reach = scale * length * bent * rng.uniform(0.85, 1.1)
        if rng.random() < 0.12:  # bent away
            reach *= 0.35
        parts.add(
            np.array([root, root + reach * way]),
            (FINGER * scale * 1.05, FINGER * scale * 0.85),
            rng.uniform(0.9, 1.06),
        )
    if rng.random() < 0.7:
        root = palm + scale * (-0.03 * ahead - 0.13 * beside)
        way = ahead * rng.uniform(0.1, 1) - beside * rng.uniform(0.3, 1)
        way /= np.linalg.norm(way)
        parts.add(
            np.array([root, root + scale * 0.25 * way]),
            (FINGER * scale * 1.25, FINGER * scale),
            rng.uniform(0.9, 1.06),
        )
    return picture * parts.shade[..., None], parts.cover


def microphone(size: int, skin: np.ndarray, rng: np.random.Generator) -> Layer:
    """A ball of foam or of wire mesh on a stand or held from below."""
    grid = _grid(size)
    middle = np.array([0.5, 0.75]) + rng.normal(0, (0.15, 0.12))
    radius = rng.uniform(0.05, 0.16)
    turn = rng.normal(0, 0.5)
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    off = ((grid - middle) @ axes.T) / (radius * np.array([1, rng.uniform(1, 1.5)]))
    distance = np.linalg.norm(off, axis=-1)
    light = np.array([*rng.normal(0, 0.6, 2), 1.0])
    light /= np.linalg.norm(light)
    tone = rng.choice([rng.uniform(15, 70), rng.uniform(60, 230)]) * rng.uniform(0.8, 1.2, 3)
    picture = textured(size, tone, rng, rng.uniform(0.05, 0.3))
    picture = picture + rng.uniform(0, 14) * rng.normal(0, 1, (size, size, 1))
    shade = _rounded(distance, off, light, rng.uniform(0.3, 0.8))
    ball = np.clip((1 - distance) * radius * size, 0, 1)
    bar = grid[..., 0] - (middle[0] + rng.normal(0, 0.5) * (grid[..., 1] - middle[1]))
    width = rng.uniform(0.015, 0.07)
    stand = np.clip((width - np.abs(bar)) * size, 0, 1) * (grid[..., 1] > middle[1])
    grey = np.full(3, rng.uniform(10, 180))
    stand_tone = grey * (1.1 - 0.6 * np.abs(bar / width)[..., None].clip(0, 1))
    colours = np.where(ball[..., None] > 0, picture * shade[..., None], stand_tone)
    return colours, np.maximum(ball, stand * (rng.random() < 0.8))


def thing(size: int, skin: np.ndarray, rng: np.random.Generator) -> Layer:
    """A cup, a phone, paper, a leaf: a shape with corners or without, plain or patterned."""
    grid = _grid(size)
    middle = rng.uniform(0.1, 0.9, 2)
    around = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    if rng.random() < 0.5:
        half = np.exp(rng.uniform(np.log(0.05), np.log(0.35), 2))
        corners = (
            half
            * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
            * (1 + 0.15 * rng.normal(0, 1, (4, 1)))
        )
    else:
        radius = np.exp(rng.uniform(np.log(0.05), np.log(0.3)))
        wave = sum(
            rng.normal(0, 0.25 / k) * np.cos(k * around + rng.uniform(0, 7)) for k in range(2, 6)
        )
        corners = radius * (1 + wave)[:, None] * np.column_stack([np.cos(around), np.sin(around)])
    turn = rng.uniform(0, np.pi)
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    image = Image.new("L", (2 * size, 2 * size))
    outline = 2 * size * (corners @ turned + middle)
    ImageDraw.Draw(image).polygon([tuple(p) for p in outline], fill=255)
    cover = np.asarray(image.resize((size, size), Image.Resampling.BOX), np.float32) / 255
    tone = rng.uniform(5, 250, 3) if rng.random() < 0.7 else skin * rng.uniform(0.7, 1.3)
    picture = textured(size, tone, rng, rng.choice([0.02, rng.uniform(0, 0.5)]))
    if rng.random() < 0.3:
        way = rng.normal(0, 1, 2)
        stripes = np.sin(grid @ way * rng.uniform(10, 120) + rng.uniform(0, 7))
        picture = picture + rng.uniform(10, 70) * stripes[..., None]
    gradient = (grid - 0.5) @ rng.normal(0, 0.6, 2)
    return picture * np.clip(1 + gradient, 0.3, 1.7)[..., None], cover


def cloth(size: int, skin: np.ndarray, rng: np.random.Generator) -> Layer:
    """A scarf, a collar, a mask: everything below a wavy line."""
    grid = _grid(size)
    line = rng.uniform(0.45, 0.95) + 0.05 * noise(size, 3, rng)[0, :, 0]
    line = line - rng.uniform(-0.1, 0.35) * (np.abs(grid[0, :, 0] - 0.5) ** 1.5)
    cover = np.clip((grid[..., 1] - line) * size / 2, 0, 1)
    picture = textured(size, rng.uniform(5, 245, 3), rng, rng.uniform(0.02, 0.3))
    folds = np.sin(
        grid @ rng.normal(0, 1, 2) * rng.uniform(5, 40) + 2 * noise(size, 4, rng)[..., 0]
    )
    return picture * (1 + rng.uniform(0, 0.3) * folds)[..., None], cover


def hair(size: int, skin: np.ndarray, rng: np.random.Generator) -> Layer:
    """Locks that hang over the forehead or down one side."""
    image = Image.new("RGBA", (2 * size, 2 * size))
    pen = ImageDraw.Draw(image)
    tone = np.array([70.0, 48.0, 32.0]) * rng.choice([rng.uniform(0.2, 1), rng.uniform(1, 2.6)])
    start = TOP + np.array([rng.uniform(-0.35, 0.35), 0])
    lean, longest = rng.normal(0, 0.5), rng.uniform(0.15, 0.75)
    width = rng.uniform(0.05, 0.35)
    for _ in range(int(rng.uniform(30, 320) * width / 0.3)):
        at = start + np.array([rng.normal(0, width / 2), rng.uniform(-0.1, 0.05)])
        way = np.array([lean + rng.normal(0, 0.12), 1.0])
        bend = rng.normal(0, 0.25)
        length = longest * rng.uniform(0.6, 1)
        steps = np.linspace(0, 1, 7)[:, None]
        curve = at + length * (steps * way + steps**2 * np.array([bend, 0]))
        fill = (*(int(v) for v in np.clip(tone * rng.uniform(0.6, 1.4), 0, 255)), 255)
        pen.line([tuple(2 * size * p) for p in curve], fill=fill, width=int(rng.integers(1, 4)))
    small = np.asarray(image.resize((size, size), Image.Resampling.BOX), np.float32)
    return small[..., :3], small[..., 3] / 255


PAINTERS: dict[Callable[[int, np.ndarray, np.random.Generator], Layer], float] = {
    hand: 0.42,
    microphone: 0.14,
    thing: 0.2,
    cloth: 0.08,
    hair: 0.16,
}


def painted(
    picture: np.ndarray, skin: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """A picture (S x S x 3) with something before the face, and how far it covers (S x S)."""
    painter = list(PAINTERS)[rng.choice(len(PAINTERS), p=list(PAINTERS.values()))]
    size = len(picture)
    colours, cover = painter(size, skin, rng)
    if rng.random() < 0.5:
        cover = _blurred(cover, rng.uniform(0, 1.5))
    if rng.random() < 0.6:  # the shadow it casts
        moved = np.roll(cover, rng.integers(-12, 13, 2) * size // 192, (0, 1))
        dark = rng.uniform(0.1, 0.6) * _blurred(moved, float(rng.uniform(1, 8) * size / 192))
        picture = picture * (1 - dark)[..., None]
    mixed = picture + cover[..., None] * (np.clip(colours, 0, 255) - picture)
    return mixed, cover


def shadowed(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A picture with a shadow or a patch of light on it, from something out of sight."""
    _, cover = (thing, hair, hand)[rng.integers(3)](len(picture), np.full(3, 128.0), rng)
    soft = _blurred(cover, float(rng.choice([0.7, rng.uniform(1, 10)])))
    return picture * (1 + rng.choice([-1, 0.6]) * rng.uniform(0.1, 0.6) * soft)[..., None]


def _blurred(cover: np.ndarray, radius: float) -> np.ndarray:
    image = Image.fromarray((255 * cover).astype(np.uint8)).filter(ImageFilter.GaussianBlur(radius))
    return np.asarray(image, np.float32) / 255
