# SPDX-License-Identifier: GPL-3.0-or-later
from types import SimpleNamespace

import numpy as np
from mimetic import _core
from mimetic.performance.rows import Rows, State

ARRAYS = ("camera_from_head", "pose_cov", "values", "values_std", "detail", "detail_std", "irises")


def test_rows_keep_no_estimate_alive(monkeypatch):
    # The core's takes a real estimate; a view of this one would be the worst that it could return
    monkeypatch.setattr(_core, "pack_evidence", lambda estimate: estimate.values)
    large = np.zeros((4, 1000))
    estimate = SimpleNamespace(quality=1.0, **{name: large[:, :3] for name in ARRAYS})
    rows = Rows()
    rows.append(State(1, estimate, held=False))
    kept = (
        rows.pose,
        rows.pose_cov,
        rows.values,
        rows.values_std,
        rows.detail,
        rows.detail_std,
        rows.irises,
        rows.evidence,
    )
    for column in kept:
        assert not np.shares_memory(column[0], large)
