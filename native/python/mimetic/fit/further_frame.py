# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit that rests on further frames, so that its landmarks can be seen and pinned there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.fit.face_fit import MOST_VIEWS, FaceFit
from mimetic.fit.fitting import find_face, refit


def with_frame(fit: FaceFit, image: NDArray[np.uint8], frame: int) -> FaceFit:
    """The person fitted to one more frame; what was measured and pinned in others stays.

    image: (H, W, 3) uint8 RGB, the frame `frame` of the same footage. A frame that the fit rests on
    already is measured anew and keeps its pins. Of several faces the one nearest to where the fit
    has its own is taken. Raises NoFace and InvalidInput.
    """
    height, width = np.shape(image)[:2]
    if (width, height) != tuple(fit.image_size):
        raise InvalidInput(
            f"the face fit is for pictures of {fit.image_size[0]} x {fit.image_size[1]}, "
            f"frame {frame} has {width} x {height}"
        )
    if not fit.views:
        raise InvalidInput("the face fit is from an older version of Mimetic: fit again")
    (view,) = find_face(image, frame, camera=fit.camera, near=fit.head_place()).views
    if earlier_view := fit.view(frame):
        view.pins, view.motion = dict(earlier_view.pins), earlier_view.motion
        views = [view if v.frame == frame else v for v in fit.views]
    elif len(fit.views) == MOST_VIEWS:
        raise InvalidInput(f"the face is fitted to {MOST_VIEWS} frames already")
    else:
        views = [*fit.views, view]
    whole = replace(fit, views=views, head_pose=views[0].head_pose)
    return refit(whole, whole.pins.get(frame, {}), frame)
