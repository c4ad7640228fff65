# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be drawn of a capture while it runs, against what it ends with."""

import threading

import numpy as np
import pytest
from mimetic.performance.gaze import iris_circles
from mimetic.performance.take_facts import quality_of
from mimetic.report.face_lines import LinesSoFar, PerformanceLines, quality_strip
from mimetic.solve.clip_capture import capture, find_face
from mimetic.solve.frames_so_far import FramesSoFar

FIT_FRAME, FRAMES = 3, (1, 9)


@pytest.fixture(scope="module")
def captured(rendered_clip):
    """Frames so far, the performance, and what another thread saw of the frames meanwhile."""
    so_far, seen = FramesSoFar(), []

    def progress(fraction: float, text: str) -> bool:
        looker = threading.Thread(target=lambda: seen.append(so_far.qualities()[0].tolist()))
        looker.start()
        looker.join()
        return True

    fit = find_face(rendered_clip.footage, FIT_FRAME)
    performance = capture(rendered_clip.footage, FRAMES, fit, progress, so_far=so_far)
    return so_far, performance, seen


def test_frames_are_there_as_soon_as_they_are_followed(captured):
    so_far, _, seen = captured
    order = [3, 2, 1, 4, 5, 6, 7, 8, 9]
    assert so_far.qualities()[0].tolist() == order
    assert so_far.newest == 9 and so_far.at(10) is None
    assert all(part == order[: len(part)] for part in seen)
    assert {len(part) for part in seen} >= set(range(1, 9))


def test_what_is_drawn_meanwhile_lies_where_the_capture_ends(captured):
    so_far, performance, _ = captured
    meanwhile, after = LinesSoFar(so_far), PerformanceLines(performance)
    for frame in range(*FRAMES):
        row = meanwhile.row_of(frame)
        drawn, final = meanwhile.draw(row), after.draw(after.row_of(frame))
        off = np.abs(drawn.marks - final.marks) * performance.image_size
        assert off.max() < 1.0
        assert so_far.quality_of(frame) == pytest.approx(quality_of(performance, frame), abs=0.005)
    assert meanwhile.row_of(20) is None and so_far.quality_of(20) is None


def test_irises_lie_within_two_pixels_of_where_the_capture_ends(captured):
    """How the eyes rest is known of the whole clip alone."""
    so_far, performance, _ = captured
    for i, frame in enumerate(performance.frame):
        entry = so_far.at(int(frame))
        drawn = entry.rims.mean(axis=1) @ entry.head_pose[:3, :3].T + entry.head_pose[:3, 3]
        final = iris_circles(performance, i)[:, 1:].mean(axis=1)
        final = final @ performance.head_pose[i, :3, :3].T + performance.head_pose[i, :3, 3]
        off = performance.project(drawn) - performance.project(final)
        assert np.linalg.norm(off, axis=1).max() < 2.0


def test_the_strip_grows_with_the_frames(captured):
    points, _ = quality_strip(*captured[0].qualities(), 0.0, 2.0, 10.0, 5.0)
    assert sorted(points[::6, 0].tolist()) == [2.0 * (frame - 1) for frame in range(1, 10)]
