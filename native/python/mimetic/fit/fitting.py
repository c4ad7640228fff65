# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding a face in an image and fitting the head to it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.canonical_image import canonical_image
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.known_lens import cameras_to_try
from mimetic.fit.line_modes import line_modes
from mimetic.fit.network_evidence import is_seen, with_networks
from mimetic.fit.relief_shift import picture_shifts
from mimetic.fit.views import follow_points
from mimetic.locate.eigenspaces import installed_spaces
from mimetic.locate.feature_networks import feature_anchors, occlusion_network
from mimetic.locate.landmarks import BETWEEN_PREFIX, installed_cascade, measured_landmarks
from mimetic.shared.installed_data import data_folder
from mimetic.shared.parallel import both
from mimetic.shared.picture import as_rgb
from mimetic.template.face_template import FaceTemplate, load_template

__all__ = [
    "FaceFit",
    "NoFace",
    "find_face",
    "judge_frame",
    "landmark_places",
    "prepare_models",
    "refit",
]

LARGEST_ERROR = 0.1  # rms of a face that was found, pupil distances; usual are 0.02
LEAST_FOLLOWED = 20  # points, for a view to be of use
SYMMETRY_SIZE = 96  # pixels of the canonical picture that is compared with its mirror image
LEAST_SYMMETRY = 0.12  # below, the head lies beside the face; well-fitted ones have 0.2 to 0.9
LINES = ("lip_line", "jaw")  # sharper in the picture than points on them
LINE_SEARCH = 0.07  # half width, pupil distances


class NoFace(InvalidInput):
    """No face in the image that a head could be fitted to; the text says why."""


def prepare_models(template: FaceTemplate | None = None) -> None:
    """Computes at once what every fit needs and the first would wait for."""
    template = template or load_template()
    both(lambda: face_model(template), lambda: line_modes(template))


def face_likelihood(image: NDArray[np.uint8]) -> float:
    """That of the likeliest face in an image (H, W, 3) RGB, 0 where there is none."""
    return max((face.likelihood for face in _locator().locate(as_rgb(image))), default=0.0)


@dataclass(frozen=True)
class Judged:
    """What is measured in one frame before a head is fitted, to compare a clip's frames."""

    signs: _core.RestSigns
    detail: float
    expression: NDArray[np.float64]  # 6
    cover: _core.Occlusion  # what is before the face
    features: _core.FaceFeatures
    faces: list[_core.FaceFeatures]  # all that are in the frame, the largest first


def judge_frame(image: NDArray[np.uint8], near: tuple[float, float] | None = None) -> Judged | None:
    """Measures the face that `find_face` would take; None where there is no face.

    near: as `find_face` has it
    """
    image = as_rgb(image)
    faces = _locator().locate(image)
    if not faces:
        return None
    face = faces[0 if near is None else _nearest(faces, near)]
    cover = occlusion_network().see(image, _core.occlusion_square(face))
    image = _core.well_lit(image, face)
    signs, detail = _core.rest_signs(image, face), _core.face_detail(image, face)
    return Judged(signs, detail, _core.expression_of(face), cover, face, faces)


def find_face(
    image: NDArray[np.uint8],
    frame: int = 1,
    *,
    template: FaceTemplate | None = None,
    camera: _core.Camera | None = None,
    choice: int = 0,
    near: tuple[float, float] | None = None,
    faces: Sequence[_core.FaceFeatures] | None = None,
) -> FaceFit:
    """Finds a face and fits pose and proportions of the head to it.

    image: (H, W, 3) RGB or (H, W) grey, uint8
    camera: its focal length is kept; without one, that of no known lens, or a longer one if no head
        fits and the face fills the picture
    choice: which face, the largest first
    near: a place (x, y) in pixels; the face nearest to it is taken, whatever `choice` is
    faces: all that are in the image, where they were found before
    Raises NoFace with the reason, InvalidInput for an image that cannot be worked with.
    """
    image = as_rgb(image)
    height, width = image.shape[:2]
    template = template or load_template()
    if faces is None:
        faces = _locator().locate(image)
    if not faces:
        raise NoFace(
            f"no frontal face in frame {frame} ({width} x {height}): choose a frame in which the "
            "face looks at the camera, is lit and at least an eighth of the picture high, "
            "or give a face fit"
        )
    if not 0 <= choice < len(faces):
        raise InvalidInput(
            f"face {choice} was asked for, but frame {frame} shows {len(faces)}: count from 0"
        )
    if near is not None:
        choice = _nearest(faces, near)
    warnings = []
    if len(faces) > 1:
        boxes = "; ".join(
            f"{i}: {f.box[2]:.0f} px wide, its left top at ({f.box[0]:.0f}, {f.box[1]:.0f})"
            for i, f in enumerate(faces)
        )
        warnings.append(f"{len(faces)} faces in frame {frame}, face {choice} is used ({boxes})")
    if camera is not None and (camera.width, camera.height) != (width, height):
        raise InvalidInput(
            f"the camera is for {camera.width} x {camera.height} pixels, "
            f"the image has {width} x {height}"
        )
    face = faces[choice]
    cameras = [camera] if camera else cameras_to_try(None, (width, height), [face])
    fits = (_fitted(image, frame, face, possible, template) for possible in cameras)
    fit = next(filter(None, fits), None)
    if fit is None:
        raise NoFace(
            f"what looks like a face in frame {frame} does not fit a head: choose another frame, "
            "or give a face fit"
        )
    fit.warnings += warnings
    return fit


