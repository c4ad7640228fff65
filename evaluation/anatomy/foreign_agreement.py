# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles attached through landmarks against muscles attached directly, on the same head.

    python -m evaluation.anatomy.foreign_agreement [--seed N] [--identity SHARE]

A person of the identity space is meshed anew (a part of the fine skin's edges collapsed, vertices
shuffled, 1.3 times as large, turned and moved) and given to `attach_foreign` as a foreign head,
with the needed landmarks only. Per muscle: cosine of the two displacement fields over the skin, and
the foreign field's length over the direct one's. How long both took is printed, too.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from dataclasses import dataclass

import numpy as np
from mimetic.character.foreign_head import ForeignHead, attach_foreign
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.muscles.anatomy import Anatomy, attach
from mimetic.skin.mesh import SkinMesh, multiply
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

SCALE = 1.3
KEPT = 0.5  # of the fine skin's vertices


@dataclass(frozen=True)
class Disguised:
    """A person as a foreign mesh: V vertices, F triangles, and whence each vertex came.

    skin_vertex: V, of the fine skin, -1 on eyes, teeth and lashes; control_vertex: V, of the whole
    head's mesh there, -1 on the skin; rotation: of the mesh's axes.
    """

    mesh: SkinMesh
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    landmarks: dict[str, int]
    skin_vertex: NDArray[np.int64]
    control_vertex: NDArray[np.int64]
    rotation: NDArray[np.float64]

    def expected(self, modes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Modes of the template's mesh (M x V' x 3) as this mesh should have them: M x V x 3."""
        count = int(self.mesh.template.num_skin_vertices)
        fine = np.stack([multiply(self.mesh.stencils, mode[:count]) for mode in modes])
        on_skin = self.skin_vertex >= 0
        own = np.where(on_skin[:, None], fine[:, self.skin_vertex], modes[:, self.control_vertex])
        return SCALE * own @ self.rotation.T


def disguise(template: FaceTemplate, seed: int, identity: float, kept: float = KEPT) -> Disguised:
    """A random person; identity: share of the identity modes' ranges."""
    random = np.random.default_rng(seed)
    limits = np.asarray(template.identity_limits)
    values = identity * random.uniform(limits[:, 0], limits[:, 1])
    neutral = template.vertices + np.einsum("i,ivc->vc", values, template.identity_modes)
    mesh = SkinMesh(template, neutral)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # folds of a random person are repaired
        fine = mesh.vertices
    anchors = [mesh.landmark(name) for name in REQUIRED]
    skin_faces = collapse_edges(fine, mesh.triangles, kept, random, set(anchors))
    fine_rows = np.unique(skin_faces)
    loose_faces = template.faces[int(template.num_skin_faces) :]
    loose = np.unique(loose_faces)
    # Number fine skin and loose parts together, shuffled
    number = random.permutation(len(fine_rows) + len(loose))
    of_skin, of_loose = np.full(len(fine), -1), np.full(len(neutral), -1)
    of_skin[fine_rows], of_loose[loose] = number[: len(fine_rows)], number[len(fine_rows) :]
    vertices = np.empty((len(number), 3))
    vertices[of_skin[fine_rows]], vertices[of_loose[loose]] = fine[fine_rows], neutral[loose]
    skin_vertex, control_vertex = np.full(len(number), -1), np.full(len(number), -1)
    skin_vertex[of_skin[fine_rows]], control_vertex[of_loose[loose]] = fine_rows, loose
    quads = of_loose[loose_faces]
    faces = np.concatenate([of_skin[skin_faces], quads[:, :3], quads[:, [0, 2, 3]]])
    rotation, _ = np.linalg.qr(random.normal(size=(3, 3)))
    rotation *= np.sign(np.linalg.det(rotation))
    return Disguised(
        mesh,
        SCALE * vertices @ rotation.T + random.uniform(-1, 1, 3),
        random.permutation(faces),
        {name: int(of_skin[vertex]) for name, vertex in zip(REQUIRED, anchors, strict=True)},
        skin_vertex,
        control_vertex,
        rotation,
    )


