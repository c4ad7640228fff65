# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage as it is named on the command line: a video file, or numbered pictures and their rate."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic import InvalidInput
from mimetic.media.image_sequence import USUAL_FPS, ImageSequence, is_sequence


def add_footage_argument(parser: argparse.ArgumentParser, shown: str) -> None:
    """shown: what the footage must show, such as "one face"."""
    parser.add_argument(
        "footage",
        type=Path,
        help=f"video of {shown}: a file, or numbered pictures (their folder, a pattern such as "
        "frame_%%04d.png, or the first of them)",
    )
    parser.add_argument(
        "--fps",
        type=float,
        metavar="N",
        help=f"frames a second of numbered pictures, which do not say so (default: {USUAL_FPS})",
    )


def give_rate(arguments: argparse.Namespace) -> None:
    """Makes the footage of numbered pictures play at the rate that was given, if one was.

    Raises InvalidInput, UnreadableMedia.
    """
    if arguments.fps is None:
        return
    if not is_sequence(arguments.footage):
        raise InvalidInput("--fps is of numbered pictures; a video file has a rate of its own")
    arguments.footage = ImageSequence(arguments.footage, arguments.fps)
