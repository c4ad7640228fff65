# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage that was filmed sideways, with no or a wrong rotation in the file: told by the face."""

from __future__ import annotations

import shlex

import numpy as np
from numpy.typing import NDArray

from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import NoFace
from mimetic.fit.network_evidence import SURE_PRESENCE, presence
from mimetic.locate.feature_networks import feature_anchors
from mimetic.media.footage import Footage
from mimetic.template.face_template import load_template

SURE = 0.8  # likelihood of a face above which it can only be upright
# Quarter turns to the left that set the picture upright: where the head points, ffmpeg's filter
TURNS = {
    1: ("to the right", "transpose=cclock"),
    2: ("down", "hflip,vflip"),
    3: ("to the left", "transpose=clock"),
}


def check_upright(
    footage: Footage, frame: int, image: NDArray[np.uint8], fit: FaceFit | None = None
) -> None:
    """Raises NoFace, with how to mend it, if the face in `image` lies on its side or head.

    fit: the head that was fitted to the image, if one was: where networks are sure of its face it
    is upright, and the picture is not searched again, turned three times.

    What resembles a face in the picture as it is, is less likely one then than the face in the
    picture turned. Other people's pictures on a wall may lie as they like: they fit no head.
    """
    turns = 0 if fit is not None and _is_sure_of(image, fit) else turns_to_upright(image)
    if not turns:
        return
    where, turning = TURNS[turns]
    source = shlex.quote(str(footage.path))
    says = f"turns it by {footage.rotation} degrees" if footage.rotation else "does not turn it"
    raise NoFace(
        f"{footage.path.name}: the head points {where} in frame {frame}, and the file {says}: set "
        f"it upright (ffmpeg -i {source} -vf {turning} upright.mp4) and take that clip"
    )


def _is_sure_of(image: NDArray[np.uint8], fit: FaceFit) -> bool:
    template = load_template()
    anchors = feature_anchors(fit.neutral_vertices(template), template)
    return (presence(image, fit.camera, fit.head_pose, anchors) or 0.0) >= SURE_PRESENCE


def turns_to_upright(image: NDArray[np.uint8]) -> int:
    """Quarter turns to the left (H x W x 3 RGB) after which a head is seen best, 0 to 3."""
    best, likelihood = 0, fitting.face_likelihood(image)
    if likelihood > SURE:
        return 0
    for turns in TURNS:
        turned_image = np.ascontiguousarray(np.rot90(image, turns))
        own_likelihood = fitting.face_likelihood(turned_image)
        if own_likelihood > likelihood and _shows_a_head(turned_image):
            best, likelihood = turns, own_likelihood
    return best


def _shows_a_head(image: NDArray[np.uint8]) -> bool:
    try:
        fitting.find_face(image)
    except NoFace:
        return False
    return True