def collapse_edges(
    vertices, triangles, share: float, random, anchors: set[int]
) -> NDArray[np.int64]:
    """Triangles left when random short edges are collapsed onto one end, the mesh staying sound."""
    faces = {index: tuple(face) for index, face in enumerate(triangles.tolist())}
    around: dict[int, set[int]] = {}
    for index, face in faces.items():
        for vertex in face:
            around.setdefault(vertex, set()).add(index)

    def ring(vertex):
        return {other for index in around[vertex] for other in faces[index]} - {vertex}

    def is_flat(removal, stays):
        """No remaining triangle turns over or loses its extent."""
        for index in around[removal] - around[stays]:
            before = vertices[list(faces[index])]
            after = vertices[[stays if v == removal else v for v in faces[index]]]
            old, new = (np.cross(t[1] - t[0], t[2] - t[0]) for t in (before, after))
            if old @ new < 0.8 * np.linalg.norm(old) * np.linalg.norm(new):
                return False
            sides = after - np.roll(after, 1, axis=0)
            if np.linalg.norm(new) < 0.3 * (sides**2).sum(1).max():
                return False
        return True

    num_collapses = int((1 - share) * len(around))
    for _ in range(3):
        for removal in random.permutation(list(around)).tolist():
            if num_collapses <= 0:
                break
            neighbours = ring(removal)
            if removal in anchors or len(neighbours) != len(around[removal]):  # a landmark, the rim
                continue
            stays = min(
                neighbours, key=lambda v: float(((vertices[v] - vertices[removal]) ** 2).sum())
            )
            if len(ring(stays) & neighbours) != 2 or not is_flat(removal, stays):
                continue
            for index in around.pop(removal):
                face = tuple(stays if v == removal else v for v in faces[index])
                if len(set(face)) < 3:
                    for vertex in set(face):
                        around[vertex].discard(index)
                    del faces[index]
                else:
                    faces[index] = face
                    around[stays].add(index)
            num_collapses -= 1
    return np.array(list(faces.values()), dtype=np.int64)


@dataclass(frozen=True)
class Agreement:
    """One field: cosine with the direct one, length over the direct one's."""

    name: str
    cosine: float
    ratio: float


def compare(head: Disguised, direct: Anatomy, foreign: ForeignHead) -> list[Agreement]:
    rows = []
    for kind in ("muscle", "articulator"):
        expected_modes = head.expected(getattr(direct, f"{kind}_modes"))
        names = getattr(direct, f"{kind}_names")
        modes = getattr(foreign.anatomy, f"{kind}_modes")
        for name, own, other in zip(names, expected_modes, modes, strict=True):
            lengths = np.linalg.norm(own), np.linalg.norm(other)
            cosine = float((own * other).sum() / (lengths[0] * lengths[1]))
            rows.append(Agreement(name, cosine, float(lengths[1] / lengths[0])))
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="evaluation.anatomy.foreign_agreement", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--seed", type=int, default=1, help="of the person and the new mesh")
    parser.add_argument("--identity", type=float, default=0.3, help="share of the modes' ranges")
    options = parser.parse_args(arguments)
    template = load_template()
    head = disguise(template, options.seed, options.identity)
    start = time.perf_counter()
    foreign = attach_foreign(head.vertices, head.faces, head.landmarks, template)
    attachment_end = time.perf_counter()
    foreign.make_contact()
    seconds = attachment_end - start, time.perf_counter() - attachment_end
    rows = compare(head, attach(head.mesh.neutral, template), foreign)
    print(
        f"{len(head.vertices)} vertices, {len(head.faces)} faces, {len(head.landmarks)} landmarks"
    )
    print("attached in {:.1f} s, its contact in {:.1f} s".format(*seconds))
    print("laid on within {:.2f} mm (median), {:.2f} mm (95 %)".format(*foreign.gap_mm))
    for row in rows:
        print(f"{row.name:44s} cosine {row.cosine:6.3f}  length {row.ratio:5.2f}")
    print(f"median cosine {np.median([row.cosine for row in rows]):.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
