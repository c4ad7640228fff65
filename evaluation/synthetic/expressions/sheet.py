# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 5 with drawn people: thirty of them, each in one of nine expressions.

    python -m evaluation.synthetic.expressions.sheet --out SHEET.jpg [--people N] [--columns N]

One frame of each is rendered, at the expression's height: the people and expressions of
`mimetic evaluate --set full`, before its camera spoils them.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.anatomy.anatomy_sheet import write_sheet

from .. import footage, scene
from ..clips import CannotRender
from ..person import neutral_vertices
from .films import TEXEL_STEP, _draw
from .recipes import FPS, SETS, Take, some_of
from .simulation import simulated_motion

TO_APEX = 0.35  # seconds from an expression's first frame
TILE_WIDTH = 200


def portrait(take: Take, slot: int, template: FaceTemplate) -> NDArray[np.uint8]:
    """The person at the height of the expression in this slot, H x W x 3."""
    recipe = take.recipe
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    moved_by = simulated_motion if recipe.kind == "muscles" else scene.face_motion
    drawn = scene.build(recipe, template, neutral, moved_by(recipe, template, neutral))
    frame = take.spans()[slot][0] - 1 + round(TO_APEX * FPS)
    one = slice(frame, frame + 1)
    drawn = replace(
        drawn, vertices=drawn.vertices[one], head_pose=drawn.head_pose[one], light=drawn.light[one]
    )
    with tempfile.TemporaryDirectory() as aside:
        paint = scene.paint(recipe, template, neutral, TEXEL_STEP)
        _draw(drawn, paint, Path(aside), recipe.name)
        return footage.filmed(np.load(Path(aside) / "frames.npy"), recipe)[0]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="expressions.sheet", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    parser.add_argument("--people", type=int, help="so many of the thirty, evenly chosen")
    parser.add_argument("--columns", type=int, default=6)
    options = parser.parse_args(arguments)
    template, pictures = load_template(), {}
    try:
        for number, take in enumerate(some_of(SETS["full"], options.people)):
            # Thirds of the people show the first, the second, the third of their expressions
            slot = number % 3
            picture = portrait(take, slot, template)
            left = (picture.shape[1] - TILE_WIDTH) // 2
            title = f"{number + 1}: {take.expressions[slot]}"
            pictures[title] = picture[:, left : left + TILE_WIDTH]
            print(title, flush=True)
    except CannotRender as error:
        print(f"sheet: {error}", file=sys.stderr)
        return 2
    write_sheet(pictures, options.out, options.columns)
    return 0


if __name__ == "__main__":
    sys.exit(main())
