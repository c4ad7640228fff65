# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheet of an anatomy: each pair of muscles, jaw and lids at full value.

    python -m mimetic.anatomy_sheet --out SHEET.png [--only NAME ...] [--yaw DEGREES]

Drawn by point splatting into a depth buffer, with numpy alone: no window, no graphics driver.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from mimetic import _core
from mimetic.anatomy import SIDES, Anatomy, attach, muscle_table

WIDTH = 0.19  # m of the head in a picture
TALLEST = 1.18  # height over width
COLORS = {
    "skin": (0.80, 0.70, 0.63),
    "mouth_cavity": (0.55, 0.27, 0.25),
    "eye_socket": (0.74, 0.55, 0.50),
    "teeth": (0.93, 0.91, 0.86),
    "tongue": (0.75, 0.38, 0.36),
    "eye": (0.93, 0.93, 0.96),
}
TINT = np.array([0.80, 0.12, 0.08])
FULL_TINT = 0.012  # m of displacement drawn in the full tint


def color_of(part: str) -> tuple[float, float, float]:
    """Lashes have none: they are cards that need a picture of hairs, and would hide the lids."""
    return next((color for name, color in COLORS.items() if part.startswith(name)), (np.nan,) * 3)


class Painter:
    """Draws the head's limit surface from one side; the mesh is prepared once."""

    def __init__(self, template, size: int, yaw: float, focus: str | None = None):
        self.template = template
        self.shape = (round(size * TALLEST), size)
        self.mesh = _core.SubdividedMesh(
            np.ascontiguousarray(template.faces, np.int32), len(template.vertices), 2
        )
        palette = np.array([color_of(str(name)) for name in template.part_names])
        self.color = palette[template.part[self.mesh.parent_face]]
        self.drawn = np.isfinite(self.color[:, 0])
        cos, sin = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        self.view_from_head = np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
        middle = np.array([0.0, 0.01, 0.05])
        self.scale = size / WIDTH
        if focus:
            at = list(template.landmark_names).index(focus)
            middle = np.asarray(template.vertices)[template.landmark_vertices[at]]
            self.scale *= 2.5
        self.middle = middle @ self.view_from_head.T

    def paint(self, vertices: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """Picture H x W x 3 float of the displaced head (V x 3, m), tinted by its displacement."""
        shape = np.ascontiguousarray(vertices + displacement)
        points = self.mesh.positions(shape) @ self.view_from_head.T - self.middle
        normals = self.mesh.normals(shape) @ self.view_from_head.T
        motion = np.linalg.norm(
            self.mesh.positions(np.ascontiguousarray(displacement)), axis=1, keepdims=True
        )
        values = np.hstack([points, normals, motion])
        height, width = self.shape
        nearest = np.full(height * width, -np.inf)
        image = np.ones((height * width, 3))
        for place, color in self._fragments(values):
            column = np.floor(place[:, 0] * self.scale + width / 2).astype(int)
            row = np.floor(height / 2 - place[:, 1] * self.scale).astype(int)
            inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
            inside &= place[:, 5] > -0.2  # backs of faces
            pixel = (row * width + column)[inside]
            order = np.argsort(place[inside, 2], kind="stable")
            last = np.full(height * width, -1)
            last[pixel[order]] = order
            hit = np.nonzero(last >= 0)[0]
            depth = place[inside, 2][last[hit]]
            front = depth > nearest[hit]
            nearest[hit[front]] = depth[front]
            image[hit[front]] = self._shade(
                place[inside][last[hit[front]]], color[inside][last[hit[front]]]
            )
        return image.reshape(height, width, 3)

    def _fragments(self, values: np.ndarray):
        """Points on all faces, dense enough to fill pixels, in groups of faces of like size."""
        corners = values[self.mesh.faces]  # F x 4 x 7
        flat = corners[:, :, :2] * self.scale
        sides = np.linalg.norm(flat - np.roll(flat, 1, axis=1), axis=2).max(axis=1)
        count = np.clip(np.exp2(np.ceil(np.log2(1.6 * sides + 1))), 2, 64).astype(int)
        toward = corners[:, :, 5].max(axis=1) > -0.2
        for n in np.unique(count):
            chosen = (count == n) & toward & self.drawn
            t = (np.arange(n) + 0.5) / n
            s, t = (a.ravel() for a in np.meshgrid(t, t))
            weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
            fragments = np.einsum("kp,fkc->fpc", weights, corners[chosen])
            color = np.repeat(self.color[chosen], n * n, axis=0)
            yield fragments.reshape(-1, 7), color

    def _shade(self, values: np.ndarray, color: np.ndarray) -> np.ndarray:
        normal = values[:, 3:6] / np.maximum(np.linalg.norm(values[:, 3:6], axis=1), 1e-9)[:, None]
        key = np.clip(normal @ (np.array([-0.45, 0.55, 0.70])), 0, 1)
        fill = np.clip(normal @ (np.array([0.75, 0.10, 0.45])), 0, 1)
        light = (0.16 + 0.75 * key + 0.22 * fill)[:, None]
        share = 0.65 * np.clip(values[:, 6:7] / FULL_TINT, 0, 1)
        return np.clip(((1 - share) * color + share * TINT) * light, 0, 1) ** (1 / 1.6)


def sheet_tiles(anatomy: Anatomy) -> dict[str, np.ndarray]:
    """Titles and displacements V x 3 of the sheet."""
    muscles = dict(zip(anatomy.muscle_names, anatomy.muscle_modes, strict=True))
    bones = dict(zip(anatomy.articulator_names, anatomy.articulator_modes, strict=True))
    tiles = {"neutral": np.zeros_like(anatomy.muscle_modes[0])}
    for row in muscle_table():
        tiles[row["name"]] = sum(muscles[f"{row['name']}.{side}"] for side in SIDES)
    tiles |= {name: bones[name] for name in ("jaw_open", "jaw_side", "jaw_thrust")}
    tiles["lid_upper half"] = 0.5 * (bones["lid_upper.L"] + bones["lid_upper.R"])
    tiles["lid_upper"] = bones["lid_upper.L"] + bones["lid_upper.R"]
    tiles["lid_upper wide"] = -0.4 * tiles["lid_upper"]
    tiles["lid_lower"] = bones["lid_lower.L"] + bones["lid_lower.R"]
    tiles["frontalis, whole"] = sum(
        tiles[f"frontalis_{part}"] for part in ("medial", "middle", "lateral")
    )
    tiles["smile with cheeks"] = (
        tiles["zygomaticus_major"] + 0.7 * tiles["orbicularis_oculi_inferior"]
    )
    return tiles


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="mimetic.anatomy_sheet", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png")
    parser.add_argument("--only", nargs="+", help="titles to draw; all by default")
    parser.add_argument("--yaw", type=float, default=0.0, help="degrees to the side")
    parser.add_argument("--focus", help="landmark to look at from near, such as lip_upper_inner")
    parser.add_argument("--size", type=int, default=280, help="width of one picture, pixels")
    options = parser.parse_args(arguments)
    from mimetic.face_template import load_template

    template = load_template()
    tiles = sheet_tiles(attach(template.vertices, template))
    unknown = sorted(set(options.only or ()) - set(tiles))
    if unknown:
        print(f"no picture {unknown[0]!r}; there are {', '.join(tiles)}", file=sys.stderr)
        return 2
    chosen = {name: tiles[name] for name in options.only or tiles}
    painter = Painter(template, options.size, options.yaw, options.focus)
    write_sheet(painter, np.asarray(template.vertices), chosen, options.out)
    return 0


def write_sheet(painter, vertices: np.ndarray, chosen: dict[str, np.ndarray], out: Path) -> None:
    """Pictures of the head (V x 3) displaced, under their titles, as a .png."""
    from matplotlib.figure import Figure

    columns = min(7, len(chosen))
    rows = -(-len(chosen) // columns)
    height, width = painter.shape
    figure = Figure(figsize=(columns * width / 100, rows * (height + 18) / 100), dpi=100)
    for index, (title, displacement) in enumerate(chosen.items()):
        left, top = index % columns, index // columns
        axes = figure.add_axes(
            [left / columns, 1 - (top + 1) / rows, 1 / columns, height / (rows * (height + 18))]
        )
        axes.imshow(painter.paint(vertices, displacement), interpolation="none")
        axes.set_title(title, fontsize=7, pad=2)
        axes.axis("off")
    partial = out.with_suffix(".partial.png")
    figure.savefig(partial)
    partial.replace(out)


if __name__ == "__main__":
    sys.exit(main())
