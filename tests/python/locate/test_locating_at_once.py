# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that are looked for in several threads are those that one thread finds."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from mimetic.fit.fitting import judge_frame
from mimetic.media.footage import Footage

SIGNS = ("frontal", "mouth_contrast", "mouth_edges", "cheek_contrast", "pupil_brightness")


def told(judged) -> np.ndarray:
    places = [feature.position for feature in judged.features.features]
    signs = [getattr(judged.signs, name) for name in SIGNS]
    return np.concatenate([judged.expression, signs, [judged.detail], *places])


def test_threads_do_not_meet_in_the_detector(rendered_clip):
    frames = [image.copy() for _, image in Footage(rendered_clip.footage).frames(1, 12)]
    alone = [told(judge_frame(image)) for image in frames]
    with ThreadPoolExecutor(4) as pool:
        together = [told(judged) for judged in pool.map(judge_frame, 3 * frames)]
    np.testing.assert_array_equal(together, 3 * alone)
