# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheet of the muscles on any head's own mesh.

    python -m evaluation.anatomy.foreign_sheet MESH --landmarks FILE.json --out SHEET.png

Landmarks: {"nose_tip": 123, "chin": [x, y, z], ...}, vertices counted from 0 or places in metres.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, UnreadableMedia
from mimetic.character.foreign_head import attach_foreign
from mimetic.character.landmarks_file import read_landmarks
from mimetic.shared.regular_file import check_target
from mimetic.shared.shown_text import shown
from mimetic.skin.mesh import quad_normals
from mimetic.template.face_template import load_template

from evaluation.anatomy.anatomy_sheet import anatomy_tiles, write_sheet
from evaluation.anatomy.head_painter import COLORS, TALLEST, WIDTH, Painter
from evaluation.anatomy.mesh_file import read_mesh


class PlainMesh:
    """Faces as they are, for Painter: F x 4, a triangle as a quad whose last corners agree."""

    def __init__(self, faces: np.ndarray):
        if faces.shape[1] == 3:
            faces = np.column_stack([faces, faces[:, 2]])
        self.faces = np.where(faces < 0, faces[:, [2]], faces)

    def positions(self, vertices: np.ndarray) -> np.ndarray:
        return vertices

    def normals(self, vertices: np.ndarray) -> np.ndarray:
        return quad_normals(vertices, self.faces)


class PlainPainter(Painter):
    """Draws a mesh that is in the template's axes and size."""

    def __init__(self, num_vertices: int, faces: np.ndarray, size: int, yaw: float):
        self.shape = (round(size * TALLEST), size)
        self.mesh = PlainMesh(faces)
        self.color = np.tile(COLORS["skin"], (len(faces), 1))
        self.drawn = np.ones(len(faces), bool)
        cos, sin = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        self.view_from_head = np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
        self.middle = np.array([0.0, 0.01, 0.05]) @ self.view_from_head.T
        self.scale = size / WIDTH
        self.toward_iris = np.full((num_vertices, 1), -1.0)  # its eyes are not known


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="evaluation.anatomy.foreign_sheet", description=__doc__.splitlines()[0]
    )
    parser.add_argument("mesh", type=Path, help=".obj, .ply, .glb or .gltf")
    parser.add_argument(
        "--landmarks", type=Path, required=True, help=".json, name -> vertex or place"
    )
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png")
    parser.add_argument("--scale", type=float, default=1.0, help="metres in the file's unit")
    parser.add_argument("--only", nargs="+", help="titles to draw; all by default")
    parser.add_argument("--yaw", type=float, default=0.0, help="degrees to the side")
    parser.add_argument("--size", type=int, default=280, help="width of one picture, pixels")
    options = parser.parse_args(arguments)
    try:
        return _draw(options)
    except (InvalidInput, UnreadableMedia) as error:
        print(f"foreign_sheet: {shown(error)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("foreign_sheet: stopped", file=sys.stderr)
        return 130


def _draw(options: argparse.Namespace) -> int:
    if not 1e-6 <= options.scale <= 1e3:
        raise InvalidInput(f"--scale is {options.scale}, allowed are 1e-6 to 1000")
    if not 16 <= options.size <= 4000:
        raise InvalidInput(f"--size is {options.size}, allowed are 16 to 4000")
    check_target(options.out, options.mesh, options.landmarks)
    vertices, faces = read_mesh(options.mesh)
    vertices = options.scale * vertices
    landmarks = {
        name: [options.scale * x for x in value] if isinstance(value, list) else value
        for name, value in read_landmarks(options.landmarks).items()
    }
    head = attach_foreign(vertices, faces, landmarks, load_template())
    for note in head.notes:
        print(f"foreign_sheet: {note}")
    print("laid on within {:.2f} mm (median), {:.2f} mm (95 %)".format(*head.gap_mm))
    tiles = anatomy_tiles(head.anatomy)
    if unknown_titles := sorted(set(options.only or ()) - set(tiles)):
        raise InvalidInput(f"no picture {unknown_titles[0]!r}; there are {', '.join(tiles)}")
    to_template = head.mesh_from_template.inverse()
    tiles_drawn = {name: to_template.turn(tiles[name]) for name in options.only or tiles}
    painter = PlainPainter(len(vertices), faces, options.size, options.yaw)
    rest = to_template.apply(vertices)
    pictures = {
        title: painter.paint(rest, displacement) for title, displacement in tiles_drawn.items()
    }
    write_sheet(pictures, options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
