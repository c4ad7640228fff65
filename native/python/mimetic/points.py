# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic points`: where pixels of one frame go in all others."""

from __future__ import annotations

import argparse
import csv
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.performance import Performance
from mimetic.projection import rescaled
from mimetic.regular_file import check_input, check_target
from mimetic.surface_places import COVERED, RefinedSurface, cosines, places_under
from mimetic.whole_file import whole_file

LARGEST_TABLE = 1_000_000  # points
LARGEST_FILE = 64 * 10**6  # bytes
FARTHEST = 1e6  # pixels from the picture's corner
GRAZING = 0.1  # cosine between normal and view below which a point is turned away


@dataclass(frozen=True)
class Tracks:
    tracks: NDArray[
        np.float64
    ]  # N x K x 2, pixels of the footage's file; NaN for points that are not on the face
    visible: NDArray[
        np.bool_
    ]  # N x K: in the picture, turned to the camera, not covered by the face
    on_face: NDArray[np.bool_]  # K: the pixel of the given frame shows the face

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes TRACKS.npz, whole or not at all."""
        path = Path(path)
        with whole_file(path) as stream:
            np.savez_compressed(
                stream, tracks=self.tracks, visible=self.visible, on_face=self.on_face
            )


def track_points(
    performance: Performance, points: NDArray[np.float64], frame: int | None = None
) -> Tracks:
    """Follows pixels (K x 2; (0, 0) is the centre of the top-left one) of `frame`, or of the first.

    They are those that the footage's file stores, as other tools read them, square or not.
    Each pixel's ray meets the surface of that frame (beside an outline, skin that faces the camera:
    `surface_places`); the place on the skin is then projected in every frame. Raises InvalidInput
    on points that are not finite or a frame the file lacks.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise InvalidInput("points must be K rows of two finite numbers, x and y in pixels")
    size, stored = performance.image_size, performance.stored_size
    stored = size if stored is None else stored
    points = rescaled(points, stored, size)
    surface = RefinedSurface(performance)
    start = performance.index_of(frame) if frame is not None else 0
    under = places_under(surface, points, start)
    shape = (performance.num_frames, len(points))
    tracks, visible = np.full((*shape, 2), np.nan), np.zeros(shape, dtype=bool)
    if under is None:
        return Tracks(tracks, visible, np.zeros(len(points), dtype=bool))
    on_face = under.on_face
    corners = surface.triangles[under.triangle[on_face]]
    weights, offset = under.weights[on_face], under.offset[on_face]
    for i in range(performance.num_frames):
        vertices = surface.in_camera(i)
        seen = vertices[corners]
        places = np.einsum("kc,kcx->kx", weights, seen)
        turned = cosines(seen, places) > GRAZING
        in_front = places[:, 2] > 1e-3
        shown_at = performance.project(np.where(in_front[:, None], places, np.nan))
        tracks[i, on_face] = rescaled(shown_at + offset, size, stored)
        shown = _core.show_points(surface.camera, vertices, surface.faces, places, COVERED)
        visible[i, on_face] = turned & shown
    return Tracks(tracks, visible, on_face)


def read_points(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """K x 2 pixels from a table with the header `x,y`; raises UnreadableMedia, InvalidInput."""
    path = Path(path)
    check_input(path, "a table of points (x,y)")
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InvalidInput(f"{path}: larger than {LARGEST_FILE // 10**6} MB; split the table")
        with open(path, newline="", encoding="utf-8-sig") as stream:
            rows = csv.reader(stream)
            header = [name.strip() for name in next(rows, [])]
            if header != ["x", "y"]:
                raise InvalidInput(f"{path}: the first line must be x,y")
            points = []
            for row in rows:
                if not row:
                    continue
                if len(points) == LARGEST_TABLE:
                    raise InvalidInput(f"{path}: more than {LARGEST_TABLE} points; split the table")
                points.append(_read_row(path, rows.line_num, row))
    except OSError as error:
        raise UnreadableMedia(f"{path}: {error.strerror}; give a table of points") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InvalidInput(f"{path} is not a table of points: {error}") from None
    if not points:
        raise InvalidInput(f"{path}: no points after the first line")
    return np.array(points)


def _read_row(path: Path, line: int, row: list[str]) -> tuple[float, float]:
    try:
        x, y = (float(cell) for cell in row)
    except ValueError:
        told = ",".join(row)[:60]
        raise InvalidInput(f"{path}, line {line}: {told!r} is not x,y") from None
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
        raise InvalidInput(
            f"{path}, line {line}: x and y must be finite, and within {FARTHEST:g} pixels"
        )
    return x, y


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument(
        "--at", type=Path, required=True, metavar="POINTS.csv", help="x,y in pixels of the clip"
    )
    parser.add_argument("--frame", type=int, help="frame the pixels are in (default: the first)")
    parser.add_argument("--out", type=Path, required=True, metavar="TRACKS.npz")


def run_points(arguments: argparse.Namespace) -> int:
    check_target(arguments.out, arguments.performance, arguments.at)
    performance = Performance.load(arguments.performance)
    tracks = track_points(performance, read_points(arguments.at), arguments.frame)
    tracks.save(arguments.out)
    print(
        f"{arguments.out}: {int(tracks.on_face.sum())} of {len(tracks.on_face)} points on the "
        f"face, {performance.num_frames} frames"
    )
    return 0
