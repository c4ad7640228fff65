# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic points`: where pixels of one frame go in all others."""

from __future__ import annotations

import argparse
import csv
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.commands.console import Console
from mimetic.performance.document import Performance
from mimetic.performance.places import RefinedSurface, meets_face, places_under
from mimetic.performance.projection import rescaled
from mimetic.shared.array_writer import array_stream, whole_archive
from mimetic.shared.counted import counted
from mimetic.shared.regular_file import check_input, check_target

LARGEST_TABLE = 1_000_000  # points
LARGEST_FILE = 64 * 10**6  # bytes
FARTHEST = 1e6  # pixels from the picture's corner
POINTS_AT_ONCE = 16_384  # whose skin is looked for
KEPT_IN_MEMORY = 64 << 20  # bytes of what has to wait until the tracks are written
FOUND = 0.3  # of the whole command when the skin under the points is found, for the progress


@dataclass(frozen=True)
class Tracks:
    """Where K points are in N frames."""

    tracks: NDArray[np.float64]  # N x K x 2, pixels of the footage's file; NaN off the face
    visible: NDArray[np.bool_]  # N x K: in the picture, turned to the camera, not covered
    on_face: NDArray[np.bool_]  # K: the pixel of the given frame shows the face

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes TRACKS.npz, whole or not at all."""
        frames = zip(self.tracks, self.visible, strict=True)
        write_tracks(path, len(self.tracks), self.on_face, frames)


def track_points(
    performance: Performance, points: NDArray[np.float64], frame: int | None = None
) -> Tracks:
    """Follows pixels (K x 2; (0, 0) is the centre of the top-left one) of `frame`, or of the first.

    They are those that the footage's file stores, as other tools read them, square or not.
    Each pixel's ray meets the surface of that frame (beside an outline, skin that faces the camera:
    `surface_places`); the place on the skin is then projected in every frame. Raises InvalidInput
    on points that are not finite or a frame the file lacks.
    """
    points_on_face = FollowedPoints(performance, points, frame)
    shape = (performance.num_frames, len(points_on_face.on_face))
    tracks, visible = np.empty((*shape, 2)), np.empty(shape, dtype=bool)
    for i, (places, is_visible) in enumerate(points_on_face.frames()):
        tracks[i], visible[i] = places, is_visible
    return Tracks(tracks, visible, points_on_face.on_face)


class FollowedPoints:
    """Points on their way, one frame at a time: all pixels of a long clip fit in no memory.

    Arguments and errors as of `track_points`; progress: called with the fraction done and a text
    while the skin under the points is looked for.
    """

    def __init__(
        self,
        performance: Performance,
        points: NDArray[np.float64],
        frame: int | None = None,
        progress: Callable[[float, str], object] = lambda _fraction, _text: None,
    ) -> None:
        points = np.asarray(points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise InvalidInput("points must be K rows of two finite numbers, x and y in pixels")
        self.performance = performance
        self._size, stored_size = performance.image_size, performance.stored_size
        self._stored = self._size if stored_size is None else stored_size
        points = rescaled(points, self._stored, self._size)
        self._surface = RefinedSurface(performance)
        start = performance.index_of(frame) if frame is not None else 0
        self.on_face = np.zeros(len(points), dtype=bool)  # K
        corners, weights, offset = [], [], []
        for first in range(0, len(points), POINTS_AT_ONCE):
            progress(first / len(points), f"looking for the skin under point {first + 1}")
            part = points[first : first + POINTS_AT_ONCE]
            hit = meets_face(self._surface, part, start)
            under = places_under(self._surface, part[hit], start) if hit.any() else None
            if under is None:
                continue
            self.on_face[first : first + POINTS_AT_ONCE][hit] = True
            corners.append(self._surface.triangles[under.triangle])
            weights.append(under.weights)
            offset.append(under.offset)
        self._places = _core.SkinPlaces(
            np.concatenate([np.zeros((0, 3), dtype=np.int32), *corners]),
            np.concatenate([np.zeros((0, 3)), *weights]),
        )
        self._offset = np.concatenate([np.zeros((0, 2)), *offset])

    def frames(self) -> Iterator[tuple[NDArray[np.float64], NDArray[np.bool_]]]:
        """Of every frame the points' pixels (K x 2) and whether they are visible (K)."""
        surface = self._surface
        for i in range(self.performance.num_frames):
            tracks = np.full((len(self.on_face), 2), np.nan)
            visible = np.zeros(len(self.on_face), dtype=bool)
            if len(self._offset):
                vertices = surface.in_camera(i)
                _, pixels, is_shown = _core.show_places(
                    surface.camera, vertices, surface.faces, self._places
                )
                tracks[self.on_face] = rescaled(pixels + self._offset, self._size, self._stored)
                visible[self.on_face] = is_shown
            yield tracks, visible


def write_tracks(
    path: str | os.PathLike[str],
    num_frames: int,
    on_face: NDArray[np.bool_],
    frames: Iterable[tuple[NDArray[np.float64], NDArray[np.bool_]]],
) -> None:
    """Writes TRACKS.npz frame by frame, whole or not at all; raises OSError.

    frames: pixels (K x 2) and visibility (K) of the K points in each of the N frames.
    """
    shape = (num_frames, len(on_face))
    with (
        whole_archive(path) as archive,
        tempfile.SpooledTemporaryFile(KEPT_IN_MEMORY) as waiting,
    ):
        with array_stream(archive, "tracks", (*shape, 2), np.float64) as member:
            for tracks, visible in frames:
                member.write(np.ascontiguousarray(tracks, dtype=np.float64).tobytes())
                waiting.write(visible.tobytes())
        waiting.seek(0)
        with array_stream(archive, "visible", shape, np.bool_) as member:
            shutil.copyfileobj(waiting, member)
        with array_stream(archive, "on_face", on_face.shape, np.bool_) as member:
            member.write(on_face.tobytes())


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
            points: list[tuple[float, float]] = []
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
        text = ",".join(row)[:60]
        raise InvalidInput(f"{path}, line {line}: {text!r} is not x,y") from None
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
        raise InvalidInput(
            f"{path}, line {line}: x and y must be finite, and within {FARTHEST:g} pixels"
        )
    return x, y


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument(
        "--at",
        type=Path,
        required=True,
        metavar="POINTS.csv",
        help="a table with the first line x,y and a line for each point, in pixels of the clip; "
        "0,0 is the middle of the top-left one",
    )
    parser.add_argument("--frame", type=int, help="frame the pixels are in (default: the first)")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="TRACKS.npz",
        help="tracks (N frames x K points x 2, pixels; NaN off the face), visible (N x K), "
        "on_face (K)",
    )


def run_points(arguments: argparse.Namespace) -> int:
    check_target(arguments.out, arguments.performance, arguments.at)
    performance = Performance.load(arguments.performance)
    points, num_frames = read_points(arguments.at), performance.num_frames
    with Console() as console:

        def look(fraction: float, text: str) -> None:
            console.show(FOUND * fraction, text)

        def shown(frames: Iterable) -> Iterator:
            for i, frame in enumerate(frames):
                console.show(FOUND + (1 - FOUND) * i / num_frames, f"following: frame {i + 1}")
                yield frame

        tracks = FollowedPoints(performance, points, arguments.frame, look)
        write_tracks(arguments.out, num_frames, tracks.on_face, shown(tracks.frames()))
    on_face = tracks.on_face
    print(
        f"{arguments.out}: {int(on_face.sum())} of {len(on_face)} points on the face, "
        f"{counted(num_frames, 'frame')}"
    )
    return 0
