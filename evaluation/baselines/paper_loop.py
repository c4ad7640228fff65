# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's own estimator: an observer with the skin's dynamics, and feedback control.

Essa, Basu, Darrell and Pentland 1996, Fig. 2, as a baseline on the interface of `pipeline.capture`:
(a) a Kalman filter whose only measurement is the optical flow from frame to frame, with the flow's
covariance; (b) its model is the skin's M u'' + D u' + K u = f, in the coordinates of ReducedSkin
(static responses of muscles and jaw and the lowest natural modes); (c) the muscle controls are
those whose forces make the model follow the corrected motion best (linear quadratic tracking), and
they drive the model's next step. There is no reference texture and no smoother: errors add up, as
theirs did. The head's pose is solved together with the skin, from the same flow.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field

import numpy as np
from mimetic import _core
from mimetic._core import from_rotation_vectors
from mimetic.fit.fitting import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy, modes_of
from mimetic.muscles.articulators import ARTICULATORS, JAW
from mimetic.muscles.motion import LoadedSkin, dynamics_options, load_skin
from mimetic.performance.document import Performance
from mimetic.performance.rows import Rows
from mimetic.score import luminance
from mimetic.score.sampling import sampled
from mimetic.shared.progress import ATTACHED, SEARCHED, Progress, stages
from mimetic.skin.mesh import multiply
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import FrameRange, check_range, fit_for
from mimetic.solve.clip_performance import clip_performance
from mimetic.solve.tracking import UNMEASURED
from mimetic.solve.walk import ClipWalk
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

Floats = NDArray[np.float64]
GREY = luminance.GREY.astype(np.float32)
NUM_MODES = 8
MOST_SAMPLES = 1000
LEAST_COSINE = 0.35  # between a sample's normal and the view
WINDOW_PX = 64.0  # pixels whose flow is one independent measurement
MODEL_PX = 0.1  # what flow does not measure, standard deviation a frame
DEGREES_OF_FREEDOM = 4.0  # of Student's t, for the robust weights
ITERATIONS = 3
# Standard deviations of what is not foreseen from one frame to the next.
ACTIVATION_STEP = 0.05
MODE_STEP = 1e-5  # metres, root mean square over the skin, a natural mode
POSE_STEP = np.array([0.02] * 3 + [0.005] * 3)  # rad, metres
CONTROL_COST = 0.1  # of activations, against the mean that forces of one activation do


@dataclass(frozen=True)
class ReducedFace:
    """A person's skin in R coordinates of unit mass that do not act on each other."""

    squared: Floats  # R, (rad/s)^2
    damping: Floats  # R, 1/s
    loads: Floats  # R x L, forces of the muscles and 3 motions of the jaw at value 1
    shapes: Floats  # R x V x 3, metres of the whole head's control vertices
    samples: Floats  # P x 3, metres at rest
    normals: Floats  # P x 3
    moved: Floats  # P x 3 x R, the samples' motion

    @classmethod
    def of(cls, skin: LoadedSkin, num_modes: int = NUM_MODES) -> ReducedFace:
        options = dynamics_options()
        reduced_skin = skin.reduced(options, num_modes)
        shapes = np.asarray(reduced_skin.shapes)
        stiffness = (2 * np.pi * np.asarray(reduced_skin.frequencies)) ** 2
        mesh, free = skin.mesh, skin.skin.free
        responses = np.zeros((shapes.shape[1], len(free), 3))
        responses[:, free] = shapes.T.reshape(shapes.shape[1], -1, 3)
        template = mesh.template
        measured_share = (~template.in_region(*UNMEASURED))[: len(free)].astype(np.float64)
        frontal = mesh.seen_from_front
        frontal = frontal[multiply(mesh.stencils, measured_share)[frontal] > 0.99]
        frontal = frontal[:: max(1, round(len(frontal) / MOST_SAMPLES))]
        motion = multiply(skin.stencils_of(frontal), responses[:, free].transpose(1, 2, 0))
        return cls(
            stiffness,
            options.mass_damping + options.stiffness_damping * stiffness,
            shapes.T @ skin.loads,
            skin.skin.spread(responses),
            mesh.vertices[frontal],
            mesh.normals[frontal],
            motion,
        )


