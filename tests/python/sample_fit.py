# SPDX-License-Identifier: GPL-3.0-or-later
"""A made-up face fit that has something in every field."""

import numpy as np
from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.rest_choice import RestChoice
from mimetic.fit.still_cover import StillCover
from mimetic.muscles.calibration import Calibration


def make_fit(**changes):
    pose = np.diag([1.0, -1, -1, 1])
    pose[2, 3] = 0.6
    steps = np.linspace(-1, 1, 7)
    jaw = np.stack([160 + 40 * steps, 170 - 20 * steps**2], axis=1)
    normals = np.tile([0.0, 1.0], (7, 1))
    pupils = {"pupil.L": (180.0, 110.0), "pupil.R": (140.0, 110.5)}
    measured = _core.FaceFeatures(
        [_core.Feature(name, place, 0.8, 0.9) for name, place in pupils.items()],
        [_core.FeatureCurve("jaw", jaw, normals, np.full(7, 1.5))],
        np.array([110.0, 70, 100, 110]),
        0.97,
    )
    motion = np.array([[12, 0.5, -0.25, 0.1], [40, 1.5, 0.75, 0.2]])
    values = {
        "frame": 4,
        "image_size": (320, 240),
        "intrinsics": np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]),
        "head_pose": pose,
        "identity": {"head_round": 0.4},
        "features": pupils,
        "error": 0.03,
        "warnings": ["2 faces in frame 4"],
        "residual": [0.5, -0.25, 0.125],
        "views": [
            FittedView(4, pose, measured, {"chin": (160.0, 200.0)}),
            FittedView(9, pose, measured, {}, motion),
        ],
        "relief": [0.1, 0.0, -0.2],
        "depth": [[0.001, 0.0, -0.002], [0.0, 0.0, 0.003]],
        "depth_std": [0.002, 0.0035],
        "lines": [0.2, -0.1],
        "calibration": Calibration(
            {"cheeks": 1.8},
            {"mentalis.L": 0.9},
            {"mentalis.L": (1.0, -0.5)},
            [4, 9],
            {"zygomaticus_major.R": 1.25},
        ),
        "rest": RestChoice("usual", 16, 11),
        "still_cover": StillCover((20.5, 180.0), 4.25, ("..##", "###.")),
    }
    return FaceFit(**(values | changes))
