# SPDX-License-Identifier: GPL-3.0-or-later
"""Every reader of files: what it is tried on, and what is done with a file that it takes.

A file that is taken must then serve: what a performance, a fit or a mesh is read for is done.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from random import Random

import mimetic.commands.info  # noqa: F401 - what `cli` would import in every process anew
import numpy as np
from mimetic import InvalidInput
from mimetic.character import placement, shapes
from mimetic.character.foreign_mesh import read_skin
from mimetic.character.landmarks_file import read_landmarks
from mimetic.commands import cli
from mimetic.commands.points import read_points, track_points
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import landmark_places, refit
from mimetic.head.smoothing import smoothed
from mimetic.library.composing import Placing, compose
from mimetic.library.expression import Expression
from mimetic.library.preview import expression_picture
from mimetic.locate import eigenspaces
from mimetic.locate import landmarks as cascade_file
from mimetic.media.footage import Footage
from mimetic.media.timing import frame_steps, scene_frames, scene_rate
from mimetic.performance.document import Performance
from mimetic.puppet.mapping import Mapping
from mimetic.puppet.matching import still_matcher
from mimetic.puppet.separability import separability
from mimetic.puppet.templates import TaughtSet
from mimetic.report.plots import head_angles
from mimetic.retarget.controls import load_preset, save_preset
from mimetic.retarget.face_csv import read_face_csv
from mimetic.score.score import score
from mimetic.score.tables import as_json, as_text
from mimetic.score.truth import Truth
from mimetic.shared.shown_text import shown
from mimetic.template.face_template import load_template

from evaluation.anatomy.mesh_file import read_mesh
from evaluation.runs.stills import Stills
from fuzz import batch_files, samples
from fuzz.changed_bytes import change_bytes
from fuzz.samples import Sample

MOST_FRAMES = 20  # of footage, of a few KB
NAMES = (
    "-i",
    "--help",
    "file:x.mp4",
    "http://127.0.0.1/x",
    "concat:a|b",
    "%d.mp4",
    "a\nb",
    "\x1b[2J",
)
NAMES += (
    "é" * 200,
    "x" * 300,
    "a\0b",
    "\udcff\udcfe.mp4",
    " ",
    "'; ls",
    "*",
    "\u202egpj.mp4",
    "x" * 250,
)


class Broken(Exception):
    """A reader that took a file and then did not keep what it had promised."""


@dataclass(frozen=True)
class Reader:
    samples: Callable[[], Iterable[Sample]]
    read: Callable[[Path], None]
    changed_name: bool = False  # the name of the file is changed, not what is in it


def _read_performance(path: Path) -> None:
    """By the command line, and on to what `points`, `bake` and the report make of it."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        status = cli.main(["info", str(path)])
    text = output.getvalue()
    if status == cli.BAD_INPUT and text.count("\n") == 1 and text.startswith("mimetic: "):
        raise InvalidInput(text)
    if status != 0 or any(shown(line) != line for line in text.split("\n")):
        raise Broken(f"mimetic info ended with {status} and said {text[:400]!r}")
    performance = Performance.load(path)
    performance.project(performance.surface_in_camera(performance.num_frames - 1))
    head_angles(performance)
    shapes.shapes_of(performance), shapes.groups_of(performance)
    placement.head_motion(performance)
    rate = scene_rate(performance.fps)
    _either(lambda: placement.lens(performance.intrinsics, performance.image_size))
    _either(lambda: scene_frames(performance.frame, performance.fps, rate.fps / rate.fps_base))
    _either(lambda: smoothed(performance))
    middle = performance.image_size / 2
    _either(lambda: track_points(performance, np.array([middle, middle + 3.5])))
    _either(lambda: frame_steps(performance.frame, performance.fps, 24.0))
    again = path.with_suffix(".again")
    performance.save(again)
    if Performance.load(again).frame.tolist() != performance.frame.tolist():
        raise Broken("what was saved again is not what was read")


def _either(use: Callable[[], object]) -> None:
    """Done, or refused in words."""
    with contextlib.suppress(InvalidInput):
        use()


def _read_truth(path: Path) -> None:
    truth = Truth.load(path)

    def scored() -> None:
        result = score(truth, samples.performance())
        as_text(result), as_json([result])

    _either(scored)


def _read_taught_set(path: Path) -> None:
    taught = TaughtSet.load(path)

    def driven() -> None:
        parts = taught.template_parts
        matcher = still_matcher(taught.pictures, taught.template_boxes, parts)
        scores = matcher.match(np.zeros((120, 160), np.uint8))[0]
        values = Mapping(taught).state(scores).values
        if not np.isfinite(values).all():
            raise Broken("scores of an empty picture have no state")

    _either(driven)
    separability(taught)


