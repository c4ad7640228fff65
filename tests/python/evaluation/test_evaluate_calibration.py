# SPDX-License-Identifier: GPL-3.0-or-later
"""What calibration is worth is put together right; nothing is captured here."""

import json
from argparse import Namespace
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.muscles.calibration import REGIONS, Calibration
from mimetic.solve import clip_capture
from mimetic.solve.calibrate import CalibrationResult, NothingSeen
from sample_performance import make_performance
from sample_truth import make_truth

from evaluation.runs import calibration


@dataclass
class Fit:
    calibration: Calibration = field(default_factory=Calibration)


@pytest.fixture
def clip(monkeypatch):
    """A person whom only the calibrated capture, {"lips": 2}, explains."""
    right = make_performance(num_frames=20)
    wrong = replace(right, activations=0 * right.activations)
    truth = make_truth(right)
    result = Calibration({"lips": 2.0}, frames=[3])
    shown = {"one": truth, "still": replace(truth, muscles=None, groups=None, activations=None)}
    clips = [Namespace(name=name, footage=name, truth=name) for name in shown]

    def calibrate(footage, frames, fit):
        assert frames == (1, 12)
        known = dict.fromkeys(REGIONS, 0.3)
        return replace(fit, calibration=result), CalibrationResult(result, known, {}, {}, 2.5)

    monkeypatch.setattr(calibration.expressions, "clips", lambda which, report: clips)
    monkeypatch.setattr(calibration, "calibrate", calibrate)
    monkeypatch.setattr(calibration.Truth, "load", lambda name: shown[name])
    monkeypatch.setattr(clip_capture, "find_face", lambda footage: Fit())
    monkeypatch.setattr(
        clip_capture, "capture", lambda _, fit: right if fit.calibration == result else wrong
    )
    return clips[0]


def test_parts_and_people_are_scored_with_and_without(clip):
    (person,) = calibration.score_calibration("tuning", None, lambda line: None)
    assert person.found["lips"] == 2 and person.found["chin"] == 1
    assert person.found["mean"] == pytest.approx(2 ** (1 / 6))
    rows = calibration.pooled([person, person])
    for part in calibration.PARTS:
        assert rows[f"{part}: calibrated"]["image"] == pytest.approx(1, abs=1e-6)
        assert rows[f"{part}: calibrated"]["activations"] == 0
        assert rows[f"{part}: not calibrated"]["image"] < 0.99
        assert rows[f"{part}: not calibrated"]["activations"] > 0.3
    assert "one" in calibration.as_text([person]) and "all 2" in calibration.as_text([person] * 2)
    assert json.loads(calibration.as_json([person]))["people"]["one"]["found"]["gain"] == 2.5


def test_a_person_who_shows_nothing_stays_as_assumed(clip, monkeypatch):
    def calibrate(footage, frames, fit):
        raise NothingSeen("no expression was seen")

    monkeypatch.setattr(calibration, "calibrate", calibrate)
    person = calibration.score_person(clip, calibration.Truth.load("one"))
    assert person.found == {}
    rows = calibration.pooled([person])
    for part in calibration.PARTS:
        assert rows[f"{part}: calibrated"] == rows[f"{part}: not calibrated"]


def test_people_moved_by_units_cannot_be_asked(clip, monkeypatch):
    monkeypatch.setattr(calibration.expressions, "clips", lambda which, report: [])
    with pytest.raises(InvalidInput, match="nobody of it is moved by muscles"):
        calibration.score_calibration("tuning", None, lambda line: None)


def test_named_expressions_are_not_cut():
    truth = make_truth(make_performance(num_frames=20))
    named = replace(truth, expressions=["a", "b"], expression_frames=np.array([[2, 9], [10, 20]]))
    assert calibration.num_first(named) == 9
    assert calibration.num_first(truth) == 12
