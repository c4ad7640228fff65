# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate live`: the live filter beside the offline solve, on real clips."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.ffmpeg_process import running
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE as GAZE_ANGLES
from mimetic.puppet.live_filter import DEFAULT_STILLNESS, LiveFilter
from mimetic.puppet.live_heads import lens_of_fit
from mimetic.puppet.take import Take
from mimetic.puppet.taught_follower import SHARPEN
from mimetic.puppet.templates import TaughtSet
from mimetic.puppet.warm_up import warm_up
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.live_score import (
    GAZE,
    GROUPS,
    HEAD,
    JAW,
    LIDS,
    common_rows,
    correlations,
    curves_of,
    jitter_at_rest,
    lag_of,
)
from evaluation.runs.real_captures import captured_person
from evaluation.runs.real_events import score_events
from evaluation.runs.real_labels import CLIPS, FOLDER, footage_of
from evaluation.runs.real_still import still_runs

LAST = 600  # frame of each clip that is captured offline
STILLNESSES = (0.0, DEFAULT_STILLNESS, 1.0)
LAST_MARKED = 2410  # frame of franck.mp4, after its last marked blink
OFFLINE = "capture"
KNOWN_HEAD = "live, known head"  # that of the capture: what is left is the filter's own
CAMERA = (640, 480)
TIMED = 240  # frames of each clip at a camera's size
Report = Callable[[str], None]


@dataclass(frozen=True)
class LiveScore:
    """One clip, one way."""

    clip: str
    way: str
    frames: int
    held: int
    correlation: dict[str, float]  # with the offline solve
    lag: float  # frames behind it
    jitter: float
    milliseconds: float  # of a picture, median
    slow: float  # 95 of 100 take less
    search: float  # seconds in all of the looks for the face and the person's head, beside those
    blinks: str = ""


def score_live(report: Report, folder: Path | None = None) -> Iterator[list[LiveScore]]:
    """Clip by clip. folder: offline performances of an earlier run, NAME.npz; others are made."""
    warm_up()
    for clip in CLIPS:
        footage = Footage(footage_of(clip))
        last = min(LAST, footage.num_frames)
        offline, fit = captured_person(clip, last, report, folder)
        runs = still_runs(clip, offline)
        report(f"{clip}: live")
        # Blinks are marked in many more frames than are captured offline
        end = LAST_MARKED if (FOLDER / f"{clip}.blinks.csv").exists() else last
        end = min(footage.num_frames, end)
        take = followed(footage, end)
        ways = {f"live, stillness {s:g}": stilled(take, s) for s in STILLNESSES}
        report(f"{clip}: live, known head")
        ways[KNOWN_HEAD] = stilled(followed(footage, end, person=fit), 0.0)
        scores = [_offline_score(clip, offline, runs)]
        for way, stilled_take in ways.items():
            performance = stilled_take.performance(footage)
            scores.append(_score(clip, way, performance, stilled_take, offline, runs))
        yield scores


def followed(
    footage: Footage,
    last: int,
    taught: TaughtSet | None = None,
    use: str = SHARPEN,
    person: FaceFit | None = None,
) -> Take:
    """A clip as a camera's pictures, none skipped, without the last filter.

    person: the fit that is known beforehand, with its lens
    """
    lens = lens_of_fit(person) if person else None
    live = LiveFilter(0.0, in_background=False, taught=taught, use=use, lens=lens, person=person)
    live.prepare()
    take = Take(float(footage.fps))
    for frame, image in footage.frames(1, last):
        state = live.advance(image, (frame - 1) / float(footage.fps))
        if state is not None and live.face is not None:
            take.add(state, live.face)
    return take


def stilled(take: Take, stillness: float) -> Take:
    """The same after the last filter, which the gaze does not go through."""
    last_filter = _core.StillnessFilter(stillness)
    states, before = [], None
    for state in take.states:
        since = 0.0 if before is None else state.time - before
        moving, gaze = state.values[: -len(GAZE_ANGLES)], state.values[-len(GAZE_ANGLES) :]
        pose, values = last_filter.advance(state.head_pose, moving, since)
        states.append(replace(state, head_pose=pose, values=np.concatenate([values, gaze])))
        before = state.time
    return replace(take, states=states)


def times_of(take: Take) -> list[float]:
    """Milliseconds of each picture, without the search, which a session has in a thread."""
    return [state.milliseconds - state.search_milliseconds for state in take.states]


