# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
from mimetic.shared.picture import as_rgb


def test_rgb_of_grey_and_of_transparent_pictures():
    grey = np.arange(400, dtype=np.uint8).reshape(20, 20)
    assert (as_rgb(grey) == grey[:, :, None]).all()
    assert as_rgb(np.dstack([grey] * 4)).shape == (20, 20, 3)