def _fitted(
    image: NDArray[np.uint8],
    frame: int,
    face: _core.FaceFeatures,
    camera: _core.Camera,
    template: FaceTemplate,
) -> FaceFit | None:
    """The head fitted to a face; None where none fits.

    Landmarks come from a regression that starts from a view of the face. The finder's is mostly
    right; where the halves of the warped face do not match, it was not, or this is no face.
    """
    image = _core.well_lit(image, face)
    views = [view.yaw for view in installed_cascade().views]
    for yaw in sorted(views, key=lambda yaw: abs(yaw - face.yaw)):
        try:
            landmarks = measured_landmarks(image, face, yaw)
        except InvalidInput:  # lost: what looks like a face shrank to nothing
            continue
        fit = _fit_from(image, frame, landmarks, camera, template)
        if fit is None:
            continue
        canonical_view = canonical_image(fit, image, size=SYMMETRY_SIZE, template=template)
        if _core.mirror_correlation(*canonical_view) < LEAST_SYMMETRY:
            continue
        anchors = feature_anchors(fit.neutral_vertices(template), template)
        if is_seen(image, fit.camera, fit.head_pose, anchors):
            return fit
    return None


def _fit_from(
    image: NDArray[np.uint8],
    frame: int,
    landmarks: _core.FaceFeatures,
    camera: _core.Camera,
    template: FaceTemplate,
) -> FaceFit | None:
    model = face_model(template)
    estimate = _core.fit_face(model, [_core.FaceView(landmarks)], camera)
    prediction = _expected(model, estimate, camera, landmarks)
    lines = _core.measure_features(image, prediction, LINE_SEARCH, mouth_and_jaw=True)
    features = _core.FaceFeatures(
        landmarks.features,
        [curve for curve in lines.curves if curve.name in LINES],
        landmarks.box,
        landmarks.likelihood,
    )
    features = with_networks(image, features, camera, model, estimate)
    estimate = _core.fit_face(model, [_core.FaceView(features)], camera)
    if not estimate.converged or estimate.rms_ipd > LARGEST_ERROR:
        return None
    view = FittedView(frame, estimate.camera_from_head[0], features)
    return _as_fit(template, camera, estimate, [view], [])


def refit(
    fit: FaceFit,
    pins: Mapping[str, tuple[float, float]],
    frame: int | None = None,
    *,
    template: FaceTemplate | None = None,
) -> FaceFit:
    """The fit solved again with other pins, from the features it keeps; no image is needed.

    pins: landmark -> pixel (x, y), (0, 0) the middle of the first; all that are to hold in `frame`,
    so an empty mapping removes them. `landmark_places` gives the names. frame: one of the fit's
    views, by default the reference. Other frames keep theirs. Raises InvalidInput.
    """
    template = template or load_template()
    frame = fit.frame if frame is None else frame
    if fit.view(frame) is None:
        frames = ", ".join(str(view.frame) for view in fit.views) or "none"
        raise InvalidInput(
            f"the fit is not of frame {frame} (its frames: {frames}): add it, or fit again"
        )
    model = face_model(template)
    names = [name for name in model.landmark_names if not name.startswith(BETWEEN_PREFIX)]
    if unknown_names := sorted(set(pins) - set(names)):
        raise InvalidInput(
            f"there is no landmark {', '.join(unknown_names)}; there are {', '.join(names)}"
        )
    views = [
        FittedView(
            view.frame,
            view.head_pose,
            view.measured,
            dict(pins if view.frame == frame else view.pins),
        )
        for view in fit.views
    ]
    shifts = picture_shifts(fit, template, [view.head_pose for view in views])
    observations = [view.observed(shift) for view, shift in zip(views, shifts, strict=True)]
    estimate = _core.fit_face(model, observations, fit.camera, start=_estimate_of(fit, template))
    return _solved_again(fit, template, estimate, views)


def join_views(
    fit: FaceFit,
    reference: NDArray[np.uint8],
    others: Sequence[tuple[int, _core.FaceFeatures, NDArray[np.uint8]]],
    *,
    template: FaceTemplate | None = None,
) -> FaceFit:
    """One head for the reference frame and others: pose of each, shape and camera of all.

    reference: the picture of `fit.frame`; others: frame number, features found in it, its picture.
    Views in which too little of the face could be followed are left out. Pins stay.
    """
    template = template or load_template()
    model, shape = face_model(template), face_shape(template)
    values = shape.joined(fit.identity, fit.residual)
    views = [fit.views[0]]
    for frame, features, image in others:
        view = lone_view(frame, image, features, fit.camera, template)
        if view is None:
            continue
        view.motion = follow_points(reference, image, fit, view, template)
        if len(view.motion) >= LEAST_FOLLOWED:
            views.append(view)
    if len(views) == 1:
        return fit
    start = _core.FaceEstimate(
        [view.head_pose for view in views], float(fit.intrinsics[0, 0]), values
    )
    observations = [view.observed() for view in views]
    estimate = _core.fit_face(model, observations, fit.camera, start=start)
    if not estimate.converged:
        return fit
    return _solved_again(fit, template, estimate, views)


