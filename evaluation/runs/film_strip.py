# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a video side by side: python -m evaluation.runs.film_strip VIDEO --out STRIP.png"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.footage import Footage
from PIL import Image


def strip(video: Path, num_frames: int, height: int) -> Image.Image:
    footage = Footage(video)
    chosen = set(np.linspace(1, len(footage.times), num_frames).round().astype(int).tolist())
    pictures = [Image.fromarray(picture) for frame, picture in footage if int(frame) in chosen]
    width = round(pictures[0].width * height / pictures[0].height)
    row = Image.new("RGB", (width * len(pictures), height))
    for column, picture in enumerate(pictures):
        small = picture.resize((width, height), Image.Resampling.LANCZOS)
        row.paste(small, (column * width, 0))
    return row


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.film_strip", description=__doc__)
    parser.add_argument("video", type=Path)
    parser.add_argument("--frames", type=int, default=5, help="how many (default: 5)")
    parser.add_argument("--height", type=int, default=180, help="pixels (default: 180)")
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    options = parser.parse_args(arguments)
    try:
        strip(options.video, options.frames, options.height).save(options.out)
    except (InvalidInput, UnreadableMedia) as error:
        print(f"film_strip: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
