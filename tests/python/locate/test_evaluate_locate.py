# SPDX-License-Identifier: GPL-3.0-or-later
"""Finders of faces are scored as said; drawn images have their faces where the file says."""

import argparse
import json

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.commands.evaluate import add_arguments, run_evaluate
from mimetic.locate.eigenspaces import installed_spaces
from mimetic.locate.eigenspaces import save as save_spaces
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from evaluation.runs import locate
from evaluation.runs.finders import Found, Run, part_shares, run_locator
from evaluation.runs.locate_score import score_run
from evaluation.runs.stills import PARTS, Stills

PLACES = np.array([[90.0, 60.0], [60.0, 60.0], [75.0, 80.0], [75.0, 95.0]])
NOWHERE = np.full((4, 2), np.nan)


def make_stills(num_faces=3, num_empty=2):
    count = num_faces + num_empty
    return Stills(
        images=np.zeros((count, 120, 160, 3), np.uint8),
        has_face=np.arange(count) < num_faces,
        places=np.stack([PLACES] * num_faces + [NOWHERE] * num_empty),
        ipd=np.where(np.arange(count) < num_faces, 30.0, np.nan),
        yaw=np.where(np.arange(count) < num_faces, np.arange(count) * 12.0, np.nan),
        kinds=["face"] * num_faces + ["texture"] * num_empty,
    )


def save(stills, path, **changes):
    arrays = {name: getattr(stills, name) for name in vars(stills)}
    np.savez(path, **({"parts": np.array(PARTS)} | arrays | changes))


def run_of(*found):
    return Run([list(f) for f in found], np.full(len(found), 0.02))


def test_scores_of_known_answers():
    near, far = PLACES + np.array([3, 0]), PLACES + np.array([0, 40])
    run = run_of(
        [Found(0.9, PLACES), Found(0.2, far)],
        [Found(0.8, near), Found(0.5, near)],
        [Found(0.3, near)],
        [Found(0.4, PLACES)],
        [],
    )
    score = score_run(run, make_stills())
    assert score.threshold.tolist() == [0.9, 0.8, 0.5, 0.4, 0.3, 0.2]
    np.testing.assert_allclose(score.false_per_image, [0, 0, 0.2, 0.4, 0.4, 0.6])
    np.testing.assert_allclose(score.found_rate, np.array([1, 2, 2, 2, 3, 3]) / 3)
    figures = score.figures
    assert figures["found"] == pytest.approx(2 / 3)
    assert (figures["found_frontal"], figures["found_turned"]) == (1, 0)
    assert (figures["found_at_all"], figures["false_at_all"]) == (1, 0.6)
    assert figures["eye_median"] == pytest.approx(10)
    assert figures["mouth_p90"] == pytest.approx(10)
    assert figures["ms"] == pytest.approx(20)


def test_one_eye_off_is_not_found():
    off = PLACES.copy()
    off[1, 0] -= 8
    score = score_run(run_of(*[[Found(1, off)]] * 3, [], []), make_stills())
    assert score.figures["found_at_all"] == 0
    assert score.figures["false_at_all"] == pytest.approx(3 / 5)
    assert np.isnan(score.figures["eye_median"])


def test_parts_of_a_box_are_those_that_suit_best():
    stills = make_stills()
    box = np.array([50.0, 40.0, 50.0, 50.0])
    shares = part_shares([[box], [box, box + np.array([60, 0, 0, 0])], [], [], [box]], stills)
    np.testing.assert_allclose(shares, (PLACES - box[:2]) / 50)
    assert part_shares([[]] * 5, stills).shape == (4, 2)


def test_images_come_back_as_saved(tmp_path):
    save(make_stills(), tmp_path / "s.npz")
    loaded = Stills.load(tmp_path / "s.npz")
    np.testing.assert_array_equal(loaded.places, make_stills().places)
    assert loaded.kinds == make_stills().kinds


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"places": np.zeros((5, 3, 2))}, "places has the shape"),
        ({"images": np.zeros((5, 8, 8, 3))}, "images has the type"),
        ({"ipd": np.full(5, np.nan)}, "lacks its places"),
        ({"parts": np.array(["a", "b", "c", "d"])}, "parts must be"),
        ({"kinds": np.array([None] * 5)}, "Python objects"),
    ],
)
def test_bad_images_are_refused(tmp_path, changes, said):
    save(make_stills(), tmp_path / "s.npz", **changes)
    with pytest.raises(InvalidInput, match=said):
        Stills.load(tmp_path / "s.npz")