def _read_expression(path: Path) -> None:
    expression = Expression.load(path)
    person = samples.performance()
    placings = [Placing("one", 0.5), Placing("other", 0.5, 0.8, 2.0)]
    sides = {"one": expression, "other": expression.mirrored()}
    _either(lambda: compose(placings, sides.__getitem__, person, seconds=1.0))
    expression_picture(expression, person)
    again = path.with_suffix(".again")
    expression.save(again)
    if Expression.load(again).channels != expression.channels:
        raise Broken("what was saved again is not what was read")


def _read_fit(path: Path) -> None:
    fit = FaceFit.load(path)
    again = path.with_suffix(".again")
    fit.save(again)
    if FaceFit.load(again).frame != fit.frame:
        raise Broken("what was saved again is not what was read")
    _either(lambda: fit.camera)
    _either(fit.head_place)
    _either(lambda: fit.neutral_vertices(load_template()))
    _either(lambda: landmark_places(fit))
    _either(lambda: refit(fit, {"chin": (160.0, 200.0)}))
    _either(fit.calibration.described)


def _read_landmarks(path: Path) -> None:
    template = load_template()
    landmarks = read_landmarks(path)
    skin = template.num_skin_vertices
    _either(lambda: read_skin(template.vertices[:skin], template.skin_faces, landmarks, template))


def _read_face_csv(path: Path) -> None:
    table = read_face_csv(path, 30.0)
    if not (np.isfinite(table.values).all() and np.isfinite(table.seconds).all()):
        raise Broken("a table with a number that is not finite")
    if table.values.shape != (len(table.seconds), len(table.names)):
        raise Broken("a table without a value for each name and frame")


def _read_preset(path: Path) -> None:
    rows = load_preset(path)
    again = path.with_suffix(".again")
    save_preset(rows, again)
    if load_preset(again) != rows:
        raise Broken("what was saved again is not what was read")


def _read_points(path: Path) -> None:
    track_points(samples.performance(), read_points(path))


def _read_mesh(path: Path) -> None:
    vertices, faces = read_mesh(path)
    if not np.isfinite(vertices).all() or faces.max() >= len(vertices) or faces[:, :3].min() < 0:
        raise Broken("a face without its vertices, or a vertex nowhere")


def _read_model(path: Path) -> None:
    load = {".face.npz": load_template, f".{eigenspaces.FILE_NAME}": eigenspaces.load}
    next((read for end, read in load.items() if path.name.endswith(end)), cascade_file.load)(path)


def _read_stills(path: Path) -> None:
    Stills.load(path)


def _read_footage(path: Path) -> None:
    footage = Footage(path)
    if not footage.fps > 0 or footage.num_frames < 1:
        raise Broken(f"{footage.num_frames} frames at {footage.fps} a second")
    for frame, image in footage.frames(1, MOST_FRAMES):
        if image.shape != (footage.size[1], footage.size[0], 3):
            raise Broken(f"frame {frame} is of the shape {image.shape}")


READERS = {
    "performance": Reader(samples.performances, _read_performance),
    "expression": Reader(samples.expressions, _read_expression),
    "taught-set": Reader(samples.taught_sets, _read_taught_set),
    "truth": Reader(samples.truths, _read_truth),
    "fit": Reader(samples.fits, _read_fit),
    "task": Reader(partial(samples.batch_files, "task"), batch_files.read_task),
    "person": Reader(partial(samples.batch_files, "person"), batch_files.read_person),
    "table": Reader(partial(samples.batch_files, "table"), batch_files.read_table),
    "landmarks": Reader(samples.landmarks, _read_landmarks),
    "face-csv": Reader(samples.face_csvs, _read_face_csv),
    "preset": Reader(samples.presets, _read_preset),
    "points": Reader(samples.points, _read_points),
    "mesh": Reader(samples.meshes, _read_mesh),
    "model": Reader(samples.models, _read_model),
    "stills": Reader(samples.stills, _read_stills),
    "footage": Reader(samples.clips, _read_footage),
    "footage-name": Reader(samples.clips, _read_footage, changed_name=True),
}


def make_case(reader: Reader, made: list[Sample], folder: Path, random: Random) -> Path:
    """Writes a changed sample into the folder, or a sound one under a name of its own."""
    sample = random.choice(made)
    if not reader.changed_name:
        path = folder / f"case{sample.suffix}"
        path.write_bytes(random.choice(sample.changes)(sample.content, random))
        return path
    name = random.choice(NAMES) + random.choice(("", sample.suffix))
    if random.random() < 0.4:
        name = change_bytes(name.encode("utf-8", "surrogateescape"), random).decode(
            "utf-8", "surrogateescape"
        )
    path = folder / name.replace("/", "_")
    with contextlib.suppress(OSError, ValueError):  # there are no files of that name
        path.write_bytes(sample.content)
    return path
