# SPDX-License-Identifier: GPL-3.0-or-later
"""Another scene is told from a page that scrolls beside the face and from a camera that shakes."""

import numpy as np
import pytest
from mimetic import _core
from mimetic.media.cuts import CutWatch, of_one_scene
from PIL import Image

WIDTH, HEIGHT = 640, 360
FACE = (440, 200, 120)  # its middle, and its square's side
SHAKE = ((0, 0), (12, -7), (-6, 10), (9, 9), (-14, -3))  # pixels, frame by frame
SCALES = (0.25, 1, 6)  # pictures of 160 x 90 to 3840 x 2160


def blotches(width, height, seed, patch):
    """A smooth picture with much contrast, each patch of its own brightness."""
    levels = np.random.default_rng(seed).integers(
        0, 256, (height // patch, width // patch), np.uint8
    )
    smooth = Image.fromarray(levels).resize((width, height), Image.Resampling.BICUBIC)
    return np.repeat(np.asarray(smooth)[..., None], 3, axis=2)


def scene(room=1, person=1, face=FACE):
    picture = blotches(WIDTH, HEIGHT, room, 20)
    x, y, side = face
    own = blotches(side, side, 100 + person, 15)
    picture[y - side // 2 : y + side // 2, x - side // 2 : x + side // 2] = own
    return picture


def scrolled(step):
    """A page that has been scrolled by so many rows, and the webcam's window in its corner."""
    page = np.roll(blotches(WIDTH, 4 * HEIGHT, 7, 10), -step, axis=0)[:HEIGHT].copy()
    x, y, side = FACE
    page[y - side : y + side, x - side : x + side] = scene()[
        y - side : y + side, x - side : x + side
    ]
    return page


def cuts_in(frames, face=FACE, scale=1):
    """Which frames start a scene; face: where each frame shows it, None where nobody knows."""
    where = face and _core.FeatureCrop(scale * np.array(face[:2], float), scale * face[2])
    watch = CutWatch()
    size = (round(scale * WIDTH), round(scale * HEIGHT))
    shown = (
        frame if scale == 1 else np.asarray(Image.fromarray(frame).resize(size)) for frame in frames
    )
    return [i for i, frame in enumerate(shown) if watch.starts_scene(frame, where)]


@pytest.mark.parametrize("scale", SCALES)
def test_a_page_that_scrolls_beside_the_face_is_no_cut(scale):
    frames = [scrolled(137 * i) for i in range(4)]
    assert cuts_in(frames, face=None, scale=scale) == [1, 2, 3]
    assert cuts_in(frames, scale=scale) == []


@pytest.mark.parametrize("face", [FACE, (600, 350, 120), None])
@pytest.mark.parametrize("scale", SCALES)
def test_a_camera_that_shakes_is_no_cut(scale, face):
    """Also where the face is at the picture's edge, or lost."""
    room = np.pad(scene(), ((20, 20), (20, 20), (0, 0)), mode="reflect")
    frames = [room[20 + y : 20 + y + HEIGHT, 20 + x : 20 + x + WIDTH] for x, y in SHAKE]
    assert np.abs(frames[1].astype(float) - frames[0]).mean() > 18
    assert cuts_in(frames, face, scale) == []


@pytest.mark.parametrize("face", [FACE, None])
@pytest.mark.parametrize("gain", [0.6, 1.5])
def test_light_that_jumps_is_no_cut(gain, face):
    lit = np.clip(scene() * gain, 0, 255).astype(np.uint8)
    assert cuts_in([scene(), lit, scene(), lit, lit], face) == []


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(
    "other",
    [
        scene(room=2, face=(160, 160, 120)),  # the same person elsewhere
        scene(room=2, person=2),  # another person in the same place
        scene(room=2, face=(440, 200, 160)),  # the same person from nearer
        np.zeros((HEIGHT, WIDTH, 3), np.uint8),
    ],
    ids=["elsewhere", "another person", "nearer", "black"],
)
def test_another_scene_is_a_cut(other, scale):
    frames = [scene(), scene(), other, other, scene()]
    assert cuts_in(frames, scale=scale) == [2, 4]
    assert cuts_in(frames, None, scale) == [2, 4]


def test_a_scene_goes_on_beside_a_page_that_scrolls():
    frames = [scrolled(0), scrolled(137), scrolled(274), scene(room=2, person=2), scrolled(411)]
    face = _core.FeatureCrop(np.array(FACE[:2], float), FACE[2])
    kept = of_one_scene(frames[0], iter(list(enumerate(frames))[1:]), face)
    assert [frame for frame, _ in kept] == [1, 2]
