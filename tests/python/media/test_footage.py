# SPDX-License-Identifier: GPL-3.0-or-later
import contextlib
import os
import re
import resource
import signal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from clips import ffmpeg, make_clip, make_numbered_clip
from imageio_ffmpeg import get_ffmpeg_exe
from mimetic import UnreadableMedia
from mimetic.media.footage import Footage


def test_size_rate_and_count_are_the_files(tmp_path):
    footage = Footage(make_clip(tmp_path / "a.mp4", rate="24000/1001", frames=30, size="80x48"))
    assert footage.size == (80, 48)
    assert footage.fps == Fraction(24000, 1001)
    assert footage.num_frames == 30
    assert not footage.variable_rate and not footage.warnings
    np.testing.assert_allclose(footage.times, np.arange(30) * 1001 / 24000, atol=1e-9)


@pytest.mark.parametrize("rate", ["24", "25", "30000/1001", "60", "12.5"])
def test_milliseconds_of_matroska_do_not_make_the_rate_variable(tmp_path, rate):
    footage = Footage(make_clip(tmp_path / "a.mkv", rate=rate, frames=60))
    assert not footage.variable_rate
    assert float(footage.fps) == pytest.approx(float(Fraction(rate)), rel=1e-4)


def test_every_frame_comes_once_under_its_number(tmp_path):
    footage = Footage(make_numbered_clip(tmp_path / "a.mp4"))
    images = {}
    for frame, image in footage:
        assert image.shape == (64, 64, 3) and image.dtype == np.uint8
        images[frame] = float(image.mean())
    assert list(images) == list(range(1, 41))
    levels = np.array(list(images.values()))
    assert np.all(np.diff(levels) > 2)
    assert not footage.warnings


@pytest.mark.parametrize(("first", "last"), [(1, 1), (7, 7), (13, 30), (40, 40)])
def test_a_range_gives_the_same_frames_as_the_whole(tmp_path, first, last):
    footage = Footage(make_numbered_clip(tmp_path / "a.mp4"))
    whole = dict(footage)
    part = dict(footage.frames(first, last))
    assert list(part) == list(range(first, last + 1))
    for frame, image in part.items():
        np.testing.assert_array_equal(image, whole[frame])
    np.testing.assert_array_equal(footage.read(first), whole[first])


def test_a_frame_read_again_is_not_decoded_again_and_may_be_written_on(tmp_path, monkeypatch):
    footage = Footage(make_numbered_clip(tmp_path / "a.mp4"))
    first, second = footage.read(7), footage.read(8)
    second_again = second.copy()
    monkeypatch.setattr(Footage, "frames", lambda *_: pytest.fail("decoded"))
    footage.read(8)[:] = 0
    np.testing.assert_array_equal(footage.read(8), second_again)
    assert (first != second).any()


@pytest.mark.parametrize("frame", [0, 41])
def test_a_frame_that_is_not_there_is_named(frame, tmp_path):
    footage = Footage(make_numbered_clip(tmp_path / "a.mp4"))
    with pytest.raises(UnreadableMedia, match=f"has no frame {frame} that can be read"):
        footage.read(frame)


def test_rotation_flags_are_applied(tmp_path):
    make_clip(tmp_path / "a.mp4", size="96x48")
    ffmpeg("-display_rotation", "90", "-i", tmp_path / "a.mp4", "-c", "copy", tmp_path / "b.mp4")
    upright, turned = Footage(tmp_path / "a.mp4"), Footage(tmp_path / "b.mp4")
    assert turned.size == (48, 96)
    assert (upright.rotation, turned.rotation) == (0, 90)
    difference = np.rot90(upright.read(3)).astype(int) - turned.read(3)
    assert np.abs(difference).mean() < 2


def test_variable_rate_passes_every_frame_once_and_says_so(tmp_path):
    path = tmp_path / "a.mkv"
    # every third frame dropped, time stamps kept
    make_numbered_clip(path, "-vf", "select=mod(n\\,3)", "-fps_mode", "passthrough", "-c:v", "ffv1")
    footage = Footage(path)
    assert footage.variable_rate and "variable rate" in footage.warnings[0]
    frames = dict(footage)
    assert list(frames) == list(range(1, len(footage.times) + 1)) == list(range(1, 27))
    assert np.all(np.diff([image.mean() for image in frames.values()]) > 2)
    assert footage.times[2] == pytest.approx(3 / 25, abs=2e-3)
    numbers = np.array([1, 2, 3, 26, 30])  # the last is not listed
    times = np.array([footage.time_of(number) for number in numbers.tolist()])
    np.testing.assert_allclose(times[:4], footage.times[numbers[:4] - 1])
    np.testing.assert_allclose(footage.counted(times) * float(footage.fps), numbers - 1)


