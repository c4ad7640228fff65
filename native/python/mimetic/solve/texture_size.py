# SPDX-License-Identifier: GPL-3.0-or-later
"""How finely footage is measured: as its face holds what is fine.

Where a codec or a lens has left nothing of what is fine, a finer texture follows the codec: blocks
that stay where they were, and ghosts. Where a sensor has little light it follows noise.
"""

from __future__ import annotations

import itertools
from statistics import fmean

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.media.backward import frames_away
from mimetic.media.cuts import of_one_scene
from mimetic.media.footage import Footage
from mimetic.solve.face_place import FacePlace
from mimetic.solve.tracking import measured_skin
from mimetic.template.face_template import FaceTemplate

Image = NDArray[np.uint8]

# Pixels of the face in the reference texture, and between samples; docs/measured/evaluation.md,
# "How finely a capture measures"
COARSE, FINE = (200, 4), (300, 6)
LEAST_FINE = 0.125  # contrast of the face from which on the finer texture is taken
# Pairs of frames round the fit's: what is coded anew, and what is made of frames before. After it
# alone the head may turn so fast that flow brings little of what is fine back.
LOOKED_AT = 24
# Of how much the pictures change on the mean: one that changes less is shown again, with its noise
SHOWN_AGAIN = 1 / 3


def tracker_options(
    reference: Image,
    footage: Footage,
    fit: FaceFit,
    neutral: NDArray[np.float64],
    template: FaceTemplate,
) -> _core.TrackerOptions:
    """Options for following the fit's face through the footage.

    reference: H x W x 3, the footage's frame `fit.frame`; neutral: V x 3, metres, head frame, the
    fit's. Raises InvalidInput.
    """
    is_fine = fine_contrast(reference, footage, fit, neutral, template) >= LEAST_FINE
    options = _core.TrackerOptions()
    options.crop_height, options.sample_spacing = FINE if is_fine else COARSE
    return options


def fine_contrast(
    reference: Image,
    footage: Footage,
    fit: FaceFit,
    neutral: NDArray[np.float64],
    template: FaceTemplate,
) -> float:
    """The mean of `_core.fine_contrast` over the frames round the fit's, of its scene.

    Each is compared with the one beside it that is farther from the fit's. Pictures that are shown
    again do not count; a frame without any beside it is compared with itself.
    """
    measured = measured_skin(neutral, template)
    pose = np.asarray(fit.head_pose)
    face = measured @ pose[:3, :3].T + pose[:3, 3]
    first = max(1, min(fit.frame - LOOKED_AT // 2, footage.num_frames - LOOKED_AT))
    seen = []
    for end in (first, min(first + LOOKED_AT, footage.num_frames)):
        beside = frames_away(footage, fit.frame, end)
        of_scene = of_one_scene(reference, beside, FacePlace(fit).at(pose))
        images = itertools.chain([reference], (image for _, image in of_scene))
        seen += [
            (
                _core.fine_contrast(one, next_to_it, fit.camera, face, FINE[0]),
                _change(one, next_to_it),
            )
            for one, next_to_it in itertools.pairwise(images)
        ]
    if not seen:
        return _core.fine_contrast(reference, reference, fit.camera, face, FINE[0])
    least = SHOWN_AGAIN * fmean(change for _, change in seen)
    return fmean(contrast for contrast, change in seen if change >= least)


def _change(one: Image, other: Image) -> float:
    """Of some of the pixels, noise and all: mean absolute difference, grey levels."""
    few = slice(None, None, 8), slice(None, None, 8)
    return float(np.abs(other[few].astype(np.int16) - one[few]).mean())
