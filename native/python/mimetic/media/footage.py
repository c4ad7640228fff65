# SPDX-License-Identifier: GPL-3.0-or-later
"""Video by an ffmpeg process of its own: hostile files cannot crash us, memory stays constant."""

from __future__ import annotations

import os
import re
from collections import deque
from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import UnreadableMedia
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.ffmpeg import failure_of, ffmpeg_program
from mimetic.media.ffmpeg_process import fill, running
from mimetic.media.high_range import high_range_of
from mimetic.media.image_sequence import ImageSequence, is_sequence, number_of, opened
from mimetic.media.source_state import SourceState
from mimetic.media.timing import FASTEST, SLOWEST
from mimetic.shared.regular_file import check_input

# What the extension asks for footage, a folder or a picture of
__all__ = ["CONTAINERS", "Footage", "ImageSequence", "is_sequence", "number_of", "opened"]

SMALLEST, LARGEST = 16, 16384  # pixels, each side
NEARLY_SQUARE = 1.01  # a pixel's longer side over its shorter: turns a head by a tenth of a degree
LARGEST_ASPECT = 4.0  # the widest lenses squeeze pictures to a half
# Containers of moving pictures only: play lists and image patterns can open other files.
CONTAINERS = (
    "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,flv,asf,ogg,mxf,gif,"
    "yuv4mpegpipe,nut,ivf,h264,hevc,av1,obu,m4v,dv,apng,rm,swf,wtv"
)
FRAME_RATE = re.compile(rb"config in time_base: (\d+)/(\d+), frame_rate: (\d+)/(\d+)")
FIRST_FRAME = re.compile(rb" n: +0 .* sar:(\d+)/(\d+) s:(\d+)x(\d+) ")
OTHER_SIZE = re.compile(rb"incoming frame - w: *(\d+) h: *(\d+)")
TURNED = re.compile(rb"Display Matrix: rotation of (-?\d+)")
DAMAGED = "is damaged: all frames could be read, but not without errors"
LEFT_OUT = 4  # ffmpeg's AV_PKT_FLAG_DISCARD
NO_TIME = -(1 << 63)  # ffmpeg's, of a packet that carries none
# ffmpeg's words -> ours
REASONS = (
    ("not on whitelist", "is not a video file; convert it to MP4, MOV, MKV, WebM or AVI"),
    ("moov atom not found", "is no video or is cut off before its index; copy or record it again"),
    ("matches no streams", "has no video stream"),
    ("max_pixels", f"has frames larger than {LARGEST} x {LARGEST} pixels; scale it down"),
    ("Permission denied", "cannot be opened: no permission to read it"),
    ("Invalid data found", "is not video that can be read; convert it to MP4 (H.264)"),
)


