# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut panels and windows out of what tests/window/test_panels.py photographed, for docs/images.

usage: panel_pictures.py FOLDER
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image

IMAGES = Path(__file__).resolve().parents[3] / "docs" / "images" / "panels"
COLOURS = 48  # of a panel, which is grey but for its icons
WINDOW_QUALITY = 85  # of a window, which shows a picture too
WINDOW_WIDTH = 900
MARGIN = 4  # pixels kept below the last line
CORNER = 24  # rows at an editor's lower edge, where a Graph Editor has an arrow for its lower bar


def cut_out(screen: Image.Image, place: list[int]) -> Image.Image:
    """The panel: the sidebar down to where nothing is drawn any more."""
    left, top, width, height = place
    region = screen.crop((left, top, left + width, top + height))
    rows = np.asarray(region.convert("RGB")).astype(int)[:-CORNER]
    is_drawn = np.abs(rows - rows[-1]).max(axis=(1, 2)) > 3
    last = int(np.flatnonzero(is_drawn)[-1]) + 1 + MARGIN
    return region.crop((0, 0, width, min(last, height)))


def keep_panel(picture: Image.Image, target: Path) -> None:
    small = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    small.save(target, optimize=True)
    print(f"{target.name}: {picture.width} x {picture.height}, {target.stat().st_size} bytes")


def keep_window(screen: Image.Image, target: Path) -> None:
    height = round(screen.height * WINDOW_WIDTH / screen.width)
    small = screen.convert("RGB").resize((WINDOW_WIDTH, height), Image.Resampling.LANCZOS)
    small.save(target, quality=WINDOW_QUALITY, optimize=True)
    print(f"{target.name}: {small.width} x {small.height}, {target.stat().st_size} bytes")


def main() -> int:
    folder = Path(sys.argv[1])
    IMAGES.mkdir(parents=True, exist_ok=True)
    places = json.loads((folder / "panels.json").read_text(encoding="utf-8"))
    for name, place in places.items():
        with Image.open(folder / f"{name}.png") as screen:
            keep_panel(cut_out(screen, place), IMAGES / f"{name.removeprefix('panel-')}.png")
    for path in sorted(folder.glob("window-*.png")):
        with Image.open(path) as screen:
            keep_window(screen, IMAGES / f"{path.stem}.jpg")
    return 0


if __name__ == "__main__":
    sys.exit(main())
