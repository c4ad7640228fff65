# SPDX-License-Identifier: GPL-3.0-or-later
"""The skin of a person as a finite-element mesh, and places on it.

Shapes: V control vertices of the whole head, S of its skin (they come first), N vertices of the
refined skin, T triangles. Metres, head frame (x to the subject's left, y up, z out of the face).
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from mimetic import _core
from mimetic._core import CompressedRows, Place, find_place, keep_columns, quad_normals, split_quads
from mimetic.skin.checks import warn_of_smoothed
from mimetic.template.face_template import FaceTemplate

__all__ = [
    "CompressedRows",
    "Place",
    "SkinMesh",
    "canonical_skin",
    "find_place",
    "keep_columns",
    "multiply",
    "quad_normals",
    "split_quads",
]


def multiply(matrix: CompressedRows, values: np.ndarray) -> np.ndarray:
    """Product with one row of values a column, of any shape: columns x ... -> rows x ..."""
    values = np.asarray(values, dtype=np.float64)
    product = matrix.multiply(values.reshape(len(values), -1))
    return product.reshape(len(product), *values.shape[1:])


@lru_cache(maxsize=2)
def template_skin(template: FaceTemplate) -> _core.TemplateSkin:
    """What the skins of all heads of a template's mesh have in common."""
    return _core.TemplateSkin(
        vertices=np.asarray(template.vertices, dtype=np.float64),
        faces=template.faces,
        num_skin_vertices=int(template.num_skin_vertices),
        num_skin_faces=int(template.num_skin_faces),
        part=template.part,
        part_names=list(template.part_names),
        region=template.region,
        region_names=list(template.region_names),
        landmark_vertices=template.landmark_vertices,
        landmark_names=list(template.landmark_names),
        eye_centers=template.eye_centers,
        jaw_hinge=template.jaw_hinge,
    )


class SkinMesh(_core.SkinMesh):
    """A neutral head's skin, refined and cut into triangles.

    template: FaceTemplate; neutral: V x 3. Where faces lie turned over, the skin is smoothed with a
    warning. Raises InvalidInput on another mesh and where smoothing does not help.
    """

    def __init__(self, template: FaceTemplate, neutral: ArrayLike) -> None:
        vertices = np.ascontiguousarray(neutral, dtype=np.float64)
        if vertices.ndim != 2 or vertices.shape[1] != 3:
            raise _core.InvalidInput(
                f"neutral_vertices are {vertices.shape}, needed are {np.shape(template.vertices)}"
            )
        super().__init__(template_skin(template), vertices)
        self.template = template
        warn_of_smoothed(self.inverted_faces, self.smoothed_by)

    @cached_property
    def faces(self) -> np.ndarray:
        """Quads of the skin, linings included."""
        return self.template.skin_faces

    @cached_property
    def triangle_part(self) -> np.ndarray:
        """T names of parts: skin, mouth_cavity, eye_socket."""
        names = np.asarray(self.template.part_names)
        return names[np.repeat(self.template.part[self.refinement.parent_face], 2)]


@lru_cache(maxsize=2)
def canonical_skin(template: FaceTemplate) -> SkinMesh:
    """The skin of the template itself, on which muscles have their places."""
    return SkinMesh(template, template.vertices)
