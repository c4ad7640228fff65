# SPDX-License-Identifier: GPL-3.0-or-later
"""Points marked by hand on photographs: the tables, what the methods are shown, and the score."""

import numpy as np
import pytest
from mimetic import InvalidInput
from PIL import Image

from evaluation.runs import real_photographs
from evaluation.runs.real import clip_text
from evaluation.runs.real_labels import LIP_POINTS, POINTS, read_labels
from evaluation.runs.real_photographs import (
    Photograph,
    faces_texts,
    marked_again,
    read_photographs,
    score_photographs,
)
from evaluation.runs.real_score import score_places


def ignore(_):
    pass


def test_marked_faces_are_faces():
    """A slip of the hand, as eyes exchanged or a digit, shows in the order of the points."""
    faces, labels = read_photographs()
    assert len(faces) >= 20
    assert ((labels.ipd > 35) & (labels.ipd < 140)).all()
    for side, toward in (("R", -1), ("L", 1)):
        names = (f"{n}.{side}" for n in ("lid_upper", "lid_lower", "eye_outer", "eye_inner"))
        upper, lower, outer, inner = np.moveaxis(labels.of(*names), 1, 0)
        seen = np.isfinite(upper[:, 1])
        assert (lower[seen, 1] > upper[seen, 1]).all() and seen.mean() > 0.9
        assert (toward * (outer - inner)[:, 0] > 0.15 * labels.ipd).all()
        for lid in (upper, lower):
            away = np.linalg.norm(lid - 0.5 * (outer + inner), axis=1)
            assert (away[seen] < 0.2 * labels.ipd[seen]).all()
    steps = np.diff(labels.of(*LIP_POINTS)[..., 1], axis=1)
    assert (steps[np.isfinite(steps)] >= 0).all()
    touching = labels.touch == 1
    lips = labels.of(*LIP_POINTS)
    np.testing.assert_array_equal(lips[touching, 1], lips[touching, 2])


def test_every_mark_lies_in_what_the_methods_are_shown():
    faces, labels = read_photographs()
    for face, places in zip(faces, labels.places, strict=True):
        if face.box is not None:
            marked = places[np.isfinite(places).all(axis=1)]
            assert (marked > face.box[:2]).all() and (marked < face.box[2:]).all(), face.name


def test_a_second_marking_agrees_with_the_first():
    score = marked_again(*read_photographs())
    for feature, figures in score.figures.items():
        assert figures["median"] < 2, feature


def test_of_a_picture_with_several_faces_a_part_is_shown(tmp_path, monkeypatch):
    monkeypatch.setattr(real_photographs, "PICTURES", tmp_path)
    picture = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)
    Image.fromarray(picture).save(tmp_path / "two.png")
    np.testing.assert_array_equal(Photograph("two.png").read(), picture)
    part = Photograph("two.png", (1, 0, 3, 2))
    np.testing.assert_array_equal(part.read(), picture[:2, 1:3])
    assert (part.name, part.corner.tolist()) == ("two.png from x = 1", [1, 0])


def test_a_photograph_that_was_not_fetched_is_named_with_what_fetches_it(tmp_path, monkeypatch):
    monkeypatch.setattr(real_photographs, "PICTURES", tmp_path)
    with pytest.raises(InvalidInput, match=r"a\.jpg.*scripts/fetch_footage --stills"):
        Photograph("a.jpg").read()


@pytest.mark.parametrize(
    ("box", "says"),
    [
        ("5,0,5,9", "empty box"),
        ("-5,0,5,9", "empty box"),
        ("5,,9,9", "invalid literal"),
        (",,,", "one row"),
    ],
)
def test_a_table_with_a_wrong_row_is_refused(box, says, tmp_path, monkeypatch):
    head, first = (real_photographs.FOLDER / "stills.csv").read_text().splitlines()[:2]
    cells = first.split(",")
    wrong = ",".join([cells[0], *box.split(","), *cells[5:]])
    (tmp_path / "stills.csv").write_text(f"{head}\n{first}\n{wrong}\n")
    monkeypatch.setattr(real_photographs, "FOLDER", tmp_path)
    with pytest.raises(InvalidInput, match=says):
        read_photographs()


def test_fits_of_parts_are_scored_where_the_parts_lie_in_the_picture(monkeypatch):
    faces, labels = read_photographs()
    away = 0.01 * labels.ipd[0]
    seen = iter([p - f.corner for f, p in zip(faces, labels.places, strict=True)])
    moved = np.zeros((len(POINTS), 2))
    moved[POINTS.index("lip_outer_lower"), 1] = away  # of the first face, down by 1 %

    def fitted(image):
        points = next(seen)
        return points + moved if image is images[0] else points

    monkeypatch.setattr(real_photographs, "fitted_points", fitted)
    images = [np.zeros((4, 4, 3), np.uint8) for _ in faces]
    fit, again = score_photographs(images, None, ignore)
    assert fit.figures["eye corners"]["median"] == pytest.approx(0, abs=1e-9)
    assert fit.faces[faces[0].name]["outer lips"] == pytest.approx(0.5, abs=0.01)
    assert fit.faces[faces[1].name]["outer lips"] == pytest.approx(0, abs=1e-9)
    assert fit.points["lip_outer_lower"][1] > 0.04
    text = clip_text([fit, again])
    assert faces[-1].name in text and "means of each point" in text


def test_a_clip_has_no_table_of_faces():
    labels = read_labels("single_face")
    assert faces_texts([score_places(labels, "capture", labels.places)]) == []
