# SPDX-License-Identifier: GPL-3.0-or-later
"""What attaching muscles to a head of any mesh costs by its size, and carried beside solved."""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time
from collections.abc import Sequence

import numpy as np
from mimetic.character import foreign_head
from mimetic.character.carried_skin import CarriedSkin
from mimetic.character.foreign_mesh import REQUIRED, read_skin
from mimetic.character.foreign_registration import lay_template
from mimetic.character.solved_skin import SolvedSkin
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

SIZES = (5_000, 10_000, 20_000, 50_000, 100_000, 200_000)
MOST_COMPARED = 50_000
Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


def person(template: FaceTemplate, size: int) -> Mesh:
    """A head that is no copy of the template, its longest edges halved until it is `size` fine."""
    limits = template.identity_limits[::2]
    values = dict(zip(template.identity_names[::2], 0.1 * limits[:, 1], strict=True))
    vertices = np.asarray(template.neutral(values), dtype=np.float64)
    quads = np.asarray(template.faces, dtype=np.int64)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    while len(vertices) < size:
        vertices, triangles = _halved(vertices, triangles, size - len(vertices))
    return vertices, triangles


def _halved(vertices: NDArray[np.float64], triangles: NDArray[np.int64], most: int) -> Mesh:
    """Up to `most` edges that are each the longest of all their triangles cut in half."""
    corners = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2)
    edges, edge = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
    edge = edge.reshape(-1, 3)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    rank = np.empty(len(edges), np.int64)
    rank[np.argsort(length)] = np.arange(len(edges))
    first = rank[edge].argmax(axis=1)
    chosen = edge[np.arange(len(edge)), first]
    is_cut = np.bincount(chosen, minlength=len(edges)) == np.bincount(
        edge.ravel(), minlength=len(edges)
    )
    cut = np.flatnonzero(is_cut)
    cut = cut[np.argsort(-rank[cut])][:most]
    number = np.full(len(edges), -1)
    number[cut] = len(vertices) + np.arange(len(cut))
    middle = number[chosen]
    rows = np.flatnonzero(middle >= 0)
    a, b, c = (triangles[rows, (first[rows] + k) % 3] for k in range(3))
    halves = np.concatenate([np.c_[a, middle[rows], c], np.c_[middle[rows], b, c]])
    finer = np.concatenate([vertices, vertices[edges[cut]].mean(axis=1)])
    return finer, np.concatenate([np.delete(triangles, rows, axis=0), halves])


def measure(size: int) -> None:
    """One line: vertices, seconds, those of the floor, how many times as many, seconds of ARKit's
    52 shapes on top, megabytes.

    The floor is what no way of solving saves: the mesh checked, the template registered to it.
    """
    template = load_template()
    vertices, triangles = person(template, size)
    marks = {name: int(template.landmark(name)) for name in REQUIRED}
    # What is made once for all heads
    small = person(template, 0)
    foreign_head.attach_foreign(*small, marks, template)
    start = time.perf_counter()
    lay_template(template, read_skin(vertices, triangles, marks, template))
    floor = time.perf_counter() - start
    start = time.perf_counter()
    head = foreign_head.attach_foreign(vertices, triangles, marks, template)
    seconds = time.perf_counter() - start
    start = time.perf_counter()
    head.make_units()
    units = time.perf_counter() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"{len(vertices):10,d} {seconds:9.1f} {floor:9.1f} {seconds / floor:9.2f} {units:9.1f} "
        f"{memory:9.0f}"
    )


def compare(size: int) -> None:
    """One line: seconds of both ways, and the cosines of what muscles and jaw do in them."""
    template = load_template()
    vertices, triangles = person(template, size)
    marks = {name: int(template.landmark(name)) for name in REQUIRED}
    skin = read_skin(vertices, triangles, marks, template)
    mesh = lay_template(template, skin)
    modes, seconds = [], []
    for kind in (SolvedSkin, CarriedSkin):
        start = time.perf_counter()
        head = kind(skin, mesh)
        rows = np.concatenate([head.muscle_modes()[0], head.jaw_modes()]).reshape(-1, vertices.size)
        seconds.append(time.perf_counter() - start)
        modes.append(rows / np.linalg.norm(rows, axis=1, keepdims=True))
    cosines = (modes[0] * modes[1]).sum(axis=1)
    print(
        f"{len(vertices):10,d} {seconds[0]:9.1f} {seconds[1]:9.1f} "
        f"{np.median(cosines):9.3f} {cosines.min():9.3f}"
    )


def show(names: tuple[str, ...], flag: str, sizes: Sequence[int]) -> None:
    """A table, each line by a process of its own, for its memory."""
    print(f"{names[0]:>10s}" + "".join(f" {name:>9s}" for name in names[1:]), flush=True)
    for size in sizes:
        subprocess.run([sys.executable, __file__, flag, str(size)], check=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="vertices")
    parser.add_argument("--measure", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--compare", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure is not None:
        measure(options.measure)
    elif options.compare is not None:
        compare(options.compare)
    else:
        show(
            ("vertices", "attach, s", "floor, s", "times", "52, s", "MB"),
            "--measure",
            options.sizes,
        )
        print("\nWithout the floor, solved on the head's own triangles beside carried:")
        names = ("vertices", "solved, s", "carried", "cosine", "least")
        show(names, "--compare", [size for size in options.sizes if size <= MOST_COMPARED])


if __name__ == "__main__":
    main()
