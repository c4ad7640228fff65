# SPDX-License-Identifier: GPL-3.0-or-later
"""How a capture went."""

from __future__ import annotations

from dataclasses import dataclass, field

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage


@dataclass
class CaptureSummary:
    """How a capture went: for the report."""

    seconds: dict[str, float] = field(default_factory=dict)  # by stage
    tracker_seconds: dict[str, float] = field(default_factory=dict)  # of following, by its stages
    settings: dict[str, str] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    fit: FaceFit | None = None
    head_shape: _core.HeadShape | None = None  # as head tracking left it
    footage: Footage | None = None  # as it was read: warnings, failure
    stopped: bool = False

    def add(self, stage: str, seconds: float) -> None:
        self.seconds[stage] = self.seconds.get(stage, 0.0) + seconds

    def add_tracker(self, times: _core.StageTimes) -> None:
        for stage in ("predict", "features", "warp", "flow", "solve"):
            seconds = getattr(times, f"{stage}_ms") / 1e3
            self.tracker_seconds[stage] = self.tracker_seconds.get(stage, 0.0) + seconds