class Observer:
    """State (coordinates, their rates); P is its covariance, pose_cov that of the head's pose."""

    def __init__(self, face: ReducedFace, pose: Floats, step: float) -> None:
        self.face, self.pose = face, pose.copy()
        count = len(face.squared)
        self.state = np.zeros(2 * count)
        self.cov = 1e-10 * np.eye(2 * count)
        self.pose_cov = np.diag(np.square([1e-3] * 3 + [1e-3] * 3))
        self.control = np.zeros(face.loads.shape[1])
        self.control_std = np.zeros(face.loads.shape[1])
        self.step = step
        jaw = [ARTICULATORS[name] for name in JAW]
        muscles = face.loads.shape[1] - len(jaw)
        self.limits = np.array([*[(0.0, 1.0)] * muscles, *jaw]).T
        self.transition, self.input = _discrete(face.squared, face.damping, step)
        weight = 1 / face.squared
        normal = face.loads.T @ (weight[:, None] * face.loads)
        normal += CONTROL_COST * np.trace(normal) / len(normal) * np.eye(len(normal))
        self.tracking = np.linalg.solve(normal, face.loads.T * weight)
        self.noise = self._process_noise()

    def _process_noise(self) -> Floats:
        """Of the state, from forces that change between frames."""
        face = self.face
        size = np.sqrt((face.moved**2).mean((0, 1)) * 3)
        forces = ACTIVATION_STEP * face.loads
        unforeseen = forces @ forces.T + np.diag((MODE_STEP / size * face.squared) ** 2)
        return self.input @ unforeseen @ self.input.T

    def advance(
        self, previous: NDArray[np.uint8], image: NDArray[np.uint8], camera: Floats
    ) -> None:
        """From one grey frame to the next; camera: 3 x 3."""
        count = len(self.face.squared)
        forces = self.face.loads @ self.control
        prediction = self.transition @ self.state + self.input @ forces
        # How far each coordinate goes from frame to frame is measured, together with the pose.
        change = self.transition[:count] - np.eye(count, 2 * count)
        cov = self.transition @ self.cov @ self.transition.T + self.noise
        change_cov = change @ self.cov @ change.T + self.noise[:count, :count]
        cross = self.transition @ self.cov @ change.T + self.noise[:, :count]
        prior = np.zeros((count + 6, count + 6))
        prior[:count, :count] = change_cov + 1e-16 * np.trace(change_cov) * np.eye(count)
        prior[count:, count:] = np.diag(POSE_STEP**2)
        mean = np.concatenate([prediction[:count] - self.state[:count], np.zeros(6)])
        estimate, found_cov = self._measured(previous, image, camera, mean, prior)
        gain = np.linalg.solve(prior[:count, :count], cross.T).T
        old = self.state
        self.state = prediction + gain @ (estimate - mean)[:count]
        self.cov = cov - gain @ (prior - found_cov)[:count, :count] @ gain.T
        self.cov = (self.cov + self.cov.T) / 2
        self.pose[:3, :3] = (
            from_rotation_vectors(estimate[None, count : count + 3])[0] @ self.pose[:3, :3]
        )
        self.pose[:3, 3] += estimate[count + 3 :]
        self.pose_cov = self.pose_cov + found_cov[count:, count:]
        self._steer(old)

    def _steer(self, old: Floats) -> None:
        """Controls whose forces carry the corrected motion."""
        face = self.face
        count = len(face.squared)
        place, rate = self.state[:count], self.state[count:]
        acceleration = (rate - old[count:]) / self.step
        control = self.tracking @ (face.squared * place + face.damping * rate + acceleration)
        self.control = np.clip(control, *self.limits)
        forces = np.hstack([np.diag(face.squared), np.diag(face.damping)])
        spread = self.tracking @ forces
        variance = np.einsum("ls,st,lt->l", spread, self.cov, spread)
        self.control_std = np.sqrt(np.maximum(variance, 0))

    def _measured(
        self,
        previous: NDArray[np.uint8],
        image: NDArray[np.uint8],
        camera: Floats,
        mean: Floats,
        prior: Floats,
    ) -> tuple[Floats, Floats]:
        """The step of coordinates and pose, and its covariance, under the prior and the flow."""
        face, count = self.face, len(self.face.squared)
        surface = face.samples + face.moved @ self.state[:count]
        before, pixels = self._seen(surface, camera)
        height, width = image.shape
        inside = (pixels > 1).all(1) & (pixels[:, 0] < width - 2) & (pixels[:, 1] < height - 2)
        at = before / np.linalg.norm(before, axis=1, keepdims=True)
        facing = -np.einsum("pi,pi->p", face.normals @ self.pose[:3, :3].T, at)
        is_used = inside & (facing > LEAST_COSINE)
        options = _core.FlowOptions()
        options.method = _core.FlowMethod.probabilistic
        field = _core.compute_flow(previous, image, options)
        pixels = pixels[is_used]
        flow = sampled(np.asarray(field.flow), pixels)
        xx, xy, yy = np.moveaxis(sampled(np.asarray(field.covariance), pixels), 1, 0)
        noise = np.stack([np.stack([xx, xy], 1), np.stack([xy, yy], 1)], 1) + MODEL_PX**2 * np.eye(
            2
        )
        hull = np.ptp(pixels, axis=0).prod() * np.pi / 4 if len(pixels) else 1.0
        share = min(1.0, hull / WINDOW_PX / max(len(pixels), 1))
        inverse = share * np.linalg.inv(noise)
        slopes = self._slopes(before[is_used], surface[is_used], face.moved[is_used], camera)
        information = np.linalg.inv(prior)
        estimate = mean.copy()
        for _ in range(ITERATIONS):
            off = flow - (self._moved_pixels(surface[is_used], is_used, estimate, camera) - pixels)
            distance = np.einsum("pi,pij,pj->p", off, inverse, off) / share
            weight = (DEGREES_OF_FREEDOM + 2) / (DEGREES_OF_FREEDOM + distance)
            weighted_slopes = np.einsum("pij,pjk->pik", weight[:, None, None] * inverse, slopes)
            flow_information = np.tensordot(slopes, weighted_slopes, axes=((0, 1), (0, 1)))
            pull = np.einsum("pik,pi->k", weighted_slopes, off) - information @ (estimate - mean)
            estimate = estimate + np.linalg.solve(information + flow_information, pull)
        return estimate, np.linalg.inv(information + flow_information)

    def _seen(self, surface: Floats, camera: Floats) -> tuple[Floats, Floats]:
        """Places in the camera (P,3), pixels (P,2)."""
        points = surface @ self.pose[:3, :3].T + self.pose[:3, 3]
        pixels = points @ camera.T
        return points, pixels[:, :2] / pixels[:, 2:]

    def _moved_pixels(
        self, surface: Floats, is_used: NDArray, step: Floats, camera: Floats
    ) -> Floats:
        count = len(self.face.squared)
        points = surface + self.face.moved[is_used] @ step[:count]
        rotation = from_rotation_vectors(step[None, count : count + 3])[0] @ self.pose[:3, :3]
        pixels = (points @ rotation.T + self.pose[:3, 3] + step[count + 3 :]) @ camera.T
        return pixels[:, :2] / pixels[:, 2:]

    def _slopes(self, points: Floats, surface: Floats, motion: Floats, camera: Floats) -> Floats:
        """Pixels (P,2,R+6) a unit of coordinates and pose."""
        x, y, z = points.T
        projection = np.zeros((len(points), 2, 3))
        projection[:, 0, 0], projection[:, 0, 2] = camera[0, 0] / z, -camera[0, 0] * x / z**2
        projection[:, 1, 1], projection[:, 1, 2] = camera[1, 1] / z, -camera[1, 1] * y / z**2
        offsets = surface @ self.pose[:3, :3].T
        turning = np.cross(np.eye(3), offsets[:, None]).transpose(0, 2, 1)
        by_coordinates = (projection @ self.pose[:3, :3]) @ motion
        return np.concatenate([by_coordinates, projection @ turning, projection], axis=2)


