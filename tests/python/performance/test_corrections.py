# SPDX-License-Identifier: GPL-3.0-or-later
import copy
import json

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.muscles.extras import lip_rows
from mimetic.performance.corrections import (
    check_corrections,
    corrected_frames,
    corrections_from,
    from_texts,
    limits_of,
    load_corrections,
    save_corrections,
    texts_of,
)
from mimetic.performance.document import Performance
from mimetic.performance.pinned_places import PinnedPlaces, place_under
from mimetic.performance.places import RefinedSurface
from mimetic.performance.take_facts import facts_of, quality_of
from mimetic.report.face_lines import CORRECTED, quality_strip
from sample_performance import make_performance

POSE = [[1, 0, 0, 0.01], [0, -1, 0, 0], [0, 0, -1, 0.6], [0, 0, 0, 1]]
PIN = {"face": 3, "weights": [0.5, 0.5, 0, 0], "pixel": [10, 20.5], "std": 1.5}
WHOLE = {
    "schema": 1,
    "corrections": [
        {
            "frame": 41,
            "reach": 10,
            "pins": [PIN],
            "values": {"lid_upper.L": {"value": 0}, "risorius.R": {"value": 0.6, "std": 0.1}},
            "lip_gap": {"value": 0},
        },
        {"frame": 12, "pose": {"head_pose": POSE, "rotation_std": 0.02}},
    ],
}


def test_a_file_comes_back_as_it_was(tmp_path):
    corrections = corrections_from(WHOLE)
    assert [entry.frame for entry in corrections] == [12, 41]
    save_corrections(tmp_path / "c.json", corrections)
    again = load_corrections(tmp_path / "c.json")
    assert texts_of(again) == texts_of(corrections)
    assert again[1].pins[0].pixel == (10, 20.5) and again[1].pins[0].std == 1.5
    assert again[1].values["lid_upper.L"].std > 0 and again[1].lip_gap.value == 0
    np.testing.assert_array_equal(again[0].pose.head_pose, POSE)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.update(schema=2), "schema 2"),
        (lambda d: d.update(extra=1), "unknown keys: extra"),
        (lambda d: d.pop("corrections"), "lacks corrections"),
        (lambda d: d["corrections"][0].update(frame=0), r"corrections\[0\].frame is 0"),
        (lambda d: d["corrections"][0].update(frame=True), "frame is True"),
        (lambda d: d["corrections"][0].update(frame=12), "frame 12 twice"),
        (lambda d: d["corrections"][0].update(reach=0), "frame 41: reach is 0"),
        (lambda d: d["corrections"][0].update(pin=[]), "unknown keys: pin"),
        (lambda d: d["corrections"][0]["pins"][0].update(face=-1), r"pins\[0\].face is -1"),
        (lambda d: d["corrections"][0]["pins"][0].update(std=0), r"pins\[0\].std is 0"),
        (lambda d: d["corrections"][0]["pins"][0].update(weights=[1, 0, 0]), "must be 4 numbers"),
        (lambda d: d["corrections"][0]["pins"][0].update(weights=[1, 1, 0, 0]), "sum to 2"),
        (lambda d: d["corrections"][0]["pins"][0].update(pixel=["1", 2]), r"pixel\[0\] is '1'"),
        (lambda d: d["corrections"][0]["values"].update(jaw_open=0.5), "jaw_open must be an obj"),
        (
            lambda d: d["corrections"][0]["values"].update({"gaze_yaw.L": {"value": 51}}),
            r"gaze_yaw.L.value is 51; a number from -50 to 50",
        ),
        (
            lambda d: d["corrections"][0]["values"].update({"jaw_open": {"value": 1.5}}),
            r"jaw_open.value is 1.5; a number from -1 to 1",
        ),
        (lambda d: d["corrections"][1]["pose"].update(head_pose=POSE[:3]), "4 rows"),
        (
            lambda d: d["corrections"][1]["pose"]["head_pose"][0].__setitem__(0, 2),
            "frame 12: pose.head_pose must be a rotation",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(change, words):
    document = copy.deepcopy(WHOLE)
    change(document)
    with pytest.raises(InvalidInput, match=words):
        corrections_from(document)


def test_a_file_with_other_numbers_is_refused_by_its_name(tmp_path):
    (tmp_path / "c.json").write_text(json.dumps(WHOLE).replace("20.5", "NaN"))
    with pytest.raises(InvalidInput, match=r"c.json.*pixel\[1\] is nan"):
        load_corrections(tmp_path / "c.json")


@pytest.mark.parametrize(
    ("frames", "num_faces", "names", "words"),
    [
        ((1, 40), 10, ["lid_upper.L", "risorius.R"], "frame 41: the capture has frames 1 to 40"),
        ((1, 50), 3, ["lid_upper.L", "risorius.R"], r"pins\[0\].face is 3, the skin has faces 0"),
        ((1, 50), 10, ["lid_upper.L"], "values.risorius.R: the capture has no such value"),
    ],
)
def test_corrections_of_another_capture_are_refused(frames, num_faces, names, words):
    with pytest.raises(InvalidInput, match=words):
        check_corrections(corrections_from(WHOLE), frames, num_faces, names)


def test_a_performance_keeps_what_was_corrected(tmp_path):
    texts = texts_of(corrections_from(WHOLE))
    performance = make_performance(num_frames=50, corrections=texts)
    performance.save(tmp_path / "p.npz")
    again = Performance.load(tmp_path / "p.npz")
    assert corrected_frames(again) == [12, 41]
    assert texts_of(from_texts(again.corrections)) == texts
    with pytest.raises(InvalidInput, match="not JSON"):
        make_performance(corrections=["{"])


def test_lips_may_be_stated_as_far_as_a_capture_moves_them():
    for row in lip_rows():
        assert limits_of(row["name"]) == tuple(row["limits"])


def test_the_strip_marks_corrected_frames():
    texts = texts_of(corrections_from(WHOLE))
    performance = make_performance(num_frames=50, corrections=texts)
    place = (0.0, 2.0, 10.0, 5.0)
    points, colours = quality_strip(performance.frame, performance.quality, *place, [12, 41])
    assert len(points) == 6 * 52
    np.testing.assert_allclose(colours[-12:], np.tile(CORRECTED, (12, 1)), rtol=1e-6)
    assert points[-6:, 0].min() == 80.0 and points[-6:, 1].min() == 15.0
    assert facts_of(performance).num_corrected == 2
    assert quality_of(performance, 12).is_corrected and not quality_of(performance, 13).is_corrected


def test_the_place_under_a_pixel_is_seen_at_that_pixel():
    from mimetic.library.composing import canonical_person
    from mimetic.performance.corrections import SkinPin
    from mimetic.template.face_template import load_template

    person, template = canonical_person(), load_template()
    surface = RefinedSurface(person)
    nose = person.project(person.surface_in_camera(0)[[template.landmark("nose_tip")]])[0]
    for offset in ((0.0, 0.0), (-31.3, 17.8), (25.2, 40.4)):
        pixel = (float(nose[0] + offset[0]), float(nose[1] + offset[1]))
        face, weights = place_under(surface, pixel, 0)
        assert face < template.num_skin_faces and abs(sum(weights) - 1) < 1e-9
        pin = SkinPin(face, weights, pixel)
        point = PinnedPlaces(template, [pin]).positions(person.surface_in_camera(0))
        np.testing.assert_allclose(person.project(point)[0], pixel, atol=0.15)
    assert place_under(surface, (2.0, 2.0), 0) is None
