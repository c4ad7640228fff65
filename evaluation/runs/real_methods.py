# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the capture, MediaPipe and its networks on our crops see the points marked by hand."""

from __future__ import annotations

import contextlib
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, _core
from mimetic.fit.face_model import limit_positions
from mimetic.fit.fitting import find_face
from mimetic.fit.line_fit import with_lines
from mimetic.locate.feature_networks import (
    CONTOUR_POINTS,
    FILES,
    MESH_POINTS,
    eye_regressor,
    feature_places,
)
from mimetic.media.footage import Footage
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.muscles.feature_lines import feature_lines
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import has_gaze, iris_circles
from mimetic.performance.places import RefinedSurface
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.runs.real_labels import POINTS, Labels, footage_of
from evaluation.runs.real_still import crops_of, shrunk
from evaluation.runs.rendered import CHECKOUT

# Lines of the canonical head (`feature_lines`) whose middle is marked, by the labels' names
LINES = {
    **{f"{n}.{s}": f"{n}.{s}" for n in ("lid_upper", "lid_lower") for s in "RL"},
    **{"lip_outer_upper": "lip_upper", "lip_inner_upper": "lip_upper_inner"},
    **{"lip_inner_lower": "lip_lower_inner", "lip_outer_lower": "lip_lower"},
}
# Of MediaPipe's mesh with refined landmarks
REFINED_MESH_POINTS = {
    **MESH_POINTS,
    **{"lid_upper.R": 159, "lid_lower.R": 145, "lid_upper.L": 386, "lid_lower.L": 374},
    **{"iris.R": 468, "iris.L": 473},
}

IRISES = [POINTS.index("iris.L"), POINTS.index("iris.R")]
ON_SKIN = [i for i in range(len(POINTS)) if i not in IRISES]


def by_capture(labels: Labels, performance: Performance) -> NDArray[np.float64]:
    """N x POINTS x 2 on the limit surface; nan in frames that are held."""
    template = load_template()
    surface = RefinedSurface(performance)
    vertices = np.searchsorted(
        surface.used, head_points(template)
    )  # limits of the control vertices come first
    at_rest = iris_fronts(performance.neutral_vertices, template)
    places = np.full((len(labels.frame), len(POINTS), 2), np.nan)
    for row, frame in enumerate(labels.frame):
        i = performance.index_of(int(frame))
        if performance.quality[i] >= HELD_QUALITY:
            places[row, ON_SKIN] = performance.project(surface.in_camera(i)[vertices])
            irises = iris_circles(performance, i)[:, 0] if has_gaze(performance) else at_rest
            pose = performance.head_pose[i]
            places[row, IRISES] = performance.project(irises @ pose[:3, :3].T + pose[:3, 3])
    return places


def by_fit(labels: Labels, footage: Footage) -> NDArray[np.float64]:
    """N x POINTS x 2 of the head fitted to each frame by itself; nan where none fits."""
    return np.stack([fitted_points(footage.read(int(n)), int(n)) for n in labels.frame])


def fitted_points(image: NDArray[np.uint8], frame: int = 1) -> NDArray[np.float64]:
    """POINTS x 2 of the head fitted to one picture (H x W x 3); nan where none fits, or one whose
    skin lies turned over."""
    template = load_template()
    on_limit, skin = limit_positions(template), template.num_skin_vertices
    places = np.full((len(POINTS), 2), np.nan)
    with contextlib.suppress(InvalidInput):
        fit = with_lines(find_face(np.ascontiguousarray(image), frame), (), template)
        head = fit.neutral_vertices(template)
        irises = iris_fronts(head, template)
        head[:skin] = on_limit(head[:skin])
        places[ON_SKIN] = fit.camera.pixels(head[head_points(template)], fit.head_pose)
        places[IRISES] = fit.camera.pixels(irises, fit.head_pose)
    return places


def head_points(template: FaceTemplate) -> list[int]:
    """The canonical head's control vertices at the POINTS that are on skin."""
    return [
        _middle(template, LINES[name]) if name in LINES else template.landmark(name)
        for name in (POINTS[i] for i in ON_SKIN)
    ]


def iris_fronts(vertices: NDArray[np.float64], template: FaceTemplate) -> NDArray[np.float64]:
    """2 x 3, left first: where eyes that look straight ahead have the middles of their irises.

    The eyeballs have no vertex there: the foremost lies 3 mm aside.
    """
    return eye_geometry(vertices, template).fronts()


