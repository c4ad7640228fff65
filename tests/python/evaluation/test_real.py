# SPDX-License-Identifier: GPL-3.0-or-later
"""Points marked by hand on real faces: the tables, and how distances from them are counted."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from sample_performance import make_performance

from evaluation.runs import real_events, real_labels
from evaluation.runs.real import AGAIN, clip_text
from evaluation.runs.real_events import saturation, score_events
from evaluation.runs.real_labels import CLIPS, POINTS, Labels, read_labels
from evaluation.runs.real_score import FEATURES, RealScore, lips_gap, score_places


@pytest.fixture
def labels():
    return read_labels("single_face")


@pytest.mark.parametrize("clip", CLIPS)
def test_marked_faces_are_faces(clip):
    """A slip of the hand, as eyes exchanged or a digit, shows in the order of the points."""
    labels = read_labels(clip)
    assert len(labels.frame) >= 12
    assert ((labels.ipd > 25) & (labels.ipd < 120)).all()
    for side in "RL":
        upper, lower, outer, inner = np.moveaxis(
            labels.of(
                *(f"{n}.{side}" for n in ("lid_upper", "lid_lower", "eye_outer", "eye_inner"))
            ),
            1,
            0,
        )
        seen = np.isfinite(upper[:, 1])
        assert (lower[seen, 1] >= upper[seen, 1]).all() and seen.mean() > 0.9
        toward = 1 if side == "L" else -1
        assert (toward * (outer - inner)[:, 0] > 0.15 * labels.ipd).all()
        middle = 0.5 * (outer + inner)
        for lid in (upper, lower):
            assert (np.linalg.norm(lid - middle, axis=1)[seen] < 0.2 * labels.ipd[seen]).all()
    lips = labels.of(*real_labels.LIP_POINTS)[..., 1]
    steps = np.diff(lips, axis=1)
    assert (steps[np.isfinite(steps)] >= 0).all()
    touching = labels.touch == 1
    np.testing.assert_array_equal(lips[touching, 1], lips[touching, 2])


@pytest.mark.parametrize("clip", CLIPS)
def test_a_second_marking_agrees_with_the_first(clip):
    first, second = read_labels(clip), read_labels(clip, second=True)
    both = first.rows(np.isin(first.frame, second.frame))
    assert len(both.frame) == len(second.frame) >= 2
    scored = score_places(both, AGAIN, second.places)
    for feature, figures in scored.figures.items():
        assert figures["median"] < 2, feature


def test_ranges_of_lips_and_blinks_rise_and_agree_with_the_marked_frames():
    labels = read_labels("franck")
    touch = dict(zip(labels.frame.tolist(), labels.touch.tolist(), strict=True))
    irises = np.isfinite(labels.of("iris.R")[:, 0, 0])
    by_frame = dict(zip(labels.frame.tolist(), irises.tolist(), strict=True))
    last = 0
    for row in rows_of("franck.lips.csv"):
        first, end = int(row["first"]), int(row["last"])
        assert last < first <= end
        said = {touch[f] for f in range(first, end + 1) if f in touch and touch[f] == touch[f]}
        assert said <= {float(row["lips"] == "touch")}, row
        last = end
    last = 0
    for row in rows_of("franck.blinks.csv"):
        start, end = int(row["start"]), int(row["end"])
        assert last < start <= end
        if row["closed_first"]:
            closed = range(int(row["closed_first"]), int(row["closed_last"]) + 1)
            assert start <= closed[0] <= closed[-1] <= end
            assert not any(by_frame[f] for f in closed if f in by_frame), row
        last = end
    assert sum(row["kind"] == "blink" for row in rows_of("franck.blinks.csv")) == 27


def rows_of(name):
    with open(real_labels.FOLDER / name, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_a_known_shift_is_counted_in_the_interpupillary_distance(labels):
    shift = np.array([0.03 * labels.ipd, 0 * labels.ipd]).T  # to the image's right
    scored = score_places(labels, "moved", labels.places + shift[:, None])
    assert scored.figures["iris"]["median"] == pytest.approx(3, abs=1e-6)
    assert scored.figures["mouth corners"]["p90"] == pytest.approx(3, abs=1e-6)
    assert scored.figures["lids"]["median"] < 0.5  # along the margin: not counted
    assert scored.figures["iris"]["bias"] == pytest.approx(3, abs=0.01)
    assert scored.figures["iris"]["left"] == pytest.approx(0, abs=0.15)  # eyes are not all level
    assert scored.seen == 1
    assert scored.lips_told == 1


def test_frames_without_a_face_count_as_not_seen(labels):
    places = labels.places.copy()
    places[::2] = np.nan
    scored = score_places(labels, "half", places)
    assert scored.seen == pytest.approx(0.5, abs=0.03)
    assert scored.figures["iris"]["median"] == 0


def test_the_table_has_every_method_and_feature(labels):
    scores = [score_places(labels, name, labels.places) for name in ("one", "two")]
    text = clip_text(scores)
    assert all(word in text for word in ("one", "two", *FEATURES))
    assert "-" in clip_text([RealScore("single_face", "none", {name: {} for name in FEATURES})])


def test_a_table_with_a_missing_column_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(real_labels, "FOLDER", tmp_path)
    (tmp_path / "franck.csv").write_text("frame,iris.R.x\n3,4\n")
    with pytest.raises(InvalidInput, match=r"franck\.csv"):
        read_labels("franck")


def test_points_have_names_of_their_own(labels):
    assert len(set(POINTS)) == len(POINTS) == labels.places.shape[1]
    assert {name for names in FEATURES.values() for name in names} == set(POINTS)
    assert isinstance(labels.rows(labels.frame > 20), Labels)


def test_blinks_are_counted_beside_the_marked_ones(monkeypatch, tmp_path):
    """Of two marked blinks one is found, another is said where none is; a squint is none."""
    values = np.zeros((60, 2))
    values[[9, 10, 29, 49]] = [[1.0], [0.9], [0.5], [1.0]]
    performance = make_performance(
        60, articulators=["lid_upper.L", "lid_upper.R"], articulator_values=values
    )
    rows = ["kind,start,closed_first,closed_last,end", "blink,9,10,11,12", "blink,19,20,21,22"]
    (tmp_path / "clip.blinks.csv").write_text("\n".join([*rows, "squint,29,,,31"]) + "\n")
    monkeypatch.setattr(real_events, "FOLDER", tmp_path)
    (blinks,) = score_events("clip", performance)
    assert (blinks.marked, blinks.hits, blinks.false) == (2, 1, 1)
    assert blinks.f1 == pytest.approx(0.5)


def test_a_blink_in_which_the_capture_ends_does_not_count(monkeypatch, tmp_path):
    values = np.zeros((60, 2))
    values[[9, 10, 58, 59]] = 1.0
    performance = make_performance(
        60, articulators=["lid_upper.L", "lid_upper.R"], articulator_values=values
    )
    rows = ["kind,start,closed_first,closed_last,end", "blink,9,10,11,12", "blink,58,59,61,63"]
    (tmp_path / "clip.blinks.csv").write_text("\n".join(rows) + "\n")
    monkeypatch.setattr(real_events, "FOLDER", tmp_path)
    (blinks,) = score_events("clip", performance)
    assert (blinks.marked, blinks.hits, blinks.false) == (1, 1, 0)


def test_lips_that_are_shifted_along_each_other_are_not_parted(labels):
    touching = labels.rows(labels.touch == 1)
    corners = touching.of("mouth_corner.R", "mouth_corner.L")
    along = corners[:, 1] - corners[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    lower = POINTS.index("lip_inner_lower")
    for way, told in ((along, 1.0), (across, 0.0)):
        places = touching.places.copy()
        places[:, lower] += 0.2 * way
        assert score_places(touching, "shifted", places).lips_told == told


def test_a_lip_that_covers_the_other_touches_it(labels):
    upper, lower = (POINTS.index(f"lip_inner_{part}") for part in ("upper", "lower"))
    shut = labels.rows(labels.touch == 1)
    covered = shut.places.copy()
    covered[:, lower] = covered[:, upper] - 0.05 * shut.ipd[:, None] * [0, 1]
    assert lips_gap(shut, covered).max() < -3
    assert score_places(shut, "capture", covered).lips_told == 1


def test_saturation_is_the_share_of_active_muscle_frames_at_the_bound():
    performance = make_performance()
    activations = np.zeros_like(performance.activations)
    activations[:4, 0], activations[4, 0] = 0.5, 1.0
    assert saturation(replace(performance, activations=activations)) == 0.2
