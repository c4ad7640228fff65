# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic fit`: footage in; the fitted head, over its frame, and the canonical picture out."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.commands.footage_argument import add_footage_argument, give_rate
from mimetic.commands.on_clip import (
    add_lens_arguments,
    add_rest_argument,
    lens_of,
    parse_frames,
)
from mimetic.fit.canonical_image import canonical_image
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.report.overlay import CLEAR_WIDTH, HIDDEN_REGIONS
from mimetic.shared.results import prepare_folder, publish, staging
from mimetic.shared.whole_file import whole_file
from mimetic.solve.clip_capture import check_rest, find_face
from mimetic.template.face_template import FaceTemplate, load_template

WRITTEN = ("fit.json", "fit.png", "canonical.png")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_footage_argument(parser, "one face")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the results"
    )
    parser.add_argument(
        "--frames", type=parse_frames, metavar="A:B", help="look for the face between these frames"
    )
    # --frame: as it was called before
    add_rest_argument(parser, "--frame")
    add_lens_arguments(parser)


def run_fit(arguments: argparse.Namespace) -> int:
    """Writes fit.json, fit.png and canonical.png together; bad input raises."""
    give_rate(arguments)
    footage = Footage(arguments.footage)
    check_rest(arguments.rest, footage)
    out = arguments.out
    prepare_folder(out, WRITTEN, footage.path)
    rest, frames, lens = arguments.rest, arguments.frames, lens_of(arguments)
    fit = find_face(arguments.footage, rest, frames, lens=lens)
    image = footage.read(fit.frame)
    with staging(out) as folder:
        fit.save(folder / "fit.json")
        _save(folder / "fit.png", draw_fit(fit, image))
        _save(folder / "canonical.png", canonical_image(fit, image)[0])
        publish(folder, out, is_finished=True)
    for warning in fit.warnings:
        print(f"note: {warning}")
    print(fit.rest_text())
    others = ", ".join(str(view.frame) for view in fit.views[1:])
    beside = f" and, beside it, {others}" if others else ""
    print(f"{out}: {', '.join(WRITTEN)}; frame {fit.frame}{beside}")
    return 0


def draw_fit(
    fit: FaceFit, image: NDArray[np.uint8], template: FaceTemplate | None = None
) -> NDArray[np.uint8]:
    """The head's mesh and landmarks over its frame (H, W, 3), enlarged where that is small."""
    template = template or load_template()
    options = _core.OverlayOptions()
    options.scale = int(np.clip(np.ceil(CLEAR_WIDTH / fit.image_size[0]), 1, 4))
    skin = template.num_skin_vertices
    faces = np.ascontiguousarray(template.skin_faces, dtype=np.int32)
    is_hidden = template.in_region(*HIDDEN_REGIONS)
    landmarks = [v for v in template.landmark_vertices.tolist() if not is_hidden[v]]
    visible_faces = np.ascontiguousarray(faces[~is_hidden[faces].any(axis=1)])
    painter = _core.OverlayPainter(fit.camera, skin, visible_faces, landmarks, options)
    pose = fit.head_pose
    control = fit.neutral_vertices(template)[:skin] @ pose[:3, :3].T + pose[:3, 3]
    mesh = _core.SubdividedMesh(faces, skin, 0)
    points = np.ascontiguousarray(mesh.positions(np.ascontiguousarray(control))[:skin])
    return painter.paint(np.ascontiguousarray(image), points, 1.0, fit.frame)


def _save(path: Path, picture: NDArray[np.uint8]) -> None:
    from matplotlib.image import imsave

    with whole_file(path) as stream:
        imsave(stream, picture, format="png")
