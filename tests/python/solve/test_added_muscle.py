# SPDX-License-Identifier: GPL-3.0-or-later
"""A muscle is one entry in one file: all else follows from it, from the skin to the shape keys."""

import tomllib
from importlib import resources

import numpy as np
import pytest
from mimetic.character.shapes import shapes_of
from mimetic.muscles import anatomy
from mimetic.performance.document import Performance
from mimetic.skin.mesh import SkinMesh, canonical_skin, find_place, multiply
from mimetic.solve.clip_capture import capture, find_face
from mimetic.template.face_template import load_template

ENTRY = """
[[muscle]]
name = "nasalis"
type = "linear"
group = 2
units = [38]
insertion = [["ala", 1, 3, 0]]
origin = ["ala", 8, 4, 3]
width = 5.0
measured_at = ["ala", 1, 2]
excursion_mm = 2.5
source = "a test's; it widens the nostril"
"""
ADDED = ("nasalis.L", "nasalis.R")


@pytest.fixture
def longer_table(tmp_path, monkeypatch):
    """The package with a copy of muscles.toml that has one more entry."""
    files = resources.files("mimetic") / "data"
    for name in ("muscles.toml", "materials.toml", "extras.toml"):
        (tmp_path / name).write_text((files / name).read_text("utf-8"), "utf-8")
    with (tmp_path / "muscles.toml").open("a", encoding="utf-8") as file:
        file.write(ENTRY)
    monkeypatch.setattr(
        anatomy, "load_table", lambda name: tomllib.loads((tmp_path / name).read_text("utf-8"))
    )


@pytest.mark.usefixtures("longer_table")
def test_one_entry_adds_a_muscle_from_the_skin_to_the_shape_keys(rendered_clip, tmp_path):
    template = load_template()
    attached = anatomy.attach(template.vertices, template)
    assert attached.muscle_names[-2:] == ADDED
    assert attached.groups[-2:].tolist() == [2, 2]
    left, right = attached.muscle_modes[-2:]
    mirrored = right[template.mirror] * [-1, 1, 1]
    assert np.abs(mirrored - left).max() < 1e-9
    mesh = SkinMesh(template, template.vertices)
    place = find_place(canonical_skin(template), "ala", 1, 2, 0, "L")
    moved = multiply(mesh.stencils, left[: template.num_skin_vertices])[place.vertex]
    assert np.linalg.norm(moved) == pytest.approx(2.5e-3, rel=1e-6)
    assert moved[0] > 0  # outwards

    fit = find_face(rendered_clip.footage)
    captured = capture(rendered_clip.footage, frames=(1, 3), fit=fit)
    assert captured.muscles[-2:] == list(ADDED)
    assert captured.activations.shape == (3, len(attached.muscle_names))
    captured.save(tmp_path / "performance.npz")
    read = Performance.load(tmp_path / "performance.npz")
    np.testing.assert_array_equal(read.activations, captured.activations)

    shapes = {shape.name: shape for shape in shapes_of(read)}
    assert shapes[ADDED[0]].group == "Upper Lip and Nose"
    np.testing.assert_array_equal(shapes[ADDED[0]].offsets, read.muscle_modes[-2])
    np.testing.assert_array_equal(shapes[ADDED[0]].values, read.activations[:, -2])