def _discrete(stiffness: Floats, damping: Floats, step: float) -> tuple[Floats, Floats]:
    """Transition (2R,2R) and input (2R,R) of q'' + d q' + w^2 q = f, the force held for a step."""
    root = np.sqrt((damping**2 - 4 * stiffness).astype(complex) + 1e-9)
    slow, fast = (-damping + root) / 2, (-damping - root) / 2
    a, b = np.exp(slow * step), np.exp(fast * step)
    place = np.stack([slow * b - fast * a, a - b]) / (slow - fast)
    rate = np.stack([slow * fast * (b - a), slow * a - fast * b]) / (slow - fast)
    transition = np.block([[np.diag(row.real) for row in part] for part in (place, rate)])
    gains = np.concatenate([(1 - place[0].real) / stiffness, -rate[0].real / stiffness])
    count = len(stiffness)
    return transition, np.vstack([np.diag(gains[:count]), np.diag(gains[count:])])


@dataclass
class _Followed(Rows):
    place: list[Floats] = field(default_factory=list)
    control: list[Floats] = field(default_factory=list)
    control_std: list[Floats] = field(default_factory=list)

    def add(self, frame: int, observer: Observer) -> None:
        self.frame.append(frame)
        self.pose.append(observer.pose.copy())
        self.pose_cov.append(observer.pose_cov)
        self.quality.append(1.0)
        self.place.append(observer.state[: len(observer.face.squared)])
        self.control.append(observer.control)
        self.control_std.append(observer.control_std)


