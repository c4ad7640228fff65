# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage and baked face side by side."""

import numpy as np
import pytest
from clips import make_clip
from mimetic import InvalidInput
from mimetic.character.contact_shapes import contact_shapes
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.beside import GAUGE, BesideDrawing, baked
from mimetic.report.overlay import write_overlay
from mimetic.template.face_template import load_template
from sample_performance import make_performance

GROUND = 60


def make_head(**changes) -> Performance:
    """The canonical head, which closes one articulator's lids and lowers the other's jaw."""
    template = load_template()
    vertices = template.vertices
    modes = np.zeros((2, len(vertices), 3))
    modes[0] = template.unit_modes[template.unit_names.index("jawOpen")]
    values = {
        "neutral_vertices": vertices,
        "faces": template.faces,
        "muscle_modes": np.zeros((36, len(vertices), 3)),
        "articulator_modes": modes,
    }
    return make_performance(**(values | changes))


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    path = tmp_path_factory.mktemp("clip") / "clip.mp4"
    return make_clip(path, size="320x240", frames=12, rate="24000/1001", source="mandelbrot")


def views_of(picture):
    """Whole and enlarged: footage, face."""
    rows, cols = (picture.shape[0] - GAUGE) // 2, picture.shape[1] // 2
    return [
        [picture[top : top + rows, :cols], picture[top : top + rows, cols:]] for top in (0, rows)
    ]


def test_the_face_is_where_the_camera_has_it_and_enlarged_below(clip):
    performance = make_head()
    picture = BesideDrawing(performance, clip).paint(Footage(clip).read(1), 0)
    (footage, face), (_, near) = views_of(picture)
    assert footage.shape == face.shape == near.shape == (480, 640, 3)
    skin = load_template().part_vertices("skin")
    pixels = 2 * performance.project(performance.surface_in_camera(0)[skin])
    drawn = np.argwhere((face != GROUND).any(axis=2))[:, ::-1]
    np.testing.assert_allclose(drawn.min(axis=0), pixels.min(axis=0), atol=6)
    np.testing.assert_allclose(drawn.max(axis=0), pixels.max(axis=0), atol=6)
    assert (near != GROUND).any(axis=2).sum() > 1.5 * len(drawn)


def test_the_footage_is_shown_as_it_is(clip):
    performance, image = make_head(), Footage(clip).read(3)
    (footage, _), _ = views_of(BesideDrawing(performance, clip).paint(image, 2))
    halves = footage.reshape(240, 2, 320, 2, 3).mean(axis=(1, 3))
    assert np.abs(halves - image).mean() < 4


def test_an_opened_mouth_is_dark_inside(clip):
    performance = make_head(articulator_values=np.array([[0.0, 0]] * 6 + [[1.0, 0]] * 6))
    drawing = BesideDrawing(performance, clip)
    image = Footage(clip).read(1)
    template = load_template()
    lips = [template.landmark(f"lip_{which}_inner") for which in ("upper", "lower")]
    place = 2 * performance.project(performance.surface_in_camera(6)[lips]).mean(axis=0)
    x, y = (round(float(part)) for part in place)
    still = make_head(articulator_values=performance.articulator_values * 0)
    shut = BesideDrawing(still, clip).paint(image, 6)[:480, 640:][y, x].astype(int)
    opened = drawing.paint(image, 6)[:480, 640:][y, x].astype(int)
    assert opened.sum() < 0.6 * shut.sum()


def test_a_bakes_contact_and_detail_are_drawn():
    template = load_template()
    modes = np.zeros((2, len(template.vertices), 3))
    modes[0] = template.unit_modes[template.unit_names.index("mouthClose")]  # its lips overlap
    values = np.tile([1.0, 0.0], (12, 1))
    detail = np.full((1, len(template.vertices), 3), 1e-3, dtype=np.float32)
    performance = make_head(
        articulator_modes=modes,
        articulator_values=values,
        detail_modes=detail,
        detail_coefficients=np.ones((12, 1)),
    )
    shapes = contact_shapes(performance.without_detail())
    contact = sum(shape.values[0] * shape.offsets for shape in shapes)
    assert np.abs(contact).max() > 1e-3
    muscles = performance.without_detail().surface(0)
    np.testing.assert_allclose(baked(performance).surface(0), muscles + contact, atol=1e-6)
    with_detail = baked(performance, with_detail=True).surface(0)
    assert np.abs(with_detail - muscles - contact - 1e-3).max() < 5e-4


def test_a_head_of_another_mesh_is_drawn_plainly(clip):
    picture = BesideDrawing(make_performance(), clip).paint(Footage(clip).read(1), 0)
    (_, face), _ = views_of(picture)
    assert (face != GROUND).any(axis=2).sum() > 2000


def test_footage_of_another_size_is_refused(clip, tmp_path):
    other = make_clip(tmp_path / "other.mp4", size="160x120", frames=12)
    with pytest.raises(InvalidInput, match="another clip"):
        BesideDrawing(make_head(), other)
    with pytest.raises(InvalidInput, match="another clip"):
        BesideDrawing(make_performance(), clip).paint(Footage(other).read(1), 0)


def test_pixels_that_are_not_square_are_shown_as_they_are_meant(tmp_path):
    options = ("-vf", "setsar=2", "-c:v", "libx264", "-pix_fmt", "yuv420p")
    footage = Footage(make_clip(tmp_path / "wide.mp4", *options, size="160x240", frames=12))
    assert footage.size == (320, 240)
    performance = make_performance(stored_size=np.array([160, 240]))
    drawing = BesideDrawing(performance, footage.path)
    assert write_overlay(performance, footage, tmp_path / "beside.mp4", drawing=drawing)
    beside = Footage(tmp_path / "beside.mp4")
    assert beside.size == (1280, 960 + GAUGE) and beside.fps == footage.fps
    assert beside.num_frames == 12 and not beside.warnings
