# SPDX-License-Identifier: GPL-3.0-or-later
"""Captures of rendered clips, kept so that they can be analysed again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mimetic.performance.document import Performance
from mimetic.solve.clip_capture import capture

from evaluation.runs.own_process import in_own_process
from evaluation.synthetic.clips import Clip

Report = Callable[[str], None]


@dataclass(frozen=True)
class KeptCaptures:
    """out: where captures are kept as NAME.npz; folder: where those of an earlier run are."""

    out: Path | None
    folder: Path | None
    report: Report

    def of(self, name: str, render: Callable[[], Clip]) -> Performance:
        """The clip's capture, made unless the folder has it; then it is not rendered either."""
        if self.folder is not None and (path := self.folder / f"{name}.npz").exists():
            performance = Performance.load(path)
        else:
            clip = render()
            self.report(f"{name}: capturing")
            performance = in_own_process(capture, clip.footage)
        if self.out is not None:
            performance.save(self.out / f"{name}.npz")
        return performance