class Footage:
    """A video file, or an `ImageSequence`: its size, rate and frames.

    `size` is (width, height) of the frames that it gives: their pixels are square, and the file's
    rotation is applied. `stored_size` is what the file itself has and other tools show, rotated
    too; it differs where pixels are stored wider or narrower. `rotation` is by how many degrees,
    anticlockwise, the file says that its pictures are to be turned, as phones do. `fps` is an
    exact fraction; `num_frames` what the file lists, which a damaged file may not hold; `times` the
    seconds of each listed frame since the first; `start` when that is, seconds from the file's
    beginning, which may be its sound's; `identity` the file's name and its fingerprint
    (`clip_fingerprint`), as a performance keeps them. Frame numbers start at 1. `warnings` says
    what the user should know and grows while frames are read; `failure` is why ffmpeg gave up on
    them, if it did, or that the file went away or was replaced meanwhile. Raises UnreadableMedia,
    and OSError where ffmpeg ran out of memory or was ended.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = opened(path)
        self.warnings: list[str] = []
        self.failure: OSError | None = None
        self._last_read: tuple[int, NDArray[np.uint8]] | None = None
        if isinstance(self.path, Path):
            self._check_file(self.path)
        else:
            self.warnings += self.path.warnings()
        name = os.fsencode(self.path.name).decode(errors="replace")
        try:
            self._state = SourceState(self.path)
        except OSError as error:  # gone since it was checked
            raise UnreadableMedia(f"{self.path} cannot be read: {error.strerror}") from None
        self.identity = [name, fingerprint(self.path)]
        report, times, tick = self._probe()
        self._read_report(report)
        self._read_range(report)
        self.num_frames = max(1, len(times))
        self.start = float(times[0]) if len(times) else 0.0
        self.times = times - self.start
        self._set_rate(report, tick)

    def __iter__(self) -> Iterator[tuple[int, NDArray[np.uint8]]]:
        return self.frames()

    def frames(
        self, first: int = 1, last: int | None = None
    ) -> Iterator[tuple[int, NDArray[np.uint8]]]:
        """Yields (frame number, H x W x 3 uint8 red, green, blue), `first` to `last` included.

        Decodes a file from its start and drops what comes before `first`: seeking lands on the
        right frame in no format for certain. The array is the caller's to keep. Raises OSError if
        ffmpeg fails, or the file went away, before it gives a frame; later, `failure` says so and
        the frames end.
        """
        width, height = self.size
        # Each picture is a file: the first is that of the frame
        begin, colours = (1, "") if isinstance(self.path, Path) else (first, self.path.filter)
        # Scaled first: only `scale` takes pictures of other sizes in between
        scaled = f"scale={width}:{height}{self._to_sdr}"
        until = "" if last is None else f"*lte(n\\,{last - begin})"
        # With a new graph for pictures of another size `select` would count from 0 again; what
        # turns pictures is made for one size
        kept = () if self.rotation else ("-reinit_filter", "0")
        others: set[tuple[int, int]] = set()
        # "repeat": or a repeated warning is counted in a line without a level, as if it were worse
        command = [
            *self._command("-v", "repeat+level+warning", *kept, begin=begin),
            *("-vf", f"select=gte(n\\,{first - begin}){until},{colours}{scaled}"),
            *("-fps_mode", "passthrough", "-pix_fmt", "rgb24", "-f", "rawvideo"),
            *(() if last is None else ("-frames:v", str(last - first + 1))),
            "pipe:1",
        ]
        frame = first - 1
        with running(command, on_line=partial(_is_warning, others)) as (process, output, errors):
            while True:
                image = np.empty((height, width, 3), np.uint8)
                if not fill(output, image):
                    break
                frame += 1
                yield frame, image
            process.wait()
        self._warn_of_sizes(others)
        is_short = frame < min(last or self.num_frames, self.num_frames)
        # Beyond a gap in its numbers ffmpeg looks for a picture of a sequence that never was
        is_file = isinstance(self.path, Path)
        is_short = is_short or (is_file and process.returncode != 0)
        failure = failure_of(process.returncode, errors, self.path)
        if failure is None and (is_short or (errors and is_file)):
            failure = self._state.failure()
        self.failure = failure or self.failure
        if failure and frame < first:
            self._warn_of_nothing((first, last or self.num_frames), failure)
            raise failure
        if is_short:
            self._warn_of_early_end(frame, failure, errors)
        elif errors and is_file:
            self._warn_of_damage(errors)

    def time_of(self, frame: int) -> float:
        """Seconds from the first frame to another; past the listed ones it goes on at `fps`."""
        last = min(frame, len(self.times))
        listed = float(self.times[last - 1]) if last else 0.0
        return listed + (frame - max(last, 1)) / float(self.fps)

    def counted(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Seconds since the first frame as its frames' numbers and `fps` have them: (number - 1) /
        fps, of a variable rate too. The inverse of `time_of`."""
        if not len(self.times):
            return times
        steps = np.arange(len(self.times)) / float(self.fps)
        return np.interp(times, self.times, steps) + np.maximum(0, times - self.times[-1])

    def read(self, frame: int) -> NDArray[np.uint8]:
        """One frame by its number, H x W x 3 uint8.

        The last one is kept: a fitted frame is asked for by one stage after the other.
        """
        if self._last_read is not None and self._last_read[0] == frame:
            return self._last_read[1].copy()
        for _, image in self.frames(frame, frame):
            self._last_read = frame, image.copy()
            return image
        raise UnreadableMedia(f"{self.path} has no frame {frame} that can be read")

    def _warn_of_early_end(self, frame: int, failure: OSError | None, errors: deque[bytes]) -> None:
        reason = f" ({_shorten(errors[-1])})" if errors else ""
        why = failure.strerror if failure else f"it ends early or is damaged{reason}"
        self._warn(f"{self.path.name}: {frame} of {self.num_frames} frames could be read: {why}")

    def _warn_of_nothing(self, frames: tuple[int, int], failure: OSError) -> None:
        first, last = frames
        which = f"frame {first}" if first == last else f"frames {first} to {last}"
        self._warn(f"{self.path.name}: {which} could not be read: {failure.strerror}")

    def _warn_of_damage(self, errors: deque[bytes]) -> None:
        # Later passes over the file meet the same errors, in another order: reported once
        if not any(DAMAGED in warning for warning in self.warnings):
            self._warn(
                f"{self.path.name} {DAMAGED} ({_shorten(errors[0])}): what is measured in broken "
                "pictures is wrong; copy or record it again"
            )

    def _warn_of_sizes(self, others: set[tuple[int, int]]) -> None:
        """others: (width, height) of pictures that differ from the first."""
        stored_width, stored_height = self.stored_size
        for width, height in sorted(others):
            aspect = (width * stored_height) / (height * stored_width)
            if max(aspect, 1 / aspect) >= NEARLY_SQUARE:
                self._warn(
                    f"{self.path.name} has frames of {width} x {height} among those of "
                    f"{stored_width} x {stored_height}, which they are stretched to: faces are "
                    "wrong there; bring all frames to one shape"
                )

    def _warn(self, warning: str) -> None:
        if warning not in self.warnings:
            self.warnings.append(warning)

    @staticmethod
    def _check_file(path: Path) -> None:
        check_input(path, "a video file")
        if path.stat().st_size == 0:
            raise UnreadableMedia(f"{path} is empty; copy or record it again")

    def _command(self, *options: str, begin: int = 1) -> list[str]:
        """begin: of an image sequence, the frame to read from."""
        program = (ffmpeg_program(), "-nostdin", "-hide_banner", *options)
        limit = ("-max_pixels", str(LARGEST * LARGEST))
        if isinstance(self.path, ImageSequence):
            return [*program, *limit, *self.path.input_options(begin), "-map", "0:V:0"]
        # "file:" before an absolute path: no name can be taken for an option or a protocol.
        return [
            *(*program, "-protocol_whitelist", "file", "-format_whitelist", CONTAINERS),
            *(*limit, "-i", f"file:{self.path.absolute()}", "-map", "0:V:0"),
        ]

    def _probe(self) -> tuple[bytes, NDArray[np.float64], Fraction]:
        """ffmpeg's report on the first frame; each picture's time and the clock's tick, seconds."""
        packets = ("-map", "0:V:0", "-c", "copy", "-f", "framecrc", "pipe:1")
        is_file = isinstance(self.path, Path)
        command = [
            *self._command("-v", "info", "-nostats"),
            *("-vf", "showinfo", "-frames:v", "1", "-f", "null", "-"),
            *(packets if is_file else ()),
        ]
        tick = Fraction(0)
        rows = []
        with running(command, longest=400) as (process, output, report):
            for line in output:
                if line.startswith(b"#tb 0:"):
                    tick = Fraction(line.split(b":", 1)[1].decode().strip())
                elif not line.startswith(b"#") and not _is_left_out(line):
                    rows.append([int(word) for word in line.split(b",")[1:3]])
            process.wait()
        if failure := failure_of(process.returncode, report, self.path):
            raise failure
        if isinstance(self.path, ImageSequence):
            tick = 1 / self.path.fps
            times = np.arange(self.path.num_frames) * float(tick)
            return b"\n".join(report), times, tick
        decode_times, shown_times = np.array(rows, dtype=np.int64).reshape(-1, 2).T
        # Raw streams and AVI say when frames are decoded, not when they are shown
        stamps = np.sort(decode_times if (shown_times == NO_TIME).any() else shown_times)
        return b"\n".join(report), stamps * float(tick), tick

    def _read_report(self, report: bytes) -> None:
        match = FIRST_FRAME.search(report)
        if match is None:
            text = report.decode(errors="replace")
            for word, reason in REASONS:
                if word in text:
                    raise UnreadableMedia(f"{self.path} {reason}")
            raise UnreadableMedia(
                f"{self.path} holds no frame that can be decoded; convert it to MP4"
            )
        turned = TURNED.search(report)
        self.rotation = int(turned[1]) % 360 if turned else 0
        aspect_x, aspect_y, width, height = (int(group) for group in match.groups())
        if min(width, height) < SMALLEST or max(width, height) > LARGEST:
            raise UnreadableMedia(
                f"{self.path} has frames of {width} x {height} pixels; "
                f"each side must be {SMALLEST} to {LARGEST}: scale the footage"
            )
        self.size = self.stored_size = (width, height)
        aspect = Fraction(aspect_x, aspect_y) if aspect_x > 0 and aspect_y > 0 else Fraction(1)
        if max(aspect, 1 / aspect) < NEARLY_SQUARE:
            return
        warning = f"{self.path.name} has pixels of aspect {aspect_x}:{aspect_y}"
        if max(aspect, 1 / aspect) > LARGEST_ASPECT:
            self.warnings.append(f"{warning}, which no camera makes; they are taken as square")
            return
        self.size = _with_square_pixels(width, height, aspect)
        self.warnings.append(
            f"{warning}: its frames of {width} x {height} are worked with at "
            f"{self.size[0]} x {self.size[1]}, where they are square"
        )

    def _read_range(self, report: bytes) -> None:
        high_range = high_range_of(report)
        self._to_sdr = f",{high_range.filter}" if high_range and high_range.filter else ""
        if high_range:
            self.warnings.append(high_range.warning(self.path.name))

    @property
    def pixel_aspect(self) -> float:
        """Width over height of a stored pixel, as it is shown."""
        (width, height), (stored_width, stored_height) = self.size, self.stored_size
        return (width / stored_width) / (height / stored_height)

    def _set_rate(self, report: bytes, tick: Fraction) -> None:
        match = FRAME_RATE.search(report)
        nominal = Fraction(0)
        if match and int(match[4]) > 0:
            nominal = Fraction(int(match[3]), int(match[4]))
        steps = np.diff(self.times)
        mean = float(steps.mean()) if len(steps) and steps.mean() > 0 else 0.0
        expected_step = 1 / float(nominal) if nominal > 0 else mean
        # A clock of milliseconds rounds 41.7 to 41 or 42: a tick to either side is still constant.
        slack = 1.5 * float(tick) + 0.02 * expected_step
        # A file cut off mid-group lists its last frames with gaps.
        sound_steps, last_steps = np.split(steps, [len(steps) - min(16, len(steps) // 2)])
        if len(sound_steps) and (np.abs(sound_steps - expected_step) > slack).all():
            nominal, expected_step = (
                Fraction(0),
                float(np.median(sound_steps)),
            )  # not what the codec says
            slack = 1.5 * float(tick) + 0.02 * expected_step
        if 0 < len(steps) <= 32 and expected_step > 0:  # half of them: only gaps are passed over
            num_frames = np.maximum(1, np.rint(last_steps / expected_step))
            sound_steps = np.concatenate([sound_steps, last_steps / num_frames])
        self.variable_rate = bool((np.abs(sound_steps - expected_step) > slack).any())
        if nominal <= 0 or self.variable_rate:
            nominal = _rate_of(mean) if mean > 0 else Fraction(25)
        if not SLOWEST <= nominal <= FASTEST:
            raise UnreadableMedia(
                f"{self.path} has {float(nominal):.3g} frames a second; {SLOWEST:g} to "
                f"{FASTEST:g} are read: convert it to another rate"
            )
        self.fps = nominal
        if self.variable_rate:
            self.warnings.append(
                f"{self.path.name} has a variable rate ({1000 * steps.min():.0f} to "
                f"{1000 * steps.max():.0f} ms a frame, {float(nominal):.4g} frames/s on average): "
                "frames are counted as stored; convert it to a constant rate first: timing is "
                "inexact, and Blender shows frames by their times, others behind the face"
            )


def _is_warning(others: set[tuple[int, int]], line: bytes) -> bool:
    """Whether ffmpeg only warns in a line; `others` takes up the sizes that it warns of."""
    if size := OTHER_SIZE.search(line):
        others.add((max(int(size[1]), 1), max(int(size[2]), 1)))
    return b"[warning]" in line


def _is_left_out(packet: bytes) -> bool:
    """Whether a line of framecrc is of a picture before the beginning that a file states."""
    flags = (word.strip() for word in packet.split(b",")[5:])
    return any(int(word[2:], 16) & LEFT_OUT for word in flags if word.startswith(b"F="))


def _rate_of(seconds: float) -> Fraction:
    """Frames a second, of so many seconds a frame: a fraction of small numbers."""
    if seconds > 1:
        return 1 / Fraction(seconds).limit_denominator(1001)
    return Fraction(1 / seconds).limit_denominator(1001)


def _with_square_pixels(width: int, height: int, aspect: Fraction) -> tuple[int, int]:
    """The size at which nothing that is stored is lost, unless that would be too large."""
    larger = (round(width * aspect), height) if aspect > 1 else (width, round(height / aspect))
    if max(larger) <= LARGEST:
        return larger
    return (width, round(height / aspect)) if aspect > 1 else (round(width * aspect), height)


def _shorten(line: bytes) -> str:
    return re.sub(r"^(\[[^]]*\] *)+", "", line.decode(errors="replace"))[:120]
