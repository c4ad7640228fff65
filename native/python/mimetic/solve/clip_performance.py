# SPDX-License-Identifier: GPL-3.0-or-later
"""The performance of a clip, from what was followed in it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy
from mimetic.performance.document import Performance
from mimetic.performance.rows import Rows
from mimetic.template.face_template import FaceTemplate


def clip_performance(
    rows: Rows,
    footage: Footage,
    fit: FaceFit,
    template: FaceTemplate,
    anatomy: Anatomy,
    scene_starts: Collection[int] = (),
    **further_fields: Any,
) -> Performance:
    """Frames, head motion and quality as the rows have them, on the fitted person.

    scene_starts: frames after a cut, of the rows or not. further_fields: of the `Performance`,
    such as its activations, and those that are to be otherwise than in the rows.
    """
    starts = sorted(start for start in scene_starts if rows.frame[0] < start <= rows.frame[-1])
    fields: dict[str, Any] = {
        "frame": np.array(rows.frame),
        "fps": float(footage.fps),
        "image_size": np.array(footage.size),
        "stored_size": np.array(footage.stored_size),
        "intrinsics": fit.intrinsics,
        "head_pose": rows.rigid_poses(),
        "head_pose_cov": rows.pose_covariances(),
        "muscles": list(anatomy.muscle_names),
        "muscle_modes": anatomy.muscle_modes,
        "groups": anatomy.groups,
        "articulators": list(anatomy.articulator_names),
        "articulator_modes": anatomy.articulator_modes,
        "neutral_vertices": fit.neutral_vertices(template),
        "faces": template.faces,
        "quality": np.clip(rows.quality, 0, 1),
        "footage": footage.identity,
        "scene_starts": np.array(starts) if starts else None,
    }
    return Performance(**(fields | further_fields))
