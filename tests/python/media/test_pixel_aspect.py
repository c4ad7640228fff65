# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage whose pixels are wider or narrower than high is worked with in square ones."""

import numpy as np
import pytest
from clips import ffmpeg, make_clip
from mimetic import InvalidInput
from mimetic.commands.info import describe
from mimetic.commands.points import track_points
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.performance.projection import rescaled
from mimetic.solve.clip_capture import find_face
from sample_performance import make_performance


def squeezed(clip, path, filters="scale=240:240,setsar=4/3"):
    """The same picture in pixels that are wider than high."""
    ffmpeg("-i", clip, "-vf", filters, "-frames:v", 12, "-crf", 12, path)
    return path


@pytest.mark.parametrize(
    ("stored", "aspect", "square"),
    [
        ("240x240", "4/3", (320, 240)),
        ("720x576", "16/15", (768, 576)),
        ("720x480", "8/9", (720, 540)),
        ("16000x32", "2/1", (16000, 16)),
        ("240x240", "150/151:max=200", (240, 240)),
    ],
)
def test_frames_come_with_square_pixels(tmp_path, stored, aspect, square):
    path = tmp_path / "a.mp4"
    ffmpeg(
        *("-f", "lavfi", "-i", f"testsrc2=size={stored}", "-frames:v", 2),
        *("-vf", f"setsar={aspect}", "-c:v", "libx264", path),
    )
    footage = Footage(path)
    assert footage.size == square
    assert footage.stored_size == tuple(int(side) for side in stored.split("x"))
    assert footage.read(2).shape == (square[1], square[0], 3)


def test_an_aspect_that_cannot_be_is_not_followed(tmp_path):
    make_clip(tmp_path / "a.mp4", "-vf", "setsar=50/1", "-c:v", "libx264", size="240x240")
    footage = Footage(tmp_path / "a.mp4")
    assert footage.size == (240, 240) and footage.pixel_aspect == 1
    assert "50:1, which no camera makes" in footage.warnings[0]


def test_a_turned_file_has_its_pixels_turned_too(tmp_path):
    make_clip(tmp_path / "a.mp4", "-vf", "setsar=4/3", size="96x48")
    ffmpeg("-display_rotation", "90", "-i", tmp_path / "a.mp4", "-c", "copy", tmp_path / "b.mp4")
    turned = Footage(tmp_path / "b.mp4")
    assert turned.stored_size == (48, 96) and turned.size == (48, 128)
    assert turned.pixel_aspect == pytest.approx(3 / 4)


def test_the_head_is_fitted_as_in_square_pixels(rendered_clip, fit_of_frame_3, tmp_path):
    path = squeezed(rendered_clip.footage, tmp_path / "a.mp4")
    expected = fit_of_frame_3
    at = rescaled(expected.head_place(), (320, 240), (240, 240))[0]
    fit = find_face(path, frames=(3, 3), near=tuple(at))
    assert tuple(fit.image_size) == (320, 240)
    turned = expected.head_pose[:3, :3].T @ fit.head_pose[:3, :3]
    assert np.degrees(np.arccos((np.trace(turned) - 1) / 2)) < 1
    np.testing.assert_allclose(fit.head_place(), expected.head_place(), atol=1)


def test_points_are_pixels_of_the_file(tmp_path):
    square = make_performance()
    stored = make_performance(stored_size=np.array([240, 240]))
    points = np.array([[150.0, 100.0], [170.25, 130.5]])
    expected = track_points(square, points, 3)
    result = track_points(stored, rescaled(points, (320, 240), (240, 240)), 3)
    tracks = rescaled(expected.tracks, (320, 240), (240, 240)).reshape(result.tracks.shape)
    np.testing.assert_allclose(result.tracks, tracks, atol=1e-9)
    np.testing.assert_array_equal(result.visible, expected.visible)
    # The left edge of the picture is an edge at any size
    np.testing.assert_allclose(rescaled((-0.5, 119.5), (320, 240), (240, 480)), [[-0.5, 239.5]])


def test_a_performance_knows_the_files_pixels(tmp_path):
    make_performance(stored_size=np.array([240, 240])).save(tmp_path / "p.npz")
    loaded = Performance.load(tmp_path / "p.npz")
    assert loaded.pixel_aspect == pytest.approx(4 / 3)
    assert "320 x 240 (240 x 240 in the file)" in describe(loaded)
    assert make_performance().pixel_aspect == 1
    with pytest.raises(InvalidInput, match="stored_size"):
        make_performance(stored_size=np.array([0, 240]))
