# SPDX-License-Identifier: GPL-3.0-or-later
"""What templates are matched with: the face held still, by its motion or by the templates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.head.tracking import head_shape
from mimetic.puppet.parts import FACE, part_box
from mimetic.template.face_template import FaceTemplate, load_template

Image = NDArray[np.uint8]
Pose = NDArray[np.float64]
# The person's own surface: with the ellipsoid a turn of the head is read as a larger one, which
# shifts what is seen of the face (docs/measured/puppet.md)
MODEL = "surface"
PIXEL = 1e-3  # metres on the face
MARGIN = 0.008  # metres around the face in the view, for the search windows
# What is seen of a face from the front; the rest is hair, or inside
HIDDEN = ("neck", "ear", "mouth_cavity", "eye_socket")
FACE_DEPTH = 0.09  # metres from the head's origin to the face
# What the head's pose may be off by in another run, standard deviations
TURN_ERROR = np.radians(2.0)
SHIFT_ERROR = 1e-3  # metres
RADIUS = 3.0  # pixels of the view that a template is searched for in: what tracking is off by
FREE_RADIUS = 12.0  # the same where the templates follow the face by themselves
FREE_SCALES = (1 / 1.15, 1 / 1.07, 1.0, 1.07, 1.15)
FREE_ROTATIONS = tuple(np.radians([-10.0, -5.0, 0.0, 5.0, 10.0]).tolist())


class PersonView:
    """A person's face as from straight in front.

    camera: of the frames; neutral_vertices: V x 3 of the canonical head's mesh, metres.
    """

    def __init__(
        self,
        camera: _core.Camera,
        neutral_vertices: NDArray[np.float64],
        sides: NDArray[np.float64] | None = None,
        pixel: float = PIXEL,
    ) -> None:
        self.camera, self.neutral = camera, neutral_vertices
        self.template: FaceTemplate = load_template()
        if sides is None:
            left, right, bottom, top = part_box(FACE, neutral_vertices, self.template)
            sides = np.array([left - MARGIN, right + MARGIN, bottom - MARGIN, top + MARGIN])
        self.sides, self.pixel = sides, pixel
        options = _core.FrontViewOptions()
        options.pixel = pixel
        options.left, options.right, options.bottom, options.top = map(float, sides)
        vertices, faces = self._shown()
        self.view = _core.FrontView(camera, vertices, faces, options)

    def _shown(self) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """The skin's limit surface, where the face is, and its visible quads."""
        count = self.template.num_skin_vertices
        quads = np.ascontiguousarray(self.template.skin_faces, dtype=np.int32)
        skin = np.ascontiguousarray(self.neutral[:count])
        limit = _core.SubdividedMesh(quads, count, 0).positions(skin)[:count]
        is_hidden = self.template.in_region(*HIDDEN)
        shown = np.ascontiguousarray(quads[~is_hidden[quads].any(axis=1)])
        return np.ascontiguousarray(limit), shown

    def picture(self, image: Image, pose: Pose) -> Image:
        """Height x width of the view, for the head at `pose` (camera from head)."""
        return self.view.picture(image, pose)

    def boxes(self, part: str) -> NDArray[np.int64]:
        """x, y, width, height of a part in the view, pixels."""
        left, right, bottom, top = part_box(part, self.neutral, self.template)
        low, high = self.view.pixel_of(left, top), self.view.pixel_of(right, bottom)
        x, y = np.round(low).astype(int)
        width, height = np.round(np.subtract(high, low)).astype(int)
        return np.array([x, y, width, height])


def centres(boxes: NDArray[np.int64]) -> NDArray[np.float64]:
    """T x 2, pixels, of boxes T x 4."""
    return boxes[:, :2] + 0.5 * (boxes[:, 2:] - 1)


class PoseShaker:
    """Poses as a head tracker may be off: about the face, and little in the picture."""

    def __init__(self, seed: int = 1) -> None:
        self.random = np.random.default_rng(seed)

    def shaken(self, pose: Pose) -> Pose:
        turn = _core.from_rotation_vectors(self.random.normal(0, TURN_ERROR, (1, 3)))[0]
        middle = np.array([0.0, 0.0, FACE_DEPTH])
        shake = np.eye(4)
        shake[:3, :3] = turn
        shake[:3, 3] = middle - turn @ middle + self.random.normal(0, SHIFT_ERROR, 3)
        return pose @ shake


class HeadStiller:
    """Frames, one after the other, as pictures in which the head is still.

    image, pose: a frame in which the head is known; it is followed from there. model: of
    `mimetic.head.tracking.MODELS`.
    """

    def __init__(self, view: PersonView, image: Image, pose: Pose, model: str = MODEL) -> None:
        self.view = view
        options = _core.HeadOptions()
        shape = head_shape(model, view.neutral, view.template)
        self.tracker = _core.HeadTracker(
            view.camera, shape, np.ascontiguousarray(image), np.ascontiguousarray(pose), options
        )

    def still(
        self, image: Image, guess: Pose | None = None
    ) -> tuple[Image | None, _core.HeadEstimate]:
        """The picture, None where the head is lost; guess: where a detector sees it."""
        head = self.tracker.advance(image, guess)
        if head.held:
            return None, head
        return self.view.picture(image, np.asarray(head.camera_from_head)), head