def lone_view(
    frame: int,
    image: NDArray[np.uint8],
    features: _core.FaceFeatures,
    camera: _core.Camera,
    template: FaceTemplate,
) -> FittedView | None:
    """A picture by itself: its landmarks, from the features found, and their pose."""
    image = _core.well_lit(image, features)
    landmarks = measured_landmarks(image, features)
    model = face_model(template)
    estimate = _core.fit_face(model, [_core.FaceView(landmarks)], camera)
    landmarks = with_networks(image, landmarks, camera, model, estimate)
    estimate = _core.fit_face(model, [_core.FaceView(landmarks)], camera, start=estimate)
    if not estimate.converged or estimate.rms_ipd > LARGEST_ERROR:
        return None
    return FittedView(frame, estimate.camera_from_head[0], landmarks)


def landmark_places(
    fit: FaceFit, frame: int | None = None, *, template: FaceTemplate | None = None
) -> dict[str, tuple[float, float]]:
    """Where the fitted head's landmarks are in one of its views, pixels: all that can be pinned."""
    template = template or load_template()
    frame = fit.frame if frame is None else frame
    frames = [view.frame for view in fit.views] or [fit.frame]
    if frame not in frames:
        raise InvalidInput(f"the fit is not of frame {frame}")
    number = frames.index(frame)
    estimate = _estimate_of(fit, template)
    projection = _core.project_features(face_model(template), estimate, fit.camera, number)
    (shift,) = picture_shifts(fit, template, [estimate.camera_from_head[number]])
    places = {
        f.name: np.add(f.position, shift.get(f.name, (0.0, 0.0)))
        for f in projection.features
        if not f.name.startswith(BETWEEN_PREFIX)
    }
    return {name: (float(x), float(y)) for name, (x, y) in places.items()}


def _estimate_of(fit: FaceFit, template: FaceTemplate) -> _core.FaceEstimate:
    values = face_shape(template).joined(fit.identity, fit.residual)
    poses = [view.head_pose for view in fit.views] or [fit.head_pose]
    return _core.FaceEstimate(poses, float(fit.intrinsics[0, 0]), values)


def _solved_again(
    fit: FaceFit, template: FaceTemplate, estimate: _core.FaceEstimate, views: list[FittedView]
) -> FaceFit:
    """The fit of a new estimate; what no landmark determines is kept."""
    solved_fit = _as_fit(template, fit.camera, estimate, views, list(fit.warnings))
    names = ("relief", "depth", "depth_std", "lines", "calibration", "rest", "still_cover")
    kept = {name: getattr(fit, name) for name in names}
    return replace(solved_fit, **kept)


def _as_fit(
    template: FaceTemplate,
    camera: _core.Camera,
    estimate: _core.FaceEstimate,
    views: list[FittedView],
    warnings: list[str],
) -> FaceFit:
    identity, residual = face_shape(template).split(estimate.identity)
    focal = estimate.focal
    for view, pose in zip(views, estimate.camera_from_head, strict=True):
        view.head_pose = np.array(pose)
    first = views[0]
    return FaceFit(
        frame=first.frame,
        image_size=(camera.width, camera.height),
        intrinsics=np.array([[focal, 0, camera.cx], [0, focal, camera.cy], [0, 0, 1.0]]),
        head_pose=first.head_pose,
        identity=identity,
        features={
            f.name: (float(f.position[0]), float(f.position[1])) for f in first.measured.features
        },
        error=float(estimate.rms_ipd),
        warnings=warnings,
        residual=residual,
        views=views,
    )


def _expected(
    model: _core.FaceModel,
    estimate: _core.FaceEstimate,
    camera: _core.Camera,
    features: _core.FaceFeatures,
) -> _core.FaceFeatures:
    projection = _core.project_features(model, estimate, camera)
    return _core.FaceFeatures(
        projection.features, projection.curves, features.box, features.likelihood
    )


def _nearest(faces: Sequence[_core.FaceFeatures], near: tuple[float, float]) -> int:
    """Index of the face whose middle is nearest to a place, pixels."""
    return int(np.argmin([math.dist(middle_of(face), near) for face in faces]))


def middle_of(face: _core.FaceFeatures) -> NDArray[np.float64]:
    """The middle (x, y) of a face's box, pixels."""
    return face.box[:2] + face.box[2:] / 2


@lru_cache(maxsize=1)
def _locator() -> _core.FaceLocator:
    return _core.FaceLocator(str(data_folder()), spaces=installed_spaces())
