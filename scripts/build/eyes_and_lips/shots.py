# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws everybody once and keeps pictures and places in the cache, a file a person."""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from evaluation.synthetic.clips import CannotRender, blender_python, cache_folder

from . import looks, people

FIRST_SEED = 3000  # nobody else has people of such seeds
HERE = Path(__file__).resolve().parent
PLACES = ("lids", "irises", "lips")


def drawn_people(count: int, jobs: int, cache: Path, report: Callable[[str], None]) -> list[Path]:
    """One .npz a person, drawn unless the cache has it.

    frames N x H x W x 4 uint8, lids N x 2 x 2 x 9 x 2, irises N x 2 x 5 x 2, lips N x 4 x 11 x 2 in
    pixels, head_pose N x 4 x 4, intrinsics 3 x 3, anchors 8 x 3. Raises CannotRender.
    """
    folder = cache / f"people-{count}-{_key()}"
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{seed}.npz" for seed in range(FIRST_SEED, FIRST_SEED + count)]
    missing = [path for path in paths if not path.exists()]
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        for number, _ in enumerate(pool.imap_unordered(draw, missing), 1):
            if number % 20 == 0:
                report(f"{number} of {len(missing)} people drawn")
    return paths


def draw(path: Path) -> None:
    """The person whose seed is the file's name, into that file. Raises CannotRender."""
    template = load_template()
    recipe = people.recipe_of(int(path.stem))
    neutral = people.neutral_of(recipe, template)
    who = people.person(recipe, template, neutral)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".person.") as aside:
        drawing = Path(aside)
        scene = {"lamps": who.lamps, "ambient": who.ambient, "gloss": who.gloss}
        scene["teeth"] = who.teeth
        np.savez(drawing / "scene.npz", **vars(who.scene), **scene)
        np.savez(drawing / "textures.npz", **looks.textures(recipe, template, neutral))
        words = [blender_python(), HERE / "draw_people.py", drawing / "scene.npz"]
        words += [drawing / "textures.npz", drawing]
        environment = os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1"}
        done = subprocess.run(
            [str(word) for word in words],
            capture_output=True,
            text=True,
            check=False,
            env=environment,
        )
        if done.returncode != 0:
            raise CannotRender(f"Blender could not draw {path.stem}:\n{done.stderr[-1000:]}")
        np.savez_compressed(
            drawing / path.name,
            frames=np.load(drawing / "frames.npy"),
            head_pose=who.scene.head_pose,
            intrinsics=who.scene.intrinsics,
            anchors=who.anchors,
            **{name: getattr(who, name).astype(np.float32) for name in PLACES},
        )
        (drawing / path.name).replace(path)


def _key() -> str:
    digest = hashlib.sha256()
    synthetic = HERE.parents[2] / "evaluation" / "synthetic"
    drawn_by = [HERE / f"{name}.py" for name in ("people", "looks", "draw_people")]
    drawn_by += [
        synthetic / f"{name}.py"
        for name in ("scene", "person", "texture", "noise", "render_frames")
    ]
    for source in (*drawn_by, data_folder() / "face.npz"):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def main(count: str) -> None:
    """usage: python -m scripts.build.eyes_and_lips.shots PEOPLE: draws them, prints the folder."""
    cache = cache_folder().parent / "eyes_and_lips"
    paths = drawn_people(
        int(count), os.cpu_count() or 1, cache, lambda line: print(line, file=sys.stderr)
    )
    print(paths[0].parent)


if __name__ == "__main__":
    main(*sys.argv[1:])