@pytest.mark.parametrize(
    ("name", "codec"),
    [("a.h264", "libx264"), ("a.hevc", "libx265"), ("a.m2v", "mpeg2video"), ("b.avi", "libx264")],
)
def test_streams_that_do_not_say_when_frames_are_shown_have_their_constant_rate(
    tmp_path, name, codec
):
    footage = Footage(
        make_clip(tmp_path / name, "-c:v", codec, rate="30", frames=40, size="320x240")
    )
    assert footage.fps == 30 and footage.num_frames == 40
    assert not footage.variable_rate and not footage.warnings
    np.testing.assert_allclose(footage.times, np.arange(40) / 30, atol=1e-4)
    assert len(list(footage)) == 40 and not footage.warnings


def stretched(path, times, *more):
    """A copy in which every frame lasts so many times as long."""
    copy = path.with_suffix(".nut")
    ffmpeg("-i", path, "-c", "copy", *more, "-bsf:v", f"setts=ts=TS*{times}", copy)
    return copy


@pytest.mark.parametrize("seconds", [3600, 36000])
def test_a_frame_an_hour_has_a_rate(tmp_path, seconds):
    path = make_clip(tmp_path / "a.mkv", "-c:v", "ffv1", frames=20)
    footage = Footage(stretched(path, 25 * seconds))
    assert float(footage.fps) == pytest.approx(1 / seconds, rel=1e-3)
    assert len(list(footage)) == 20


def test_less_than_a_frame_a_day_is_refused_before_any_work(tmp_path):
    path = make_clip(tmp_path / "a.mkv", "-c:v", "ffv1", frames=3)
    with pytest.raises(UnreadableMedia, match="frames a second"):
        Footage(stretched(path, 25 * 28 * 3600))


@pytest.mark.parametrize(
    "pixels", ["gray16le", "gray", "gray10le", "rgb48le", "yuva420p", "yuv422p10le"]
)
def test_other_depths_and_grey_become_8_bit_colour(tmp_path, pixels):
    make_clip(tmp_path / "a.mkv", "-c:v", "ffv1", "-pix_fmt", pixels)
    make_clip(tmp_path / "b.mkv", "-c:v", "ffv1", "-pix_fmt", "yuv444p")
    image, plain = Footage(tmp_path / "a.mkv").read(4), Footage(tmp_path / "b.mkv").read(4)
    assert image.dtype == np.uint8 and image.shape == (48, 64, 3)
    weights = [0.299, 0.587, 0.114]
    assert abs((image @ weights).mean() - (plain @ weights).mean()) < 6


def test_8k_is_read_with_memory_for_a_few_frames(tmp_path):
    make_clip(tmp_path / "a.mp4", "-c:v", "mpeg4", size="7680x4320", frames=4, source="color")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    count = sum(image.shape == (4320, 7680, 3) for _, image in Footage(tmp_path / "a.mp4"))
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert count == 4
    assert grown < 250 * 1024  # KiB: two frames of 100 MB, not four


def test_ten_pixels_are_too_few(tmp_path):
    make_clip(tmp_path / "a.mkv", "-c:v", "ffv1", size="10x10")
    with pytest.raises(UnreadableMedia, match="10 x 10 pixels"):
        Footage(tmp_path / "a.mkv")


def test_a_side_over_the_limit_is_refused_before_any_frame_is_held(tmp_path):
    make_clip(tmp_path / "a.mkv", "-c:v", "ffv1", size="17000x16", frames=1, source="color")
    with pytest.raises(UnreadableMedia, match="17000 x 16 pixels"):
        Footage(tmp_path / "a.mkv")


def test_a_single_frame_is_one_frame(tmp_path):
    footage = Footage(make_clip(tmp_path / "a.mp4", frames=1))
    assert footage.num_frames == 1 and len(list(footage)) == 1


