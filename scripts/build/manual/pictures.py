# SPDX-License-Identifier: GPL-3.0-or-later
"""Scale what scripts/paper_figures drew of the drawn person to docs/images, small enough to keep.

usage: pictures.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

IMAGES = Path(__file__).resolve().parents[3] / "docs" / "images"
# The paper's figure: what shows ours, and the width in pixels that it keeps
PICTURES = {
    "paper-02.png": ("loops.png", 900),
    "paper-03.jpg": ("fit/canonical.png", 256),
    "paper-04.jpg": ("fit/fit.png", 480),
    "paper-05.jpg": ("people.jpg", 900),
    "paper-06.png": ("AU12/motion.png", 900),
    "paper-07.png": ("AU12/neutral.png", 720),
    "paper-08.png": ("AU12/courses.png", 720),
    "paper-09.png": ("AU12/difference.png", 900),
    "paper-10.png": ("timing/groups.png", 720),
    "paper-12.png": ("parts/templates.png", 720),
    "paper-13.png": ("parts/mapping.png", 900),
    "paper-14.png": ("parts/live.png", 900),
    "paper-15.jpg": ("head_strip.jpg", 900),
    "paper-16.jpg": ("head_curves.png", 900),
}
COLOURS = 128  # of a drawing


def keep(source: Path, target: Path, width: int) -> None:
    with Image.open(source) as opened:
        picture = opened.convert("RGB")
    if picture.width > width:
        height = round(picture.height * width / picture.width)
        picture = picture.resize((width, height), Image.Resampling.LANCZOS)
    if target.suffix == ".png":
        picture.quantize(COLOURS).save(target, optimize=True)
    else:
        picture.save(target, quality=85, optimize=True)


def main() -> int:
    folder = Path(sys.argv[1])
    for name, (source, width) in PICTURES.items():
        if (folder / source).is_file():
            keep(folder / source, IMAGES / name, width)
        else:
            print(f"{folder / source} is missing: docs/images/{name} stays as it is")
    return 0


if __name__ == "__main__":
    sys.exit(main())
