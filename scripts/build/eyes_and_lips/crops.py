# SPDX-License-Identifier: GPL-3.0-or-later
"""Squares about eyes and mouths as cameras of all kinds show them, 64 x 64, with their points."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

SIDE = 64
EYE_MARGIN = 2.3  # sides of a square in widths of the eye
MOUTH_MARGIN, MOUTH_DOWN = 1.7, 0.15  # in widths of the mouth: side, and how far below its middle
EYE_WIDTHS = (9.0, 54.0)  # pixels
JITTER = {"center": 0.07, "side": 0.1, "roll": 5.0}  # s.d.: sides of the square, share, degrees
GLASSES, LASHES, GLINTS, STRANDS = 0.2, 0.7, 0.7, 0.08  # share of the pictures


@dataclass(frozen=True)
class Square:
    center: np.ndarray  # pixels
    side: float
    roll: float  # radians, clockwise in the picture

    @property
    def axes(self) -> np.ndarray:
        """Columns: the square's sides, pixels."""
        c, s = np.cos(self.roll) * self.side, np.sin(self.roll) * self.side
        return np.array([[c, -s], [s, c]])

    def shares(self, places: np.ndarray) -> np.ndarray:
        """Places (K x 2, pixels) in sides of the square."""
        return (places - self.center) @ np.linalg.inv(self.axes).T + 0.5


@dataclass(frozen=True)
class Shots:
    """One drawn person (`shots.drawn_people`)."""

    frames: np.ndarray
    lids: np.ndarray
    irises: np.ndarray
    lips: np.ndarray
    head_pose: np.ndarray
    intrinsics: np.ndarray
    anchors: np.ndarray


def square_of(shots: Shots, shot: int, part: int) -> Square:
    """Where the pose places the square of the left eye (0), the right eye (1) or the mouth (2)."""
    ends = shots.anchors[2 + 2 * part : 4 + 2 * part]
    width = np.linalg.norm(ends[0] - ends[1])
    point = ends.mean(axis=0)
    margin = EYE_MARGIN
    if part == 2:
        point, margin = point - (0, MOUTH_DOWN * width, 0), MOUTH_MARGIN
    return square_round(shots, shot, point, margin * width)


def square_round(shots: Shots, shot: int, point: np.ndarray, length: float) -> Square:
    """The square about a point of the head frame, as the core lays it; metres."""
    pose, focal = shots.head_pose[shot], shots.intrinsics[0, 0]
    at = pose[:3, :3] @ point + pose[:3, 3]
    center = focal * at[:2] / at[2] + shots.intrinsics[:2, 2]
    across = pose[:2, 0] * at[2] - at[:2] * pose[2, 0]
    return Square(center, length * focal / at[2], float(np.arctan2(across[1], across[0])))


def jittered(square: Square, rng: np.random.Generator, spread: dict[str, float]) -> Square:
    """The square misplaced, spread: as `JITTER` has it."""
    return Square(
        square.center + square.side * rng.normal(0, spread["center"], 2),
        square.side * float(np.exp(rng.normal(0, spread["side"]))),
        square.roll + float(np.radians(rng.normal(0, spread["roll"]))),
    )


