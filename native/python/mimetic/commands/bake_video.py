# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake --out FACE.mp4`: the baked face beside its footage, from the same camera."""

from __future__ import annotations

import os
from pathlib import Path

from mimetic import UnreadableMedia
from mimetic.commands.console import Console
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.beside import BesideDrawing, baked
from mimetic.report.overlay import NoFrames, write_overlay
from mimetic.shared.progress import stages

CONTACT = 0.05  # of what a frame's pictures cost, to find what lips and lids do to each other


def write_video(
    performance: Performance,
    footage: os.PathLike[str],
    out: Path,
    with_detail: bool,
) -> str:
    """Writes `out`, whole or not at all; returns a line that says what is in it.

    Raises InvalidInput where the footage is of another size, UnreadableMedia where it has none of
    the frames, OSError.
    """
    with Console() as console:

        def show(fraction: float, text: str) -> bool:
            console.show(fraction, text)
            return True  # Ctrl-C raises

        touching, drawing = stages(show, CONTACT * performance.num_frames, performance.num_frames)
        clip = Footage(footage)
        pictures = BesideDrawing(baked(performance, with_detail, touching), footage)
        try:
            write_overlay(performance, clip, out, drawing, pictures)
        except NoFrames:
            raise UnreadableMedia(
                f"--footage {footage} has none of the frames {performance.frame[0]} to "
                f"{performance.frame[-1]} that can be read"
            ) from None
        finally:
            for warning in clip.warnings:
                console.tell(f"note: {warning}")
    return (
        f"{performance.num_frames} frames: the footage at the left, the baked face at the right, "
        "enlarged below"
    )