def search_of(take: Take) -> float:
    """Seconds that looking for the face and the person's head took in all."""
    return sum(state.search_milliseconds for state in take.states) / 1000


def _offline_score(clip: str, offline: Performance, runs: NDArray[np.int64]) -> LiveScore:
    blinks = [one.text() for one in score_events(clip, offline) if one.kind == "blinks"]
    return LiveScore(
        *(clip, OFFLINE, offline.num_frames, int((offline.quality < 0.2).sum()), {}, 0.0),
        *(jitter_at_rest(runs, offline), np.nan, np.nan, np.nan, "".join(blinks)),
    )


def _score(
    clip: str,
    way: str,
    performance: Performance,
    take: Take,
    offline: Performance,
    runs: NDArray[np.int64],
) -> LiveScore:
    rows, offline_rows = common_rows(performance, offline)
    live, truth = curves_of(performance, rows), curves_of(offline, offline_rows)
    blinks = [one.text() for one in score_events(clip, performance) if one.kind == "blinks"]
    return LiveScore(
        *(clip, way, performance.num_frames),
        *(int((performance.quality < 0.2).sum()), correlations(live, truth), lag_of(live, truth)),
        jitter_at_rest(runs, performance),
        *timed(take),
        "".join(blinks),
    )


def timed(take: Take) -> tuple[float, float, float]:
    """Milliseconds of a picture, median and 95 of 100; seconds of the search."""
    times = times_of(take)
    return float(np.median(times)), float(np.quantile(times, 0.95)), search_of(take)


def speed(report: Report) -> dict[str, tuple[float, float, float]]:
    """What `timed` gives of pictures of CAMERA's size, by clip."""
    result = {}
    with tempfile.TemporaryDirectory() as folder:
        for clip in CLIPS:
            report(f"{clip}: speed at {CAMERA[0]} x {CAMERA[1]}")
            enlarged = Path(folder) / f"{clip}.mkv"
            scale = f"scale={CAMERA[0]}:{CAMERA[1]}:force_original_aspect_ratio=decrease"
            pad = f"pad={CAMERA[0]}:{CAMERA[1]}:(ow-iw)/2:(oh-ih)/2"
            command = [
                *(ffmpeg_program(), "-v", "error", "-i", str(footage_of(clip)), "-an"),
                *("-frames:v", str(TIMED), "-vf", f"{scale},{pad}", "-c:v", "ffv1", str(enlarged)),
            ]
            with running(command) as ffmpeg:
                ffmpeg.process.wait()
            result[clip] = timed(followed(Footage(enlarged), TIMED))
    return result


def as_json(scores: list[Any]) -> str:
    """Of rows of all tables, this one's, `live_taught`'s and `live_still`'s."""
    return json_text([asdict(score) for score in scores])


def as_text(scores: list[LiveScore]) -> str:
    columns = {f"group {group}": (f"group {group}", ".2f") for group in GROUPS}
    columns |= {name: (name, ".2f") for name in (JAW, LIDS, GAZE, *HEAD)}
    columns |= {
        "lag": ("lag, frames", ".1f"),
        "jitter": ("jitter at rest", ".4f"),
        "milliseconds": ("ms", ".0f"),
        "slow": ("95 %", ".0f"),
        "search": ("search, s", ".1f"),
        "held": ("held", ".0f"),
    }
    rows = {f"{s.clip}, {s.way}": asdict(s) | s.correlation for s in scores}
    lines = [text_table("", columns, rows, cell=12)]
    lines += [f"{score.way}: {score.blinks}" for score in scores if score.blinks]
    return "\n".join(lines)


def speed_text(speeds: dict[str, tuple[float, float, float]]) -> str:
    """Of pictures of a camera's size, and what each stillness costs and gives at 30 a second."""
    lines = [
        f"{clip} at {CAMERA[0]} x {CAMERA[1]}: {median:.0f} ms a picture (95 % under {slow:.0f}), "
        f"{1000 / median:.0f} a second; beside it {search:.1f} s of looking for the head"
        for clip, (median, slow, search) in speeds.items()
    ]
    for stillness in (0.0, 0.25, 0.5, 0.75, 1.0):
        figures = _core.stillness_figures(stillness, 30.0)
        lines.append(
            f"stillness {stillness:.2f}: lag {figures.lag_frames:.2f} frames, "
            f"jitter x {figures.jitter_share:.2f}"
        )
    return "\n".join(lines)