def sample(
    shots: Shots, shot: int, part: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """A picture (SIDE x SIDE x 3, uint8) and its points in sides of the square.

    Of an eye upper and lower margin (9 each, from the outer to the inner corner) and the iris (5);
    the left eye is mirrored. Of a mouth four edges of 11.
    """
    square = jittered(square_of(shots, shot, part), rng, JITTER)
    picture, corner = _region(shots.frames[shot], square, rng)
    if part < 2:
        lids, iris = shots.lids[shot, part] - corner, shots.irises[shot, part] - corner
        _decorate_eye(picture, lids, iris, rng)
        # The rim's first point is the one to the right in what the regressor is shown
        rim = [0, 3, 2, 1, 4] if part == 0 else [0, 1, 2, 3, 4]
        points = np.concatenate([lids.reshape(-1, 2), iris[rim]])
    else:
        points = shots.lips[shot].reshape(-1, 2) - corner
    square = Square(square.center - corner, square.side, square.roll)
    eye_width = np.linalg.norm(np.diff(shots.lids[shot, 0, 0, [0, -1]], axis=0))
    wanted = np.exp(rng.uniform(*np.log(EYE_WIDTHS)))
    seen, scale = filmed(picture, min(1.0, wanted / max(eye_width, 20)), rng)
    mirrored = part == 0 or (part == 2 and rng.random() < 0.5)
    small = Square((square.center + 0.5) * scale - 0.5, square.side * scale, square.roll)
    shares = square.shares(points)
    if mirrored:
        shares[:, 0] = 1 - shares[:, 0]
        if part == 2:
            shares = shares.reshape(4, 11, 2)[:, ::-1].reshape(-1, 2)
    return warped(seen, small, mirrored), shares.astype(np.float32)


def warped(picture: np.ndarray, square: Square, mirrored: bool) -> np.ndarray:
    """The square as a network is shown it: halved while twice as large, then interpolated."""
    image = Image.fromarray(picture)
    center, side = square.center, square.side
    while side >= 2 * SIDE and min(image.size) >= 4:
        half = (image.width // 2, image.height // 2)
        center = (center + 0.5) * (np.array(half) / image.size) - 0.5
        side *= half[0] / image.width
        image = image.resize(half, Image.Resampling.BOX)
    return turned(image, Square(center, side, square.roll), SIDE, mirrored)


def turned(image: Image.Image, square: Square, size: int, mirrored: bool) -> np.ndarray:
    """The square upright, size x size pixels, interpolated."""
    axes = square.axes / size
    x = axes[:, 0] * (-1 if mirrored else 1)
    # PIL takes the middle of the first pixel for (.5, .5)
    first = square.center + 0.5 - (size / 2) * (x + axes[:, 1])
    data = (x[0], axes[0, 1], first[0], x[1], axes[1, 1], first[1])
    made = image.transform((size, size), Image.Transform.AFFINE, data, Image.Resampling.BILINEAR)
    return np.asarray(made)


def _region(
    frame: np.ndarray, square: Square, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """What lies about the square (H x W x 3, grey levels) before a background, and its corner."""
    reach = int(np.ceil(0.85 * square.side)) + 2
    corner = np.round(square.center).astype(int) - reach
    height, width = frame.shape[:2]
    rows = np.arange(corner[1], corner[1] + 2 * reach + 1)
    columns = np.arange(corner[0], corner[0] + 2 * reach + 1)
    part = frame[np.clip(rows, 0, height - 1)][:, np.clip(columns, 0, width - 1)].astype(np.float32)
    cover = part[..., 3:] / 255
    behind = rng.uniform(10, 240, 3) + rng.normal(0, 20, (4, 4, 1))
    behind = np.kron(behind, np.ones((len(rows) // 4 + 1, len(columns) // 4 + 1, 1)))
    behind = behind[: len(rows), : len(columns)]
    return np.clip(part[..., :3] * cover + behind * (1 - cover), 0, 255), corner


def _decorate_eye(
    picture: np.ndarray, lids: np.ndarray, iris: np.ndarray, rng: np.random.Generator
) -> None:
    """Lashes, a glint, rims of glasses and strands of hair, drawn into the picture."""
    image = Image.fromarray(picture.astype(np.uint8))
    pen = ImageDraw.Draw(image)
    width = np.linalg.norm(lids[0, -1] - lids[0, 0])
    opening = np.linalg.norm(lids[0, 4] - lids[1, 4])
    if rng.random() < LASHES:
        _lashes(pen, lids, width, rng)
    if rng.random() < GLINTS and opening > 0.12 * width:
        radius = np.linalg.norm(iris[1] - iris[0])
        for _ in range(rng.integers(1, 3)):
            at = iris[0] + rng.uniform(-0.8, 0.8, 2) * radius
            low, high = np.minimum(lids[0, 4, 1], lids[1, 4, 1]), lids[1, 4, 1]
            if low < at[1] < high:
                size = rng.uniform(0.05, 0.25) * radius
                tone = tuple(int(v) for v in rng.uniform(170, 255, 1).repeat(3))
                pen.ellipse((*(at - size), *(at + size)), fill=tone)
    if rng.random() < GLASSES:
        _rims(pen, lids, width, rng)
    if rng.random() < STRANDS:
        for _ in range(rng.integers(1, 5)):
            at = lids.mean((0, 1)) + rng.uniform(-0.8, 0.8) * np.array([width, 0])
            slant = rng.normal(0, 0.5)
            tone = tuple(int(v) for v in rng.uniform(10, 120, 3))
            ends = [
                (at[0] - slant * width, at[1] - 1.5 * width),
                (at[0] + slant * width, at[1] + 1.5 * width),
            ]
            pen.line(ends, fill=tone, width=int(rng.integers(1, 4)))
    picture[:] = np.asarray(image, np.float32)


def _lashes(pen: ImageDraw.ImageDraw, lids: np.ndarray, width: float, rng) -> None:
    tone = tuple(int(v) for v in rng.uniform(5, 60) * np.array([1, 0.9, 0.85]))
    for lid, (longest, thickest) in enumerate(((0.22, 0.06), (0.1, 0.03))):
        line = lids[lid]
        if rng.random() < (0.8, 0.35)[lid]:
            thick = max(1, round(width * rng.uniform(0, thickest)))
            pen.line([tuple(p) for p in line], fill=tone, width=thick)
        if rng.random() < (0.7, 0.35)[lid]:
            length = width * longest * rng.uniform(0.3, 1)
            middle = line[[0, -1]].mean(0) + np.array([0, (0.3, -0.3)[lid] * width])
            for share in np.linspace(0.03, 0.97, int(rng.integers(10, 28))):
                at = np.array([np.interp(share, np.linspace(0, 1, 9), line[:, a]) for a in (0, 1)])
                out = (at - middle) / np.linalg.norm(at - middle) + rng.normal(0, 0.15, 2)
                pen.line([tuple(at), tuple(at + length * rng.uniform(0.5, 1) * out)], fill=tone)


def _rims(pen: ImageDraw.ImageDraw, lids: np.ndarray, width: float, rng) -> None:
    middle = lids.mean((0, 1)) + rng.normal(0, 0.12, 2) * width
    size = width * np.array([rng.uniform(0.75, 1.1), rng.uniform(0.42, 0.85)])
    tone = tuple(int(v) for v in rng.uniform(5, 150) * rng.uniform(0.7, 1, 3))
    line = max(1, round(width * rng.uniform(0.03, 0.14)))
    box = (*(middle - size), *(middle + size))
    if rng.random() < 0.5:
        pen.ellipse(box, outline=tone, width=line)
    else:
        pen.rounded_rectangle(box, rng.uniform(0.1, 0.6) * size[1], outline=tone, width=line)
    out = np.sign(lids[0, 0, 0] - lids[0, -1, 0])
    side = middle + np.array([out * size[0], -0.2 * size[1]])
    pen.line(
        [tuple(side), (side[0] + out * width, side[1] + rng.normal(0, 0.1) * width)],
        fill=tone,
        width=line,
    )


def filmed(picture: np.ndarray, scale: float, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Exposure, colour, size, blur, noise and compression of a camera; uint8 and the true scale."""
    levels = (picture / 255) ** rng.uniform(0.7, 1.5)
    grey = levels.mean(axis=2, keepdims=True)
    levels = grey + (levels - grey) * rng.choice([0.0, rng.uniform(0.4, 1.4)], p=(0.08, 0.92))
    levels = levels * rng.uniform(0.55, 1.35) * rng.uniform(0.88, 1.12, 3) + rng.uniform(
        -0.04, 0.07
    )
    image = Image.fromarray((255 * np.clip(levels, 0, 1)).astype(np.uint8))
    size = max(8, round(scale * image.width))
    scale = size / image.width
    filters = (Image.Resampling.BOX, Image.Resampling.BICUBIC, Image.Resampling.LANCZOS)
    image = image.resize((size, size), filters[rng.integers(3)])
    image = image.filter(ImageFilter.GaussianBlur(float(rng.choice([0.3, rng.uniform(0, 1.2)]))))
    noisy = np.asarray(image, np.float32)
    if rng.random() < 0.15:  # the head or the camera moves
        noisy = np.mean(
            [np.roll(noisy, i, rng.integers(2)) for i in range(rng.integers(2, 5))], axis=0
        )
    noise = rng.uniform(0, 7) * rng.choice([0.3, 1])
    noisy = noisy + rng.normal(0, noise, (size, size, 1)) + rng.normal(0, noise / 2, noisy.shape)
    image = Image.fromarray(np.clip(np.round(noisy), 0, 255).astype(np.uint8))
    if rng.random() < 0.75:
        packed = io.BytesIO()
        image.save(packed, "JPEG", quality=int(rng.integers(25, 95)))
        image = Image.open(packed).convert("RGB")
    return np.asarray(image), scale
