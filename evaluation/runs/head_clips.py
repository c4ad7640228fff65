# SPDX-License-Identifier: GPL-3.0-or-later
"""Head sequences with known poses, rendered by a checkout, and what follows the heads in them."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, _core
from mimetic.fit import fitting
from mimetic.fit.fitting import FaceFit
from mimetic.head.tracking import MODELS, NUM_PASSES, follow_options, head_shape, track_head
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.solve import clip_capture
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.runs.head_score import REST_SECONDS, HeadScore, score_head
from evaluation.runs.rendered import CHECKOUT, render

FACE_MESH = "face mesh"
TIMED_FRAMES = 60
# By name: the model, and how it is followed otherwise than users get it. "flow" is the paper's own
# form: the flow from frame to frame in one pass, nothing to go back to, each frame as measured.
FLOW = {"flow_alone": True, "smoothing": 0.0}
METHODS: dict[str, tuple[str, dict]] = {model: (model, {}) for model in MODELS} | {
    "ellipsoid fast": ("ellipsoid", {"fast": True}),
    "ellipsoid flow": ("ellipsoid", FLOW),
    "plane flow": ("plane", FLOW),
}
Report = Callable[[str], None]


@dataclass(frozen=True)
class HeadClip:
    """Footage of a head whose pose (camera from head, N x 4 x 4) is known in every frame."""

    kind: str
    name: str
    footage: Path
    head_pose: NDArray[np.float64]
    intrinsics: NDArray[np.float64]
    image_size: tuple[int, int]
    fps: float

    @property
    def camera(self) -> _core.Camera:
        k = self.intrinsics
        return _core.Camera(k[0, 0], k[1, 1], k[0, 2], k[1, 2], *self.image_size)


def head_clips(which: str, report: Report) -> list[HeadClip]:
    """The clips of a set, rendered now if the cache lacks them."""
    output = render(["--heads", which], "the heads could not be rendered", report)
    return [_load(*row.split("\t")) for row in output.splitlines()]


def _load(kind: str, name: str, footage: str, truth: str) -> HeadClip:
    with np.load(truth, allow_pickle=False) as arrays:
        size = tuple(int(n) for n in arrays["image_size"])
        return HeadClip(
            *(kind, name, Path(footage), arrays["head_pose"], arrays["intrinsics"], size),
            fps=float(arrays["fps"][0]),
        )


def score_clip(clip: HeadClip, face_mesh: Path | None, report: Report) -> Iterator[HeadScore]:
    """Each model, and MediaPipe's face mesh where its interpreter is given."""
    truth = (clip.head_pose, clip.fps)
    fit = fit_with_camera(clip)
    for method, (model, how) in METHODS.items():
        report(f"{clip.name}: {method}")
        performance = track_head(clip.footage, model, fit=fit, **how)
        poses = performance.head_pose.copy()
        poses[performance.quality < HELD_QUALITY] = np.nan
        seconds = _seconds_a_frame(clip, fit, model, how)
        yield score_head(clip.name, clip.kind, method, poses, *truth, seconds)
    if face_mesh is not None:
        report(f"{clip.name}: {FACE_MESH}")
        poses, seconds = _run_face_mesh(clip, face_mesh)
        yield score_head(clip.name, clip.kind, FACE_MESH, poses, *truth, [seconds])


def fit_with_camera(clip: HeadClip) -> FaceFit:
    """The head found and fitted without help, but with the clip's own camera."""
    frame_at_rest = clip_capture.find_face(clip.footage).frame
    image = Footage(clip.footage).read(frame_at_rest)
    return fitting.find_face(image, frame_at_rest, camera=clip.camera)


def _seconds_a_frame(clip: HeadClip, fit: FaceFit, model: str, how: dict) -> list[float]:
    """The median time of a frame in each pass over the clip, decoded already, as the face mesh is
    timed. What is done once a clip, between the passes and after them, is left out."""
    template = load_template()
    shape = head_shape(model, fit.neutral_vertices(template), template)
    frames = Footage(clip.footage).frames(fit.frame, fit.frame + TIMED_FRAMES)
    images = [np.ascontiguousarray(image) for _, image in frames]
    options = follow_options(fast=how.get("fast", False), flow_alone="flow_alone" in how)
    tracker = _core.HeadTracker(fit.camera, shape, images[0], fit.head_pose, options)
    passes = [_median_seconds(tracker, images, fit.head_pose)]
    while options.max_key_views and len(passes) < NUM_PASSES and tracker.relax():
        passes.append(_median_seconds(tracker, images, fit.head_pose))
    return passes


def _median_seconds(
    tracker: _core.HeadTracker, images: list[NDArray[np.uint8]], pose: NDArray[np.float64]
) -> float:
    """Of a frame, from the first image on, in which the head is at `pose`."""
    seconds, guess = [], pose
    for image in images:
        start = time.perf_counter()
        tracker.advance(image, guess)
        seconds.append(time.perf_counter() - start)
        guess = None
    return float(np.median(seconds))


def face_mesh_python(report: Report) -> Path | None:
    """The interpreter of scripts/face_mesh_env, which is made now; nothing if it cannot be."""
    script = CHECKOUT / "scripts" / "face_mesh_env"
    process = subprocess.run([str(script)], capture_output=True, text=True, check=False)
    if process.returncode != 0:
        report(f"no face mesh beside ours: {' '.join(process.stderr.split()[-40:])}")
        return None
    return Path(process.stdout.splitlines()[-1])


def _run_face_mesh(clip: HeadClip, python: Path) -> tuple[NDArray[np.float64], float]:
    """Its poses (N,4,4), nan without a face, and its median seconds a frame."""
    with tempfile.TemporaryDirectory() as folder:
        frames, intrinsics, out = (Path(folder) / n for n in ("f.npy", "k.npy", "out.npz"))
        np.save(frames, np.stack([image for _, image in Footage(clip.footage)]))
        np.save(intrinsics, clip.intrinsics)
        rest = max(3, round(REST_SECONDS * clip.fps))
        command = [
            str(python),
            str(CHECKOUT / "evaluation" / "synthetic" / "heads" / "face_mesh.py"),
        ]
        command += [str(frames), str(intrinsics), str(rest), str(out)]
        process = subprocess.run(command, capture_output=True, text=True, check=False)
        if process.returncode != 0:
            raise InvalidInput(f"the face mesh failed: {' '.join(process.stderr.split()[-40:])}")
        with np.load(out, allow_pickle=False) as arrays:
            return arrays["head_pose"], float(np.median(arrays["seconds"]))
