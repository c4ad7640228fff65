# SPDX-License-Identifier: GPL-3.0-or-later
"""What a puppet makes of a rendered face that is larger, turned, in other light, blurred, noisy."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from mimetic import _core
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.driver import Puppet
from mimetic.puppet.mapping import Mapping
from mimetic.puppet.seeing import PersonView
from mimetic.puppet.teaching import teach
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.pinhole import camera_of
from mimetic.solve.clip_capture import capture
from numpy.typing import NDArray
from PIL import Image as Picture
from PIL import ImageFilter

from evaluation.runs.rendered import clips

CLIPS = ("held-out-units", "held-out-muscles")
HEADS = ("surface", "ellipsoid", "free")
LAST = 130  # frame
NUM_CHOSEN = 8
BLOCK = 10  # frames: taught from one block, tried on the next
SCALES = (-25, -15, -7, 7, 15, 25)  # percent
UNTOLD_ZOOM = "untold zoom"
Image = NDArray[np.uint8]
# (kind, amount); inside of the paper's limits is what it says its system takes
CONDITIONS: tuple[tuple[str, float, bool], ...] = (
    ("none", 0, False),
    *(("scale", percent, abs(percent) <= 15) for percent in SCALES),
    *((UNTOLD_ZOOM, percent, False) for percent in SCALES),
    *(("rotation", degrees, abs(degrees) <= 10) for degrees in (-20, -10, -5, 5, 10, 20)),
    *(("gain", gain, True) for gain in (0.5, 0.75, 1.3)),
    *(("offset", levels, True) for levels in (-30, 30)),
    *(("blur", sigma, False) for sigma in (1, 2, 3)),
    *(("noise", levels, False) for levels in (5, 10, 20)),
    *(("JPEG quality", quality, False) for quality in (50, 20, 10)),
)


@dataclass(frozen=True)
class Tolerance:
    """Errors of muscles (rms over all that move, in frames that nothing was taught from, against
    what was captured undisturbed)."""

    clip: str
    head: str
    kind: str
    amount: float
    inside: bool  # of the paper's limits
    error: float
    grown: float  # by so much, from the undisturbed clip


def score_tolerance(report: Callable[[str], None]) -> Iterator[Tolerance]:
    for clip in clips("held-out", report):
        if clip.name not in CLIPS:
            continue
        report(f"{clip.name}: capture, teach")
        footage = Footage(clip.footage)
        performance = capture(clip.footage, (1, LAST))
        tried = (performance.frame - performance.frame[0]) // BLOCK % 2 == 1
        left_out = performance.frame[tried].tolist()
        taught = teach(footage, performance, [], NUM_CHOSEN, left_out=left_out)
        images = [np.ascontiguousarray(image) for _, image in footage.frames(1, LAST)]
        for head in HEADS:
            plain = 0.0
            for kind, amount, inside in CONDITIONS:
                error = _error(performance, taught, tried, images, head, kind, amount)
                plain = error if kind == "none" else plain
                yield Tolerance(clip.name, head, kind, amount, inside, error, error - plain)


def _error(
    performance: Performance,
    taught: TaughtSet,
    tried: NDArray[np.bool_],
    images: list[Image],
    head: str,
    kind: str,
    amount: float,
) -> float:
    camera = camera_of(performance.intrinsics, performance.image_size)
    # Free templates know how large the face is when they are placed, and not how it is now
    told = UNTOLD_ZOOM if head == "free" and kind == "scale" else kind
    own_camera = seen_by(camera, told, amount)
    view = PersonView(own_camera, performance.neutral_vertices, taught.sides, taught.pixel)
    start = performance.head_pose[0]
    pose = start if head == "free" else _moved(start, told, amount)
    random = np.random.default_rng(3)
    filtering = _core.FilterOptions()
    filtering.lag = 0.0
    first = disturbed(images[0], kind, amount, camera, random)
    puppet = Puppet(taught, view, first, pose, Mapping(taught), head, filtering)
    values = []
    for image in images:
        frame = disturbed(image, kind, amount, camera, random)
        values.append(puppet.advance(frame, 1 / performance.fps).values)
    own = np.array(values)[:, : len(performance.muscles)]
    moving = performance.activations.max(axis=0) > 0.1
    missed = (own - performance.activations)[tried][:, moving]
    return float(np.sqrt((missed**2).mean()))


def _moved(pose: NDArray[np.float64], kind: str, amount: float) -> NDArray[np.float64]:
    """Where a head seems to be once the picture was turned about the camera's axis, or zoomed
    without the lens being told."""
    moved = pose.copy()
    if kind == UNTOLD_ZOOM:
        moved[2, 3] /= 1 + amount / 100
    elif kind == "rotation":
        moved = np.eye(4)
        moved[:3, :3] = _core.from_rotation_vectors(np.array([[0, 0, np.radians(amount)]]))[0]
        moved = moved @ pose
    return moved


def seen_by(camera: _core.Camera, kind: str, amount: float) -> _core.Camera:
    """The camera of disturbed pictures, as far as it is told.

    A scale makes the whole picture larger or smaller, and the focal length with it, so that nothing
    leaves the picture and its perspective is that of the head where it is. Where the zoom is not
    told the head seems nearer or further away, but the perspective of such a head it has not.
    """
    if kind not in ("scale", UNTOLD_ZOOM):
        return camera
    size = 1 + amount / 100
    lens = size if kind == "scale" else 1.0
    width, height = _scaled_size((camera.width, camera.height), size)
    cx, cy = size * (camera.cx + 0.5) - 0.5, size * (camera.cy + 0.5) - 0.5
    return _core.Camera(lens * camera.fx, lens * camera.fy, cx, cy, width, height)


def _scaled_size(size: tuple[int, int], scale: float) -> tuple[int, int]:
    return round(scale * size[0]), round(scale * size[1])


def disturbed(
    image: Image, kind: str, amount: float, camera: _core.Camera, random: np.random.Generator
) -> Image:
    """The picture, H x W x 3, with one thing changed; rotation: degrees, clockwise; scale,
    zoom: percent by which the whole picture grows."""
    picture = Picture.fromarray(image)
    if kind in ("scale", UNTOLD_ZOOM):
        width, height = _scaled_size(picture.size, 1 + amount / 100)
        picture = picture.resize((width, height), Picture.Resampling.BICUBIC)
    elif kind == "rotation":
        c, s = np.cos(np.radians(amount)), np.sin(np.radians(amount))
        # Pillow counts from the corner of the first pixel
        x, y = camera.cx + 0.5, camera.cy + 0.5
        inverse = (c, s, x - c * x - s * y, -s, c, y + s * x - c * y)
        picture = picture.transform(
            picture.size, Picture.Transform.AFFINE, inverse, Picture.Resampling.BICUBIC
        )
    elif kind == "blur":
        picture = picture.filter(ImageFilter.GaussianBlur(amount))
    elif kind == "JPEG quality":
        stream = io.BytesIO()
        picture.save(stream, "jpeg", quality=int(amount))
        picture = Picture.open(stream)
    pixels = np.asarray(picture, dtype=np.float64)
    if kind == "gain":
        pixels = amount * pixels
    elif kind == "offset":
        pixels = pixels + amount
    elif kind == "noise":
        pixels = pixels + random.normal(0, amount, pixels.shape)
    return np.ascontiguousarray(np.clip(np.round(pixels), 0, 255).astype(np.uint8))
