# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips made on the spot by ffmpeg."""

import subprocess

from imageio_ffmpeg import get_ffmpeg_exe


def ffmpeg(*arguments, feed=None):
    subprocess.run(
        [get_ffmpeg_exe(), "-v", "error", "-y", *(str(argument) for argument in arguments)],
        input=feed,
        check=True,
    )


def make_clip(path, *output, size="64x48", rate="25", frames=10, source="testsrc2"):
    ffmpeg(
        *("-f", "lavfi", "-i", f"{source}=size={size}:rate={rate}", "-frames:v", frames),
        *(output or ("-c:v", "libx264", "-pix_fmt", "yuv420p")),
        path,
    )
    return path


def make_numbered_clip(path, *output, frames=40, size=64):
    """Grey frames whose brightness tells their number: frame n has the value 5 n."""
    raw = b"".join(bytes([5 * n]) * (size * size) for n in range(1, frames + 1))
    ffmpeg(
        *("-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{size}x{size}", "-r", "25", "-i", "-"),
        *(output or ("-c:v", "libx264", "-qp", "0", "-pix_fmt", "yuv420p", "-bf", "2", "-g", "12")),
        path,
        feed=raw,
    )
    return path
