# SPDX-License-Identifier: GPL-3.0-or-later
"""The head that a live filter follows, made from a picture: a stranger's, or one known before."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_shape import face_shape
from mimetic.fit.known_lens import KnownLens, camera_with
from mimetic.fit.person import with_person, with_shape_of
from mimetic.muscles.anatomy import Anatomy
from mimetic.puppet.live_face import LiveFace, live_face, own_anatomy
from mimetic.shared.pinhole import FULL_FRAME_MM
from mimetic.template.face_template import load_template

# Root mean square difference of two fits' coefficients of shape, in their own standard deviations,
# above which they are of two people: docs/measured/live.md has what it is of the same and of others
UNLIKE = 0.33
STRANGER = (
    "the face does not look like the fit's: it is followed on a head of its own; if it is the "
    "same person, look into the camera at rest and start again, or make the fit anew"
)

# How long pictures are judged for the face at rest, seconds, and how many
SEARCH, KNOWN_SEARCH = (4.0, 10), (8.0, 20)

Image = NDArray[np.uint8]
Judgement = fitting.Judged | float


def lens_of_fit(fit: FaceFit) -> KnownLens:
    """The lens that a fit has, for other pictures of the same camera, in whatever size."""
    focal = float(fit.intrinsics[0, 0])
    return KnownLens(focal / fit.image_size[0] * FULL_FRAME_MM, FULL_FRAME_MM)


def unlikeness(one: FaceFit, other: FaceFit) -> float:
    """How far two heads' proportions are from each other, compared with how people differ."""
    shape = face_shape(load_template())
    apart = shape.joined(one.identity, one.residual) - shape.joined(other.identity, other.residual)
    return float(np.sqrt(np.mean(apart**2)))


class LiveHeads:
    """Heads for one session's pictures.

    lens: that these are taken with, if it is known; person: a fit of the one who is expected, whose
    proportions, muscles and calibration are taken as they are.
    """

    def __init__(self, lens: KnownLens | None = None, person: FaceFit | None = None) -> None:
        self._lens, self._person = lens, person
        self.is_stranger = False  # at rest the face was not that of the person who is expected

    def prepare(self) -> None:
        """What takes a second and can be done before there is a picture."""
        if self._person is not None:
            _ = self._anatomy

    @property
    def search(self) -> tuple[float, int]:
        """Seconds, and number of pictures; a head that is known can wait for a better one."""
        return SEARCH if self._person is None else KNOWN_SEARCH

    def judge(self, image: Image) -> Judgement | None:
        """What `most_at_rest` compares; None where there is no face.

        Of a person who is known it is how far the head that fits is from theirs: an expression is
        taken for shape.
        """
        if self._person is None:
            return fitting.judge_frame(image)
        try:
            return unlikeness(self._found(image), self._person)
        except InvalidInput:
            return None

    def most_at_rest(self, judgements: Sequence[Judgement]) -> NDArray[np.intp]:
        """Indices, the picture most at rest first."""
        judged = [one for one in judgements if isinstance(one, fitting.Judged)]
        if not judged:
            return np.argsort([one for one in judgements if isinstance(one, float)])
        chances = _core.chances_of_rest(
            _core.rest_scores([one.signs for one in judged]),
            np.array([one.detail for one in judged]),
            np.array([one.expression for one in judged]),
        )
        return np.argsort(-chances)

    def first(self, image: Image) -> LiveFace:
        """To begin with, from a picture (H x W x 3) in which the face may do anything.

        The canonical head's muscles move it, unless the person is known: whether it is that person
        cannot be told from a face in motion. Raises InvalidInput where no face is found.
        """
        found = self._found(image)
        self.is_stranger = False
        return live_face(image, found) if self._person is None else self._known(image, found)

    def own(self, image: Image) -> LiveFace:
        """As well as it can be known from a picture of the face at rest. Raises InvalidInput."""
        found = self._found(image)
        if self._person is not None:
            self.is_stranger = unlikeness(found, self._person) > UNLIKE
            if not self.is_stranger:
                return self._known(image, found)
        return live_face(image, found, own_anatomy(found), is_own=True)

    def _known(self, image: Image, found: FaceFit) -> LiveFace:
        """The person's head, where a face was found; a grimace leaves no better place than that."""
        assert self._person is not None
        try:
            placed = with_person(found, self._person)
        except InvalidInput:
            placed = with_shape_of(found, self._person)
        return live_face(image, placed, self._anatomy, is_own=True)

    def _found(self, image: Image) -> FaceFit:
        height, width = image.shape[:2]
        return fitting.find_face(image, camera=camera_with(self._lens, (width, height)))

    @cached_property
    def _anatomy(self) -> Anatomy:
        assert self._person is not None
        return own_anatomy(self._person)