def _middle(template: FaceTemplate, line: str) -> int:
    """The vertex of a line that is nearest to the landmark of its name, from side to side."""
    x = template.vertices[:, 0]
    middle = x[template.landmark(line)]
    return min(feature_lines(template)[line], key=lambda v: abs(x[v] - middle))


def by_face_mesh(labels: Labels, python: Path) -> NDArray[np.float64]:
    """N x POINTS x 2 of MediaPipe, which is shown the clip as video; nan where it sees no face.

    python: of scripts/face_mesh_env. Raises InvalidInput.
    """
    footage = Footage(footage_of(labels.clip))
    meshes = run_face_mesh(footage, python, int(labels.frame[-1]))
    return meshes[labels.frame - 1][:, [REFINED_MESH_POINTS[name] for name in POINTS]]


def run_face_mesh(footage: Footage, python: Path, last: int | None = None) -> NDArray[np.float64]:
    """N x 478 x 2 pixels of MediaPipe's refined mesh, shown the clip as video up to frame `last`.

    python: of scripts/face_mesh_env. Raises InvalidInput.
    """
    frames = footage.frames(1, last or footage.num_frames)
    return _meshes(python, *footage.size, images=(image for _, image in frames))


def face_meshes_of_stills(images: Sequence[NDArray[np.uint8]], python: Path) -> NDArray[np.float64]:
    """N x 478 x 2 pixels of the same mesh in its mode for stills: each picture by itself."""
    sizes = [side for image in images for side in image.shape[1::-1]]
    return _meshes(python, "--stills", *sizes, images=images)


def _meshes(
    python: Path, *arguments: str | int, images: Iterable[NDArray[np.uint8]]
) -> NDArray[np.float64]:
    """What face_mesh_landmarks.py says of the images that it is fed."""
    script = CHECKOUT / "evaluation" / "real" / "face_mesh_landmarks.py"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.npy"
        command = [str(word) for word in (python, script, out, *arguments)]
        run = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        with run:
            for image in images:
                run.stdin.write(np.ascontiguousarray(image).tobytes())
            run.stdin.close()
            errors = run.stderr.read().decode(errors="replace")
        if run.returncode != 0:
            raise InvalidInput(f"the face mesh failed: {' '.join(errors.split()[-40:])}")
        return np.load(out, allow_pickle=False)


def networks_alone() -> _core.FeatureNetworks:
    """The installed networks without the regressor of lids that they are joined with."""
    return _core.FeatureNetworks(*(str(data_folder() / name) for name in FILES))


def by_networks(
    labels: Labels,
    performance: Performance,
    networks: _core.FeatureNetworks,
    sizes: Sequence[int] = (1,),
) -> NDArray[np.float64]:
    """Sizes x N x POINTS x 2 of the networks for mesh and iris, on crops placed by the captured
    pose; nan in frames that are held. sizes: how many times smaller the picture is made first."""
    crops = [crops_of(performance, labels.frame, times) for times in sizes]
    places = np.full((len(sizes), len(labels.frame), len(POINTS), 2), np.nan)
    for row, image in _followed(labels, performance):
        for i, times in enumerate(sizes):
            points = feature_places(networks, shrunk(image, times), crops[i][row])
            pixels = np.array([points[name] for name in POINTS])
            places[i, row] = (pixels + 0.5) * times - 0.5
    return places


def by_regressor(labels: Labels, performance: Performance) -> NDArray[np.float64]:
    """N x POINTS x 2 of lids and irises by the regressor that was fitted to drawn people, without
    networks, on the same crops; nan of all else and in frames that are held."""
    regressor, crops = eye_regressor(), crops_of(performance, labels.frame)
    places = np.full((len(labels.frame), len(POINTS), 2), np.nan)
    for row, image in _followed(labels, performance):
        for side, crop in zip("LR", crops[row].eyes, strict=True):
            eye = regressor.eye(image, crop, side == "L")
            places[row, POINTS.index(f"iris.{side}")] = eye.iris[0]
            for name, point in CONTOUR_POINTS.items():
                places[row, POINTS.index(f"{name}.{side}")] = eye.contour[point]
    return places


def _followed(labels: Labels, performance: Performance) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Row and picture of the labels' frames that are not held."""
    rows = {int(frame): row for row, frame in enumerate(labels.frame)}
    shots = Footage(footage_of(labels.clip)).frames(int(labels.frame[0]), int(labels.frame[-1]))
    for frame, image in shots:
        if frame in rows and performance.quality[performance.index_of(frame)] >= HELD_QUALITY:
            yield rows[frame], np.ascontiguousarray(image)