def capture_by_loop(
    path: str | os.PathLike[str],
    frames: FrameRange | None = None,
    fit: FaceFit | None = None,
    progress: Progress | None = None,
    summary: CaptureSummary | None = None,
) -> Performance:
    """Frames of a clip by the paper's loop, from the fit's frame both ways: as `pipeline.capture`.

    The activations are the controls, which stay within 0 and 1 (unbounded, antagonists run off
    against each other on what a flow cannot tell apart); what the skin does beyond their static
    answer is kept as detail. Nothing tells a frame that is lost. Raises NoFace, UnreadableMedia,
    InvalidInput.
    """
    summary = summary if summary is not None else CaptureSummary()
    footage = Footage(path)
    first, last = check_range(frames, footage)
    finding, attaching, following = stages(
        progress, 0.0 if fit else SEARCHED, ATTACHED, 1 + last - first
    )
    fit = fit_for(footage, (first, last), fit, finding, summary)
    attaching(0.0, "attaching the muscles")
    start_time = time.perf_counter()
    template = load_template()
    skin = load_skin(fit.neutral_vertices(template), template, calibration=fit.calibration)
    face = ReducedFace.of(skin)
    summary.add("attach the muscles", time.perf_counter() - start_time)
    start_time = time.perf_counter()
    walk = ClipWalk(footage, fit, (first, last), following, summary, "face")
    previous = _grey(footage.read(fit.frame))

    def observer() -> Observer:
        pose = np.asarray(fit.head_pose, np.float64)
        return Observer(face, pose, 1 / float(footage.fps))

    start, back, forward = _Followed(), _Followed(), _Followed()
    start.add(fit.frame, observer())
    if fit.frame > first:
        back = _along(walk, first, observer(), previous)
    if fit.frame < last:
        forward = _along(walk, last, observer(), previous)
    rows = (back.reversed() + start + forward).within(first, last)
    walk.check_any_done(rows)
    summary.add("follow the face", time.perf_counter() - start_time)
    return _performance(rows, face, modes_of(skin.skin), fit, footage, template)


def _along(walk: ClipWalk, end: int, observer: Observer, previous: NDArray[np.uint8]) -> _Followed:
    """Away from the fit's frame (`previous`, grey) to `end`, or less when the user stops."""
    rows = _Followed()
    for frame, image in walk.images(end):
        grey = _grey(image)
        observer.advance(previous, grey, np.asarray(walk.fit.intrinsics))
        rows.add(frame, observer)
        previous = grey
    return rows


def _grey(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.round(image @ GREY).astype(np.uint8)


def _performance(
    rows: _Followed,
    face: ReducedFace,
    anatomy: Anatomy,
    fit: FaceFit,
    footage: Footage,
    template: FaceTemplate,
) -> Performance:
    controls = np.array(rows.control)
    names = list(anatomy.articulator_names)
    jaw = [names.index(name) for name in JAW]
    values = np.zeros((len(rows.frame), len(names)))
    muscles = len(anatomy.muscle_names)
    values[:, jaw] = controls[:, muscles:]
    static = controls @ (face.loads / face.squared[:, None]).T
    return clip_performance(
        *(rows, footage, fit, template, anatomy),
        activations=controls[:, :muscles],
        activations_std=np.array(rows.control_std)[:, :muscles],
        articulator_values=values,
        detail_modes=face.shapes,
        detail_coefficients=np.array(rows.place) - static,
    )
