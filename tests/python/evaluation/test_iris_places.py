"""Where a head has its irises: no vertex of the eyeballs is there."""

import numpy as np
from mimetic.template.face_template import load_template

from evaluation.runs.real_methods import iris_fronts


def test_eyes_that_look_ahead_have_their_irises_before_their_centres():
    template = load_template()
    fronts = iris_fronts(template.vertices, template)
    np.testing.assert_allclose(fronts[:, :2], template.eye_centers[:, :2], atol=5e-4)
    assert (fronts[:, 2] > template.eye_centers[:, 2] + 0.012).all()


def test_the_drawn_pupil_is_there():
    """By the texture of the eyes, azimuthal about the iris."""
    template = load_template()
    fronts = iris_fronts(template.vertices, template)
    for side, front in zip("LR", fronts, strict=True):
        faces = template.part_faces(f"eye.{side}")
        uv = template.uv[faces].reshape(-1, 2)
        middle = (uv.min(axis=0) + uv.max(axis=0)) / 2
        points = template.vertices[template.faces[faces]].reshape(-1, 3)
        near = np.argsort(np.linalg.norm(uv - middle, axis=1))[:16]
        # The texture's place of the middle, by the corners about it, is nearer than any of them
        weights = 1 / np.maximum(np.linalg.norm(uv[near] - middle, axis=1), 1e-6) ** 2
        by_texture = weights @ points[near] / weights.sum()
        assert np.linalg.norm((by_texture - front)[:2]) < 1e-3
