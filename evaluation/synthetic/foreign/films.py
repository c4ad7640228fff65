# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws films of this family, shows them at both sizes, and keeps them while their inputs stand."""

from __future__ import annotations

import hashlib
import os
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.score.truth import Truth
from numpy.typing import NDArray

from .. import footage, surface_points
from ..clips import BPY_VERSION, CannotRender, Clip, blender_python, cache_folder
from ..heads.films import _aside
from ..motion import control_values
from ..recipes import Recipe
from ..scene import FACE_WIDTH
from ..texture import Look, SkinPainter, eye_albedo, positions_by_texel
from .head_mesh import EYE_RADIUS, PARTS, HeadMesh, person
from .recipes import FPS, LIGHTS, NUM_FRAMES, SIZES, Film
from .shapes import NAMES, shapes

DRAWN_SIZE = "640x480"
NUM_POINTS = 500
BESIDE = ("footage", "motion", "noise", "render_frames", "surface_points", "texture")
TEXEL_STEP = 2  # half the texture's size is finer than the picture still
LIGHT_SWING = 0.1  # relative change of all lamps


def film_clips(film: Film, report: Callable[[str], None]) -> dict[str, Clip]:
    """The clip of a film at every size, drawn unless the cache has them."""
    folder = cache_folder() / f"{film.name}-{_key(film)}"
    names = {size: film.recipe(size).name for size in SIZES}
    if not folder.exists():
        report(f"{film.name}: drawing {NUM_FRAMES} frames")
        head = person(film.seed)
        vertices, values = _motion(film, head)
        poses, intrinsics = _camera(film, DRAWN_SIZE)
        with _aside(folder) as whole, tempfile.TemporaryDirectory() as made:
            _draw(film, head, vertices, poses, intrinsics, Path(made))
            frames = np.load(Path(made) / "frames.npy")
            for size, name in names.items():
                recipe = film.recipe(size)
                shown = frames if size == DRAWN_SIZE else _halved(frames)
                footage.encode(footage.filmed(shown, recipe), whole / f"{name}.mp4", recipe)
                truth = _truth(film, recipe, head, values, Path(made))
                truth.save(whole / f"{name}.truth.npz")
    return {
        size: Clip(name, folder / f"{name}.mp4", folder / f"{name}.truth.npz")
        for size, name in names.items()
    }


