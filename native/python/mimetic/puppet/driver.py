# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop of the live puppet: a frame in, scores, muscles and the head's pose out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.head.tracking import UNSEEN_COV
from mimetic.performance.gaze import value_units
from mimetic.puppet.mapping import UNTAUGHT_STD, Mapping
from mimetic.puppet.matching import free_matcher, still_matcher
from mimetic.puppet.seeing import FACE_DEPTH, MODEL, HeadStiller, Image, PersonView, Pose, centres
from mimetic.puppet.templates import TaughtSet

HEADS = ("surface", "ellipsoid", "free")
FILTERED_DEGREES = 10.0  # degrees that the filter takes as it takes an activation of 1
LEAST_SCORE, GOOD_SCORE = 0.3, 0.8  # best scores of a part that say nothing, and all


class PuppetFrame(NamedTuple):
    """What one frame says; scores and values are the last good ones where it is held."""

    scores: NDArray[np.float64]  # T
    values: NDArray[np.float64]  # C, filtered
    std: NDArray[np.float64]  # C
    pose: Pose  # camera from head
    pose_cov: NDArray[np.float64]  # 6 x 6
    quality: float  # 0 lost to 1
    held: bool


class Puppet:
    """One person in front of one camera.

    image, pose: a frame in which the head is known, camera from head. head: what holds the face
    still, of HEADS: the head's motion by the person's surface or the ellipsoid, or, `free`, the
    templates alone, as in the paper. Raises InvalidInput.
    """

    def __init__(
        self,
        taught: TaughtSet,
        view: PersonView,
        image: Image,
        pose: Pose,
        mapping: Mapping | None = None,
        head: str = MODEL,
        filtering: _core.FilterOptions | None = None,
    ) -> None:
        if head not in HEADS:
            raise InvalidInput(f"head {head!r}; there are {', '.join(HEADS)}")
        self.taught, self.view = taught, view
        self.mapping = mapping or Mapping(taught)
        parts = sorted(set(taught.template_parts))
        self.templates_of_parts = [taught.of_part(part) for part in parts]
        units = value_units(taught.channels, FILTERED_DEGREES)
        self.filter = _core.LowLagFilter(units, filtering or _core.FilterOptions())
        self.stiller = None if head == "free" else HeadStiller(view, image, pose, head)
        self.scale = 1.0
        if head == "free":
            self.matcher = self._free(pose)
        else:
            self.matcher = still_matcher(
                taught.pictures, taught.template_boxes, taught.template_parts
            )
        rest = taught.look_values[taught.neutral]
        self.last = PuppetFrame(
            scores=np.zeros(len(taught.template_parts)),
            values=rest,
            std=np.full(len(rest), UNTAUGHT_STD),
            pose=np.asarray(pose),
            pose_cov=UNSEEN_COV,
            quality=0.0,
            held=True,
        )

    def _free(self, pose: Pose) -> _core.TemplateMatcher:
        """Templates where the head at `pose` has them, in frames as large as the view."""
        camera, taught = self.view.camera, self.taught
        front = pose[:3, :3] @ [0.0, 0.0, FACE_DEPTH] + pose[:3, 3]
        self.scale = float(front[2] / (camera.fx * taught.pixel))
        middle = np.array(
            [
                camera.fx * front[0] / front[2] + camera.cx,
                camera.fy * front[1] / front[2] + camera.cy,
            ]
        )
        in_view = np.asarray(self.view.view.pixel_of(0.0, 0.0))
        places = centres(taught.template_boxes) - in_view + self.scale * (middle + 0.5) - 0.5
        return free_matcher(taught.pictures, np.ascontiguousarray(places), taught.template_parts)

    def advance(self, image: Image, seconds: float, guess: Pose | None = None) -> PuppetFrame:
        """The next frame, `seconds` after the last; guess: where a detector sees a lost head."""
        pose, pose_cov, quality = self.last.pose, self.last.pose_cov, 1.0
        if self.stiller is None:
            picture: Image | None = _core.scaled_gray(image, self.scale)
        else:
            picture, seen = self.stiller.still(image, guess)
            pose, pose_cov = np.asarray(seen.camera_from_head), np.asarray(seen.covariance)
            quality = float(seen.quality)
        if picture is None:
            self.filter.restart()
            self.last = self.last._replace(quality=0.0, held=True)
            return self.last
        scores = self.matcher.match(picture)[0]
        quality *= self._recognised(scores)
        state = self.mapping.state(scores)
        values = self.filter.advance(state.values, seconds)
        self.last = PuppetFrame(scores, values, state.std, pose, pose_cov, quality, False)
        return self.last

    def set_neutral(self) -> None:
        """Takes the face as it is now as at rest."""
        self.mapping.set_neutral(self.last.scores)

    def _recognised(self, scores: NDArray[np.float64]) -> float:
        """The share of the parts whose best template fits, 0 to 1."""
        best = [scores[templates].max() for templates in self.templates_of_parts]
        sure = np.clip((np.array(best) - LEAST_SCORE) / (GOOD_SCORE - LEAST_SCORE), 0, 1)
        return float(sure.mean())