def test_what_is_no_archive_is_unreadable(tmp_path):
    (tmp_path / "s.npz").write_bytes(b"no archive")
    with pytest.raises(UnreadableMedia, match=r"s\.npz"):
        Stills.load(tmp_path / "s.npz")


def test_a_cascade_needs_its_file(tmp_path):
    (tmp_path / "c.xml").write_text("<opencv_storage>", "utf-8")
    for name in ("c.xml", "missing.xml"):
        with pytest.raises(InvalidInput, match=name):
            _core.CascadeDetector(str(tmp_path / name))
    detector = _core.CascadeDetector(str(data_folder() / "haarcascade_frontalface_alt2.xml"))
    assert detector.detect(np.full((64, 64, 3), 120, np.uint8)) == []
    with pytest.raises(InvalidInput, match="smallest"):
        detector.detect(np.zeros((64, 64, 3), np.uint8), smallest=0.0)


@pytest.fixture(scope="module")
def drawn():
    from evaluation.synthetic.stills.image_set import stills

    return stills("small", load_template(), lambda _: None)


def test_drawn_faces_are_where_the_file_says(drawn):
    stills = Stills.load(drawn)
    assert stills.kinds.count("face") == 3
    # Pupils are dark and the skin between the eyes is not, whatever the light
    for image, places in zip(stills.images[stills.has_face], stills.places[:3], strict=True):
        grey = image.mean(2)

        def tone(place, grey=grey):
            x, y = np.round(place).astype(int)
            return grey[y - 1 : y + 2, x - 1 : x + 2].mean()

        eyes = [tone(place) for place in places[:2]]
        assert max(eyes) < tone(places[:2].mean(0))
    result = score_run(run_locator(stills, installed_spaces()), stills).figures
    assert result["found_at_all"] == 1
    assert result["eye_median"] < 5


def test_command_scores_and_writes(drawn, tmp_path, capsys):
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    arguments = ["locate", "--images", str(drawn), "--out", str(tmp_path / "out"), "--json"]
    assert run_evaluate(parser.parse_args(arguments)) == 0
    printed = json.loads(capsys.readouterr().out)
    assert set(printed) >= {"mimetic", "eigenspaces", "cascades, measured", "Haar cascade"}
    assert json.loads((tmp_path / "out" / "locate.json").read_text("utf-8")) == printed
    assert (tmp_path / "out" / "locate_roc.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InvalidInput, match="do not go with"):
        run_evaluate(parser.parse_args(["locate", "--truth", "x"]))
    for arguments in (["--set", "real"], ["--images", "x"]):
        with pytest.raises(InvalidInput, match="evaluate locate"):
            run_evaluate(parser.parse_args(arguments))


def test_a_model_of_ones_own_is_scored(drawn, tmp_path, capsys):
    spaces = installed_spaces()
    blind = np.zeros_like(spaces.weights)
    blind[-1] = -20
    save_spaces(
        _core.FaceSpaces(spaces.views, spaces.other, spaces.modules, blind), tmp_path / "m.npz"
    )
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    arguments = [
        "locate",
        "--images",
        str(drawn),
        "--json",
        "--eigenspaces",
        str(tmp_path / "m.npz"),
    ]
    assert run_evaluate(parser.parse_args(arguments)) == 0
    scored = json.loads(capsys.readouterr().out)
    assert scored["eigenspaces"]["found"] == 0
    # What the cascades find alone stays
    assert scored["mimetic"]["found"] == scored["cascades, measured"]["found"]
    few = _core.FaceSpaces(
        [_without_mouth(view) for view in spaces.views],
        spaces.other,
        spaces.modules[:3],
        np.delete(spaces.weights, -2),
    )
    save_spaces(few, tmp_path / "few.npz")
    with pytest.raises(InvalidInput, match="no module mouth"):
        run_evaluate(parser.parse_args([*arguments[:-1], str(tmp_path / "few.npz")]))


def _without_mouth(view):
    places, covariance = view.places[:6], view.covariance[:6, :6]
    return _core.ViewSpace(
        view.yaw, view.filter, view.threshold, view.space, places, np.ascontiguousarray(covariance)
    )


def test_nothing_to_find_is_an_error():
    with pytest.raises(InvalidInput, match="nothing to find"):
        locate.score_finders(make_stills(num_faces=0), installed_spaces())
