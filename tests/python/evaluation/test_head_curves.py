# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 16: six parameters beside truth."""

import numpy as np

from evaluation.runs.head_curves import six_parameters
from evaluation.synthetic.motion import HeadMotion, rotation

FPS = 30.0


def test_six_parameters_are_the_truths_whatever_axes_scale_and_point_a_method_has():
    truth = HeadMotion(yaw=20).poses(np.arange(60) / FPS, 0.6, seed=3)
    poses = truth.copy()
    poses[:, :3, :3] = truth[:, :3, :3] @ rotation(0.3, -0.2, 0.1)
    poses[:, :3, 3] = 1.3 * (truth[:, :3, 3] + truth[:, :3, :3] @ (0.01, -0.02, 0.03))
    expected = six_parameters(truth, truth, FPS)
    np.testing.assert_allclose(six_parameters(poses, truth, FPS), expected, atol=1e-6)
    np.testing.assert_allclose(expected[:, 3:], 1000 * truth[:, :3, 3], atol=1e-6)
    poses[20:30] = np.nan  # lost
    values = six_parameters(poses, truth, FPS)
    assert np.isnan(values[20:30]).all() and np.isfinite(values[30:]).all()
    poses[:] = np.nan
    assert np.isnan(six_parameters(poses, truth, FPS)).all()
