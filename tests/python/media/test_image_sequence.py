# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbered pictures are footage: the right picture under each number, at the rate that is said."""

import os
from fractions import Fraction

import numpy as np
import pytest
from clips import ffmpeg, make_numbered_clip
from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.clip_fingerprint import files_in, find_content, fingerprint
from mimetic.media.footage import Footage
from mimetic.media.image_sequence import ImageSequence


def make_pictures(folder, pattern="frame_%04d.png", start=1, frames=20):
    """Grey pictures: frame n has the value 5 n."""
    folder.mkdir(parents=True, exist_ok=True)
    clip = make_numbered_clip(folder.with_suffix(".mp4"), frames=frames)
    exact = ("-q:v", "1") if pattern.endswith("jpg") else ()
    ffmpeg("-i", clip, "-start_number", start, *exact, folder / pattern)
    return folder


def levels(footage, *frames):
    return [image.mean() for _, image in footage.frames(*frames)]


@pytest.mark.parametrize(
    ("pattern", "start"),
    [
        ("frame_%04d.png", 1),
        ("shot 7%%.%03d.png", 998),  # from three digits to four, and a per cent sign
        ("%d.jpg", 8),  # without zeros in front
        ("a_%05d.tif", 86400),
        ("a_%04d.dpx", 0),
    ],
)
def test_each_picture_is_the_frame_of_its_number(tmp_path, pattern, start):
    folder = make_pictures(tmp_path / "pictures", pattern, start)
    footage = Footage(folder)
    assert footage.size == (64, 64) and footage.num_frames == 20
    expected = 5 * np.arange(1, 21)
    np.testing.assert_allclose(levels(footage), expected, atol=2)
    np.testing.assert_allclose(levels(footage, 7, 9), expected[6:9], atol=2)
    assert footage.read(20).mean() == pytest.approx(100, abs=2)


def test_a_folder_a_pattern_and_the_first_picture_name_the_same(tmp_path):
    folder = make_pictures(tmp_path / "pictures", start=101)
    ways = [folder, folder / "frame_%04d.png", folder / "frame_####.png"]
    ways.append(folder / "frame_0101.png")
    read = [Footage(way) for way in ways]
    assert len({tuple(footage.identity) for footage in read}) == 1
    assert {footage.path.name for footage in read} == {"frame_####.png"}
    assert os.fspath(read[0].path) == str(folder / "frame_0101.png")
    later = Footage(folder / "frame_0105.png")
    assert later.num_frames == 16 and later.read(1).mean() == pytest.approx(25, abs=2)


def test_the_rate_is_the_one_that_is_given(tmp_path):
    folder = make_pictures(tmp_path / "pictures")
    footage = Footage(ImageSequence(folder, Fraction(24000, 1001)))
    assert footage.fps == Fraction(24000, 1001) and not footage.variable_rate
    np.testing.assert_allclose(footage.times, np.arange(20) * 1001 / 24000, atol=1e-9)
    assert not footage.warnings
    (warning,) = Footage(folder).warnings
    assert "24 frames/s are taken (--fps)" in warning
    with pytest.raises(InvalidInput, match="rate of 0 frames"):
        ImageSequence(folder, 0)


def test_a_gap_ends_the_sequence_and_is_told(tmp_path):
    folder = make_pictures(tmp_path / "pictures")
    (folder / "frame_0013.png").unlink()
    footage = Footage(folder)
    assert footage.num_frames == 12 and len(levels(footage)) == 12
    assert any("frame_0013.png is missing" in w and "7 later" in w for w in footage.warnings)
    # ffmpeg looks past the gap, and finds that the picture is not there
    assert not any("damaged" in warning for warning in footage.warnings)


def test_a_damaged_picture_puts_no_other_in_its_place(tmp_path):
    folder = make_pictures(tmp_path / "pictures")
    (folder / "frame_0009.png").write_bytes(b"no picture at all")
    footage = Footage(folder)
    frames = dict(footage)
    assert list(frames) == list(range(1, len(frames) + 1))
    values = [frames[frame].mean() for frame in frames]
    np.testing.assert_allclose(values, 5 * np.arange(1, len(frames) + 1), atol=2)
    assert any("could be read" in warning for warning in footage.warnings)


def test_linear_light_is_shown_as_a_screen_does(tmp_path):
    """A picture of OpenEXR at .2140 of full light is a screen's middle grey, 127.5 of 255."""
    (tmp_path / "exr").mkdir()
    raw = np.full((3, 3, 32, 32), 0.21404, dtype="<f4").tobytes()  # frames, planes
    ffmpeg(
        *("-f", "rawvideo", "-pix_fmt", "gbrpf32le", "-s", "32x32", "-r", "24", "-i", "-"),
        *("-c:v", "exr", tmp_path / "exr" / "a.%04d.exr"),
        feed=raw,
    )
    footage = Footage(tmp_path / "exr")
    assert footage.num_frames == 3
    assert footage.read(2).mean() == pytest.approx(127.5, abs=1.5)


def test_content_is_what_a_sequence_is_known_by(tmp_path):
    folder = make_pictures(tmp_path / "first")
    mark = fingerprint(ImageSequence(folder))
    moved = tmp_path / "deep" / "elsewhere"
    moved.mkdir(parents=True)
    for picture in sorted(folder.iterdir()):
        picture.rename(moved / picture.name.replace("frame", "other"))
    assert find_content(mark, files_in(tmp_path, 3)) == moved / "other_0001.png"
    (moved / "other_0020.png").unlink()
    assert fingerprint(ImageSequence(moved)) != mark


@pytest.mark.parametrize(
    ("names", "given", "message"),
    [
        ([], "", "holds no numbered pictures"),
        (["a.png", "b.png"], "", "holds no numbered pictures"),
        (["a1.png", "a2.png", "b1.png", "b2.png"], "", "several sequences: a#.png, b#.png"),
        (["a1.png"], "b_%04d.png", "no such pictures"),
        (["a.png"], "a.png", "is not a video file"),
        ([], "a1.png", "no such file"),
        (["a1.mov", "a2.mov"], "", "holds no numbered pictures"),
    ],
)
def test_what_is_no_sequence_is_told(tmp_path, names, given, message):
    for name in names:
        (tmp_path / name).write_bytes(b"content")
    with pytest.raises(UnreadableMedia, match=message):
        Footage(tmp_path / given if given else tmp_path)


def test_a_pipe_among_the_pictures_is_not_waited_for(tmp_path):
    folder = make_pictures(tmp_path / "pictures")
    (folder / "frame_0005.png").unlink()
    os.mkfifo(folder / "frame_0005.png")
    with pytest.raises(UnreadableMedia, match=r"frame_0005\.png is no file that can be read"):
        Footage(folder)


def test_a_picture_of_another_shape_is_told(tmp_path):
    folder = make_pictures(tmp_path / "pictures")
    ffmpeg("-i", folder / "frame_0007.png", "-vf", "scale=64:96", tmp_path / "other.png")
    os.replace(tmp_path / "other.png", folder / "frame_0007.png")
    footage = Footage(folder)
    np.testing.assert_allclose(levels(footage), 5 * np.arange(1, 21), atol=2)
    assert any("frames of 64 x 96 among those of 64 x 64" in text for text in footage.warnings)
