# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames in which a filmed face keeps still, and how much points of it move there all the same."""

from __future__ import annotations

import numpy as np
from mimetic import _core
from mimetic.locate.feature_networks import feature_anchors
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.places import RefinedSurface
from mimetic.score.sampling import sampled
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.runs.real_labels import Labels, footage_of

RUN = 8  # frames
NUM_RUNS = 12  # of a clip, its stillest
PICTURE = 40  # pixels along a side of the face picture in which stillness is measured


def crops_of(
    performance: Performance, frames: NDArray[np.int64], times: int = 1
) -> list[_core.FeatureCrops]:
    """The squares about face and eyes by the captured pose, frame by frame. times: in a
    picture that much smaller (`shrunk`)."""
    anchors = feature_anchors(performance.neutral_vertices, load_template())
    full = RefinedSurface(performance).camera
    camera = _core.Camera(
        *(full.fx / times, full.fy / times),
        *((full.cx + 0.5) / times - 0.5, (full.cy + 0.5) / times - 0.5),
        *(full.width // times, full.height // times),
    )
    poses = (performance.head_pose[performance.index_of(int(frame))] for frame in frames)
    return [_core.feature_crops(camera, pose, anchors) for pose in poses]


def still_runs(clip: str, performance: Performance) -> NDArray[np.int64]:
    """R x RUN frames: the runs in which the face's picture, in the squares placed by the pose,
    changes least. None overlap; none has a frame that is held or repeats the one before."""
    frames = performance.frame
    crops = crops_of(performance, frames)
    shots = Footage(footage_of(clip)).frames(int(frames[0]), int(frames[-1]))
    faces = np.stack([_face(image, crops[i].face) for i, (_, image) in enumerate(shots)])
    starts = np.arange(len(faces) - RUN + 1)
    change = np.array([faces[i : i + RUN].std(axis=0).mean() for i in starts])
    good = performance.quality[: len(faces)] >= HELD_QUALITY
    good[1:] &= (faces[1:] != faces[:-1]).any(axis=(1, 2))
    usable = np.array([good[i : i + RUN].all() for i in starts])
    is_taken = np.zeros(len(faces), bool)
    runs: list[NDArray[np.int64]] = []
    for i in starts[np.argsort(change)]:
        if usable[i] and not is_taken[i : i + RUN].any() and len(runs) < NUM_RUNS:
            is_taken[i : i + RUN] = True
            runs.append(frames[i : i + RUN])
    return np.array(runs, np.int64).reshape(-1, RUN)


def _face(image: NDArray[np.uint8], crop: _core.FeatureCrop) -> NDArray[np.float32]:
    """A grey picture of what a crop shows, each pixel the mean of what it covers."""
    pool = max(1, round(crop.side / PICTURE))
    small = shrunk(image, pool).mean(axis=2, keepdims=True, dtype=np.float32)
    ticks = (np.arange(PICTURE) + 0.5) / PICTURE - 0.5
    x, y = np.meshgrid(ticks, ticks)
    cos, sin = np.cos(crop.roll), np.sin(crop.roll)
    at = crop.center + crop.side * np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
    return sampled(small, (at + 0.5) / pool - 0.5)[..., 0]


def shrunk(image: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
    """A picture so many times smaller; each pixel is the mean of those that it covers."""
    if times == 1:
        return image
    rows, cols = (size // times for size in image.shape[:2])
    blocks = image[: rows * times, : cols * times].reshape(rows, times, cols, times, 3)
    return np.ascontiguousarray(blocks.mean(axis=(1, 3)).round().astype(np.uint8))


def with_frames(labels: Labels, frames: NDArray[np.int64]) -> Labels:
    """The same frames and others, in which nothing is marked."""
    every = np.union1d(labels.frame, frames)
    rows = np.searchsorted(every, labels.frame)
    places = np.full((len(every), *labels.places.shape[1:]), np.nan)
    touch = np.full(len(every), np.nan)
    places[rows], touch[rows] = labels.places, labels.touch
    return Labels(labels.clip, every, places, touch)


def in_crops(places: NDArray[np.float64], crops: list[_core.FeatureCrop]) -> NDArray[np.float64]:
    """Pixels (N x K x 2) as places in the crops of their frames, in sides: along and down."""
    off = places - np.array([crop.center for crop in crops])[:, None]
    cos, sin = (np.array([turn(crop.roll) for crop in crops]) for turn in (np.cos, np.sin))
    along = off[..., 0] * cos[:, None] + off[..., 1] * sin[:, None]
    down = off[..., 1] * cos[:, None] - off[..., 0] * sin[:, None]
    side = np.array([crop.side for crop in crops])
    return np.stack([along, down], axis=-1) / side[:, None, None]


def jitter(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """R x K x 2: each run's variance about a steady motion. places: R x RUN x K x 2."""
    ticks = np.arange(places.shape[1]) - 0.5 * (places.shape[1] - 1)
    off = places - places.mean(axis=1, keepdims=True)
    speed = np.einsum("t,rtkx->rkx", ticks, off) / (ticks @ ticks)
    off -= ticks[None, :, None, None] * speed[:, None]
    return (off**2).sum(axis=1) / (places.shape[1] - 2)
