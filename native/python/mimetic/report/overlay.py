# SPDX-License-Identifier: GPL-3.0-or-later
"""The captured face drawn over its footage."""

from __future__ import annotations

import contextlib
import errno
import itertools
import os
import signal
import subprocess
import threading
from collections.abc import Generator, Iterator
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import has_gaze, iris_circles
from mimetic.shared.parallel import in_turn
from mimetic.shared.pinhole import camera_of
from mimetic.shared.progress import Progress, frame_text
from mimetic.shared.whole_file import file_beside
from mimetic.template.face_template import FaceTemplate, load_template

CLEAR_WIDTH = 800  # pixels: smaller footage is enlarged until its lines stay apart
# Players guess at colours that a file does not state, each in its own way
AS_SDR = (
    "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p,"
    "setparams=color_primaries=bt709:color_trc=bt709:colorspace=bt709:range=tv"
)
HIDDEN_REGIONS = ("scalp", "ear", "neck", "mouth_cavity", "eye_socket")
Pictures = Generator[NDArray[np.uint8] | None, None, None]


class NoFrames(OSError):
    """None of a performance's frames is in the footage any more."""

    def __init__(self, footage: Footage, performance: Performance) -> None:
        first, last = int(performance.frame[0]), int(performance.frame[-1])
        text = f"none of the frames {first} to {last} can be read again, to draw over them"
        super().__init__(errno.EIO, text, str(footage.path))


def make_painter(
    performance: Performance, num_vertices: int, faces: NDArray[np.int32], landmarks: list[int]
) -> _core.OverlayPainter:
    """For meshes of so many vertices and these quads (F x 4), over the performance's footage."""
    options = _core.OverlayOptions()
    options.scale = int(np.clip(np.ceil(CLEAR_WIDTH / performance.image_size[0]), 1, 4))
    options.held_quality = HELD_QUALITY
    camera = camera_of(performance.intrinsics, performance.image_size)
    faces = np.ascontiguousarray(faces)
    return _core.OverlayPainter(camera, num_vertices, faces, landmarks, options)


class Drawing(Protocol):
    """What can paint the frames of a performance."""

    performance: Performance

    def paint(self, image: NDArray[np.uint8], i: int) -> NDArray[np.uint8]:
        """An enlarged (H, W, 3) picture of frame index `i`."""
        ...


class FaceDrawing:
    """Paints frames of a performance; `paint(image, i)` gives an enlarged H x W x 3 picture."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        template = _template_of(performance)
        if template is None:
            vertices, faces = np.unique(performance.faces, return_inverse=True)
            faces, landmarks = faces.reshape(-1, 4), []
            visible_faces = np.ones(len(faces), dtype=bool)
            self.vertices = vertices
        else:
            self.vertices = np.arange(template.num_skin_vertices)
            faces = np.asarray(template.skin_faces)
            visible_faces = shown_faces(template)
            landmarks = [template.landmark(name) for name in shown_landmarks(template)]
        faces = np.ascontiguousarray(faces, dtype=np.int32)
        # The limit surface, where the face is, lies inside of the control mesh.
        self.mesh = _core.SubdividedMesh(faces, len(self.vertices), 0)
        self.painter = make_painter(
            performance, len(self.vertices), faces[visible_faces], landmarks
        )

    def paint(self, image: NDArray[np.uint8], i: int) -> NDArray[np.uint8]:
        control = self.performance.surface_in_camera(i)[self.vertices]
        points = self.mesh.positions(np.ascontiguousarray(control))[: len(self.vertices)]
        quality = float(self.performance.quality[i])
        frame = int(self.performance.frame[i])
        return self.painter.paint(
            image, np.ascontiguousarray(points), quality, frame, self._rims(i)
        )

    def _rims(self, i: int) -> list[NDArray[np.float64]]:
        """The irises' rims in the camera frame, where the performance has gaze."""
        if not has_gaze(self.performance):
            return []
        pose = self.performance.head_pose[i]
        return [
            np.ascontiguousarray(circle[1:] @ pose[:3, :3].T + pose[:3, 3])
            for circle in iris_circles(self.performance, i)
        ]


@lru_cache(maxsize=2)
def shown_faces(template: FaceTemplate) -> NDArray[np.bool_]:
    """Which of the skin's faces are drawn."""
    is_hidden = template.in_region(*HIDDEN_REGIONS)
    return ~is_hidden[template.skin_faces].any(axis=1)