def test_a_truncated_file_gives_its_frames_and_a_warning(tmp_path):
    make_clip(
        tmp_path / "a.mp4", "-c:v", "libx264", "-movflags", "+faststart", frames=100, size="160x120"
    )
    content = (tmp_path / "a.mp4").read_bytes()
    (tmp_path / "b.mp4").write_bytes(content[: len(content) * 6 // 10])
    footage = Footage(tmp_path / "b.mp4")
    frames = [frame for frame, _ in footage]
    assert 10 < len(frames) < 100 and frames == list(range(1, len(frames) + 1))
    assert len(footage.warnings) == 1


def test_errors_of_decoding_are_told_although_no_frame_is_missing(tmp_path):
    make_clip(tmp_path / "a.mp4", "-c:v", "mpeg4", frames=40, size="640x360")
    content = bytearray((tmp_path / "a.mp4").read_bytes())
    first = content.index(b"mdat") + 4
    for place in range(
        first + (len(content) - first) // 3, first + (len(content) - first) // 2, 400
    ):
        content[place] ^= 0xFF
    (tmp_path / "b.mp4").write_bytes(content)
    footage = Footage(tmp_path / "b.mp4")
    for _ in range(2):
        assert len(list(footage)) == 40
        (warning,) = footage.warnings
        assert re.search(r"b\.mp4 is damaged: .* not without errors \(.+\)", warning)
    assert footage.failure is None


@pytest.mark.parametrize("is_sequence", [False, True])
def test_what_goes_away_or_is_replaced_before_it_is_read_is_a_failure(tmp_path, is_sequence):
    clip = gone = make_clip(tmp_path / "a.mp4")
    if is_sequence:
        ffmpeg("-i", clip, tmp_path / "a_%02d.png")
        clip, gone = tmp_path / "a_%02d.png", tmp_path / "a_04.png"
    footage, content = Footage(clip), gone.read_bytes()
    gone.rename(tmp_path / "elsewhere")
    with pytest.raises(OSError, match="it went away while it was read") as failure:
        footage.read(4)
    assert failure.value.filename == str(gone) and footage.failure is failure.value
    assert any("frame 4 could not be read: it went away" in text for text in footage.warnings)
    gone.write_bytes(content[: len(content) // 3])
    again = [frame for frame in begun(footage)]
    assert again == ([1, 2, 3] if is_sequence else [])
    assert "replaced or written to" in footage.failure.strerror
    assert not isinstance(footage.failure, UnreadableMedia)


def begun(footage):
    """Numbers of frames that come before a failure."""
    with contextlib.suppress(OSError):
        for frame, _ in footage:
            yield frame


def limited(tmp_path, monkeypatch, command):
    """Makes ffmpeg a program that does `command` first."""
    program = tmp_path / "ffmpeg-limited"
    program.write_text(f'#!/bin/sh\n{command}\nexec {get_ffmpeg_exe()} "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(program))


def test_a_warning_that_is_repeated_is_no_damage(tmp_path, monkeypatch):
    footage = Footage(make_clip(tmp_path / "a.mp4"))
    # As ffmpeg's log does with lines that are the same, unless it is told to repeat them
    warning = "echo '[sws @ 0] [warning] deprecated pixel format' >&2"
    counted = "echo '    Last message repeated 1 times' >&2"
    limited(
        tmp_path, monkeypatch, f'{warning}\ncase "$*" in *repeat+*) {warning};; *) {counted};; esac'
    )
    assert len(list(footage)) == 10 and not footage.warnings


def test_a_lack_of_memory_is_called_that(tmp_path, monkeypatch):
    clip = make_clip(tmp_path / "a.mp4")
    footage = Footage(clip)
    # What it says, and how it ends, under `ulimit -v 300000` with a clip of 1280 x 720
    output = "[vf#0:0] Error sending frames to consumers: Resource temporarily unavailable"
    limited(tmp_path, monkeypatch, f"echo '{output}' >&2; exit 245")
    for use in (lambda: list(footage), lambda: footage.read(3), lambda: Footage(clip)):
        with pytest.raises(OSError, match="out of memory") as failure:
            use()
        assert failure.value.filename == str(clip)
        assert not isinstance(failure.value, UnreadableMedia)


def test_an_ffmpeg_that_is_killed_leaves_its_frames_and_the_reason(tmp_path, monkeypatch):
    clip = make_clip(tmp_path / "a.mp4", frames=60, size="320x240")
    footage = Footage(clip)
    limited(tmp_path, monkeypatch, "echo $$ > $0.pid")
    frames = footage.frames()
    numbers = [next(frames)[0]]
    os.kill(int((tmp_path / "ffmpeg-limited.pid").read_text()), signal.SIGKILL)
    numbers += [frame for frame, _ in frames]
    assert numbers == list(range(1, len(numbers) + 1)) and len(numbers) < 60
    assert "out of memory" in footage.failure.strerror
    assert "frames could be read: ffmpeg ran out of memory" in footage.warnings[0]


def test_a_size_that_changes_midway_keeps_the_frames_in_step(tmp_path):
    for name, size in (("a.ts", 64), ("b.ts", 128)):
        make_numbered_clip(tmp_path / name, "-c:v", "mpeg2video", "-g", 1, size=size, frames=20)
    joined = tmp_path / "c.ts"
    joined.write_bytes((tmp_path / "a.ts").read_bytes() + (tmp_path / "b.ts").read_bytes())
    images = [image for _, image in Footage(joined)]
    assert len(images) in (39, 40)  # the decoder may lose the frame at the joint
    assert max(image.std() for image in images) < 3
    assert images[-1].mean() == pytest.approx(100, abs=6)  # frame 20 of the second file


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.mp4", b"", "is empty"),
        ("text.mp4", b"not a video at all\n" * 50, "is no"),
        ("list.m3u8", b"#EXTM3U\n#EXTINF:1,\nfile:///etc/hostname\n", "is not"),
        ("list.ffconcat", b"ffconcat version 1.0\nfile a.mp4\n", "is not a video file"),
    ],
)
def test_what_is_no_video_is_refused(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UnreadableMedia, match=message):
        Footage(tmp_path / name)


def test_sound_alone_has_no_video_stream(tmp_path):
    ffmpeg("-f", "lavfi", "-i", "sine=duration=1", tmp_path / "a.mp4")
    with pytest.raises(UnreadableMedia, match="no video stream"):
        Footage(tmp_path / "a.mp4")


def test_a_missing_index_is_named(tmp_path):
    content = make_clip(tmp_path / "a.mp4", frames=50).read_bytes()
    (tmp_path / "b.mp4").write_bytes(content[: len(content) // 2])
    with pytest.raises(UnreadableMedia, match="cut off before its index"):
        Footage(tmp_path / "b.mp4")


def test_missing_files_and_folders_are_named(tmp_path):
    with pytest.raises(UnreadableMedia, match="no such file"):
        Footage(tmp_path / "absent.mp4")
    with pytest.raises(UnreadableMedia, match="not a file"):
        Footage(tmp_path)
    with pytest.raises(UnreadableMedia, match="no such file"):
        Footage("http://127.0.0.1:9/a.mp4")


@pytest.mark.parametrize(
    "name", ["-i", "concat:a.mp4|b.mp4", "a%03d.mp4", "pipe:0", "-y x.mp4", "ä 'b\".mp4"]
)
def test_names_that_look_like_options_or_protocols_are_only_names(tmp_path, monkeypatch, name):
    make_clip(tmp_path / "plain.mp4")
    os.rename(tmp_path / "plain.mp4", tmp_path / name)
    monkeypatch.chdir(tmp_path)
    assert Footage(name).num_frames == 10
    assert len(list(Footage(name))) == 10


def test_leaving_the_loop_ends_the_process(tmp_path):
    footage = Footage(make_clip(tmp_path / "a.mp4", frames=250, size="320x240"))
    children = Path(f"/proc/self/task/{os.getpid()}/children")
    before = children.read_text().split()  # another test's, such as a pool's tracker
    frames = footage.frames()
    next(frames)
    assert len(children.read_text().split()) == len(before) + 1
    frames.close()
    assert children.read_text().split() == before
    assert not footage.warnings


def test_a_clip_that_was_trimmed_without_copying_pictures_has_those_it_shows(tmp_path):
    """It begins at a key frame before the cut, and states from where on it is shown."""
    whole = make_numbered_clip(tmp_path / "whole.mp4")
    trimmed = tmp_path / "trimmed.mp4"
    ffmpeg("-ss", "0.72", "-i", whole, "-c", "copy", trimmed)
    footage = Footage(trimmed)
    numbers = [round(image.mean() / 5) for _, image in footage.frames(1)]
    assert numbers[-1] == 40 and len(numbers) == footage.num_frames < 28
    assert not footage.warnings
    assert footage.times[0] == 0 and len(footage.times) == footage.num_frames


@pytest.mark.parametrize("other", [(128, 128), (64, 128)])
def test_pictures_keep_their_numbers_where_their_size_changes(tmp_path, other):
    # As calls are recorded: the picture grows when the connection does, in one VP8 stream
    shape = f"{other[0]}x{other[1]}"
    parts = [make_numbered_clip(tmp_path / "a.mp4", frames=20), tmp_path / "b.mp4"]
    ffmpeg(*("-i", parts[0], "-vf", f"negate,scale={shape}"), parts[1])
    for part in parts:
        ffmpeg("-i", part, *("-c:v", "libvpx", "-b:v", "2M"), part.with_suffix(".webm"))
    names = "".join(f"file {part.with_suffix('.webm')}\n" for part in parts)
    (tmp_path / "parts.txt").write_text(names)
    joined = tmp_path / "joined.webm"
    ffmpeg(*("-f", "concat", "-safe", "0", "-i", tmp_path / "parts.txt"), "-c", "copy", joined)
    footage = Footage(joined)
    whole = {frame: image.mean() for frame, image in footage.frames()}
    assert list(whole) == list(range(1, 41)) and footage.size == (64, 64)
    part = {frame: image.mean() for frame, image in footage.frames(15, 30)}
    assert list(part) == list(range(15, 31))
    assert all(abs(part[frame] - whole[frame]) < 1e-9 for frame in part)
    assert footage.read(35).mean() == pytest.approx(whole[35])
    told = [warning for warning in footage.warnings if "stretched" in warning]
    assert len(told) == (other[0] != other[1])
    assert not told or f"frames of {other[0]} x {other[1]} among those of 64 x 64" in told[0]