def _motion(film: Film, head: HeadMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vertices (N,V,3) of every frame and the values (N,E) of the expressions."""
    times = np.arange(NUM_FRAMES) / FPS
    values = control_values(film.phases(), list(NAMES), times)
    return head.vertices + np.tensordot(values, shapes(head, film.seed), axes=1), values


def _camera(film: Film, size: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """camera_from_head N x 4 x 4, and the intrinsics at a size."""
    width, height = SIZES[size]
    focal = film.focal_ratio * width
    recipe = film.recipe(size)
    distance = focal * FACE_WIDTH / recipe.face_width_px
    poses = film.poses(np.arange(NUM_FRAMES) / FPS, distance)
    across, down = width * np.array(film.camera_error)
    middle = ((width - 1) / 2 + across, (height - 1) / 2 + down)
    return poses, np.array([[focal, 0, middle[0]], [0, focal, middle[1]], [0, 0, 1.0]])


def _draw(
    film: Film, head: HeadMesh, vertices: NDArray, poses: NDArray, intrinsics: NDArray, out: Path
) -> None:
    rng = np.random.default_rng([film.seed, 76])
    swing = LIGHT_SWING * np.sin(2 * np.pi * 0.4 * np.arange(NUM_FRAMES) / FPS + rng.uniform(0, 6))
    lamps = [(*lamp.toward, lamp.strength, lamp.width_degrees) for lamp in LIGHTS[film.light]]
    neck = ((-0.06, -0.035, 0.052, 0.055), (-0.1, -0.04, 0.055, 0.058), (-0.14, -0.045, 0.07, 0.07))
    shoulders = ((-0.16, -0.05, 0.15, 0.085), (-0.2, -0.05, 0.22, 0.1), (-0.7, -0.05, 0.24, 0.13))
    np.savez(
        out / "scene.npz",
        vertices=vertices.astype(np.float32),
        neutral=head.vertices,
        faces=head.triangles,
        part=head.part,
        part_names=np.array(PARTS),
        uv=head.uv(),
        head_pose=poses,
        intrinsics=intrinsics,
        image_size=np.array(SIZES[DRAWN_SIZE]),
        light=np.column_stack([np.zeros((NUM_FRAMES, 3)), 1 + swing]),
        body_color=rng.uniform(0.05, 0.5, 3),
        body_rings=np.array(neck + shoulders),
        lamps=np.array(lamps),
        gloss=np.array([film.gloss, film.roughness]),
    )
    np.savez(out / "textures.npz", **_paint(film, head))
    script = Path(__file__).resolve().parent / "draw_head.py"
    command = [blender_python(), script, out / "scene.npz", out / "textures.npz", out]
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1"},
    )
    if done.returncode != 0:
        raise CannotRender(f"Blender could not draw {film.name}:\n{done.stderr[-1000:]}")


def _paint(film: Film, head: HeadMesh) -> dict[str, NDArray[np.float32]]:
    """Textures by part (S,S,3), linear light; row 0 is v = 0."""
    painter = SkinPainter(Look.random(film.seed), head.landmarks())
    uv, textures = head.uv(), {}
    for name in ("skin", "scalp", "eye.L", "eye.R"):
        chosen = head.part == PARTS.index(name)
        of_part = uv[chosen]
        low, high = of_part.reshape(-1, 2).min(0), of_part.reshape(-1, 2).max(0)
        corners, stretched = head.vertices[head.triangles[chosen]], (of_part - low) / (high - low)
        for _ in range(2):
            corners, stretched = _split(corners), _split(stretched)
        order = np.arange(3 * len(corners)).reshape(-1, 3)[:, [0, 1, 2, 2]]
        points = positions_by_texel(corners.reshape(-1, 3), order, stretched[:, [0, 1, 2, 2]])
        points = points[::TEXEL_STEP, ::TEXEL_STEP]
        covered = ~np.isnan(points[..., 0])
        image = np.zeros((*covered.shape, 3), np.float32)
        if name.startswith("eye"):
            center, radius = head.eye_centers[name[-1]], EYE_RADIUS
            image[covered] = eye_albedo(points[covered], center, radius, film.seed)
        else:
            image[covered] = painter.albedo(points[covered])
        textures[name] = image
    return textures


def _split(corners: NDArray) -> NDArray[np.float64]:
    """Every triangle (F,3,D) in four."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _halved(frames: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """RGBA frames at half the size; the colour is not multiplied by the cover."""
    rows, cols = frames.shape[1] // 2, frames.shape[2] // 2
    halved = np.empty((len(frames), rows, cols, 4), np.uint8)
    for small, frame in zip(halved, frames, strict=True):
        four = frame.reshape(rows, 2, cols, 2, 4).astype(np.float32)
        cover = four[..., 3:].sum((1, 3))
        color = (four[..., :3] * four[..., 3:]).sum((1, 3)) / np.maximum(cover, 1)
        small[:] = np.round(np.concatenate([color, cover / 4], axis=2))
    return halved


def _truth(film: Film, recipe: Recipe, head: HeadMesh, values: NDArray, made: Path) -> Truth:
    surface = np.load(made / "surface.npy").astype(np.float64)
    quads, part = np.load(made / "quads.npy"), np.load(made / "quad_part.npy")
    rest, surface = surface[0], surface[1:]
    poses, drawn_intrinsics = _camera(film, DRAWN_SIZE)
    bald = SkinPainter(Look.random(film.seed), head.landmarks()).hairiness(rest[quads].mean(1))
    allowed = (part == PARTS.index("skin")) & (bald < 0.05)
    points = surface_points.choose(
        surface[0], quads, allowed, poses[0], drawn_intrinsics, NUM_POINTS, film.seed
    )
    positions = np.stack([points.positions(some) for some in surface])
    _, intrinsics = _camera(film, recipe.name.removeprefix(f"{film.name}-"))
    placed = [surface_points.in_camera(at, p) for at, p in zip(positions, poses, strict=True)]
    seen = [
        surface_points.visible(points, some, quads, pose, drawn_intrinsics)
        for some, pose in zip(surface, poses, strict=True)
    ]
    return Truth(
        frame=np.arange(1, len(surface) + 1),
        fps=FPS,
        image_size=np.array(recipe.image_size),
        intrinsics=intrinsics,
        head_pose=poses,
        points=positions,
        tracks=np.stack([surface_points.project(at, intrinsics) for at in placed]),
        visible=np.stack(seen),
        neutral_points=points.positions(rest),
        points_face=points.corners,
        points_bary=points.weights,
        units=list(NAMES),
        unit_values=values,
        expressions=list(film.expressions),
        expression_frames=np.array(film.spans()),
    )


def _key(film: Film) -> str:
    """Hash of all that a film is made of."""
    digest = hashlib.sha256(f"{film!r} {BPY_VERSION} {NUM_POINTS}".encode())
    here = Path(__file__).resolve().parent
    for source in (*sorted(here.glob("*.py")), *(here.parent / f"{name}.py" for name in BESIDE)):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