@lru_cache(maxsize=2)
def shown_landmarks(template: FaceTemplate) -> list[str]:
    """Landmarks on what is drawn."""
    is_hidden = template.in_region(*HIDDEN_REGIONS)
    return [name for name in template.landmark_names if not is_hidden[template.landmark(name)]]


def write_overlay(
    performance: Performance,
    footage: Footage,
    path: str | os.PathLike[str],
    progress: Progress | None = None,
    drawing: Drawing | None = None,
) -> bool:
    """Encodes overlay.mp4 (H.264) in a second pass over the footage, whole or not at all.

    drawing: has `performance` and `paint`, by default the captured face's. Returns False, and
    leaves no file, if `progress` stopped it. Raises OSError; NoFrames where the footage gives none.
    """
    path = Path(path)
    drawing = drawing or FaceDrawing(performance)
    with (
        file_beside(path, path.suffix) as aside,
        contextlib.closing(_pictures(drawing, footage, progress)) as pictures,
    ):
        try:
            first = next(pictures)
        except StopIteration:
            raise footage.failure or NoFrames(footage, performance) from None
        every = itertools.chain([first], pictures)
        is_finished = _encode(every, aside, Fraction(footage.fps), str(path))
        if is_finished and footage.failure:  # it ended before the last frame
            raise footage.failure
        if not is_finished:
            aside.unlink()
    return is_finished


def _pictures(drawing: Drawing, footage: Footage, progress: Progress | None) -> Pictures:
    """Pictures in order; None instead of the next one when the user stops."""
    numbers = drawing.performance.frame
    index = {int(frame): i for i, frame in enumerate(numbers)}
    images = (
        (index[frame], image)
        for frame, image in footage.frames(int(numbers[0]), int(numbers[-1]))
        if frame in index
    )
    painted = in_turn(lambda numbered: drawing.paint(numbered[1], numbered[0]), images)
    with contextlib.closing(painted):
        for (i, _), picture in painted:
            text = f"drawing {frame_text(int(numbers[i]), int(numbers[0]), int(numbers[-1]))}"
            if progress and not progress(i / len(numbers), text):
                yield None
                return
            yield picture


def _encode(
    pictures: Iterator[NDArray[np.uint8] | None], path: Path, fps: Fraction, name: str
) -> bool:
    """Whether all pictures are in the file; raises OSError that calls it `name`."""
    first = next(pictures, None)
    if first is None:
        return False
    height, width = first.shape[:2]
    command = [
        *(ffmpeg_program(), "-hide_banner", "-v", "error", "-y"),
        *("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"),
        *("-r", f"{fps.numerator}/{fps.denominator}", "-i", "pipe:0"),
        # H.264 as common players read it needs even sides.
        *("-vf", f"pad=ceil(iw/2)*2:ceil(ih/2)*2,{AS_SDR}", "-c:v", "libx264", "-preset"),
        *("veryfast", "-crf", "20", "-movflags", "+faststart"),
        f"file:{path.absolute()}",
    ]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )
    assert process.stdin is not None and process.stderr is not None  # pipes, as requested
    report, errors = process.stderr, list[bytes]()
    reader = threading.Thread(target=lambda: errors.append(report.read()), daemon=True)
    reader.start()
    try:
        for picture in itertools.chain([first], pictures):
            if picture is None:
                return False
            process.stdin.write(picture.data)
        process.stdin.close()
        process.wait()
    except BrokenPipeError:
        process.wait()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        reader.join()
        report.close()
    if process.returncode != 0:
        raise _failure(b"".join(errors).decode(errors="replace"), process.returncode, name)
    return True


def _failure(report: str, status: int, name: str) -> OSError:
    """What ffmpeg's words on a file that it could not write mean."""
    for number in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.ENOMEM, errno.EIO):
        if os.strerror(number) in report:
            return OSError(number, os.strerror(number), name)
    reason = f"ended by {signal.Signals(-status).name}" if status < 0 else f"status {status}"
    lines = report.strip().splitlines() or [reason]
    return OSError(errno.EIO, f"ffmpeg could not write it: {lines[0][:200]}", name)


def _template_of(performance: Performance) -> FaceTemplate | None:
    """The canonical head, if the performance has its mesh: it names parts and landmarks."""
    template = load_template()
    if np.array_equal(performance.faces, template.faces):
        return template
    return None
