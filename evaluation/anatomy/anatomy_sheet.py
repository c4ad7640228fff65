# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheet of an anatomy: pairs of muscles, jaw, lids, extras and whole expressions.

    python -m evaluation.anatomy.anatomy_sheet --out SHEET.png [--only NAME ...] [--yaw DEGREES ...]

Every picture is drawn from each of the given sides. Muscles, jaw and extras are at value 1, tinted
by how far the skin moves; expressions, at 50 and 100 %, are plain skin. Lips and lids rest on each
other (`mimetic.muscles.contact`).
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.muscles.anatomy import SIDES, Anatomy, attach_skin, modes_of, muscle_table
from mimetic.muscles.articulators import JAW
from mimetic.muscles.contact import attach_contact
from mimetic.muscles.extras import Extras, attach_extras
from mimetic.shared.whole_file import whole_file
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.anatomy.head_painter import Painter
from evaluation.anatomy.unit_muscles import EXPRESSIONS

COLUMNS = 7
TITLE = 18  # pixels


@dataclass(frozen=True)
class Tile:
    """A picture: displacement V x 3, m; tinted by it or plain."""

    displacement: NDArray[np.float64]
    tint: bool = True


def anatomy_tiles(anatomy: Anatomy) -> dict[str, NDArray[np.float64]]:
    """Titles and displacements (V x 3) of pairs of muscles, jaw and lids at full value."""
    modes = dict(zip(anatomy.muscle_names, anatomy.muscle_modes, strict=True))
    bones = dict(zip(anatomy.articulator_names, anatomy.articulator_modes, strict=True))
    tiles = {"neutral": np.zeros_like(anatomy.muscle_modes[0])}
    tiles |= {row["name"]: both(modes, row["name"]) for row in muscle_table()}
    tiles |= {name: bones[name] for name in JAW}
    tiles["lid_upper half"] = 0.5 * both(bones, "lid_upper")
    tiles["lid_upper"] = both(bones, "lid_upper")
    tiles["lid_upper wide"] = -0.4 * tiles["lid_upper"]
    tiles["lid_lower"] = both(bones, "lid_lower")
    return tiles


def both(modes: dict, name: str) -> NDArray[np.float64]:
    """The two sides of a pair."""
    return sum(modes[f"{name}.{side}"] for side in SIDES)


def sheet_tiles(anatomy: Anatomy, extras: Extras) -> dict[str, Tile]:
    """The sheet's pictures by title, before contact."""
    tiles = {
        title: Tile(displacement, tint=title != "neutral")
        for title, displacement in anatomy_tiles(anatomy).items()
    }
    modes = dict(zip(anatomy.muscle_names, anatomy.muscle_modes, strict=True))
    modes |= dict(zip(anatomy.articulator_names, anatomy.articulator_modes, strict=True))
    modes |= dict(zip(extras.names, extras.modes, strict=True))
    for part in ("oris_protrude", "oris_close", "lip_roll"):
        tiles[part] = Tile(modes[f"{part}_upper"] + modes[f"{part}_lower"])
    tiles["lip_roll in"] = Tile(-tiles["lip_roll"].displacement)
    tiles["air_cheek"], tiles["air_lips"] = Tile(both(modes, "air_cheek")), Tile(modes["air_lips"])
    tiles["look up"] = Tile(both(modes, "look_up"), tint=False)
    tiles["look down"] = Tile(both(modes, "look_down"), tint=False)
    tiles["look left"] = Tile(modes["look_out.L"] + modes["look_in.R"], tint=False)
    for title in EXPRESSIONS:
        for share in (0.5, 1.0):
            tiles[f"{title} {share:.0%}"] = Tile(expression(modes, title, share), tint=False)
    return tiles


def expression(modes: dict, title: str, share: float = 1.0) -> NDArray[np.float64]:
    """Displacement V x 3 of a whole expression; modes: by name."""
    return share * sum(
        value * modes[name]
        for part, value in EXPRESSIONS[title].items()
        for name in (part, *(f"{part}.{side}" for side in SIDES))
        if name in modes
    )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.anatomy.anatomy_sheet", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    parser.add_argument("--only", nargs="+", help="titles to draw; all by default")
    parser.add_argument("--yaw", type=float, nargs="+", default=[0.0, 40.0], help="degrees aside")
    parser.add_argument("--focus", help="landmark to look at from near, such as lip_upper_inner")
    parser.add_argument("--size", type=int, default=200, help="width of one picture, pixels")
    parser.add_argument("--columns", type=int, default=COLUMNS, help="titles in a row")
    options = parser.parse_args(arguments)
    template = load_template()
    skin = attach_skin(template.vertices, template)
    tiles = sheet_tiles(modes_of(skin), attach_extras(skin))
    unknown_titles = sorted(set(options.only or ()) - set(tiles))
    if unknown_titles:
        print(f"no picture {unknown_titles[0]!r}; there are {', '.join(tiles)}", file=sys.stderr)
        return 2
    tiles_drawn = {name: tiles[name] for name in options.only or tiles}
    painters = [Painter(template, options.size, yaw, options.focus) for yaw in options.yaw]
    contact, rest, pictures = attach_contact(skin), np.asarray(template.vertices), {}
    for title, tile in tiles_drawn.items():
        displacement = contact.relieve(tile.displacement)
        pictures[title] = np.hstack([p.paint(rest, displacement, tile.tint) for p in painters])
    write_sheet(pictures, options.out, options.columns)
    return 0


def write_sheet(pictures: dict[str, NDArray[np.float64]], out: Path, columns: int = COLUMNS):
    """Pictures of one size, in rows under their titles."""
    from matplotlib.figure import Figure

    columns = max(1, min(columns, len(pictures)))
    height, width = next(iter(pictures.values())).shape[:2]
    rows = -(-len(pictures) // columns)
    figure = Figure(figsize=(columns * width / 100, rows * (height + TITLE) / 100), dpi=100)
    for index, (title, picture) in enumerate(pictures.items()):
        left, top = index % columns, index // columns
        place = [
            left / columns,
            1 - (top + 1) / rows,
            1 / columns,
            height / (height + TITLE) / rows,
        ]
        axes = figure.add_axes(place)
        axes.imshow(picture, interpolation="none")
        axes.set_title(title, fontsize=7, pad=2)
        axes.axis("off")
    with whole_file(out) as stream:
        figure.savefig(stream, format=out.suffix[1:] or None)


if __name__ == "__main__":
    sys.exit(main())
