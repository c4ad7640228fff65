# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance is scored against a truth file, and told in tables and JSON."""

import argparse
import dataclasses
import json

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.commands.evaluate import add_arguments, run_evaluate
from mimetic.score.score import score
from mimetic.score.tables import as_json, as_text, summary

from evaluation.runs import expression_tables
from evaluation.runs.deviation import Explained
from evaluation.runs.drift import drift_of
from evaluation.runs.expressions import Take, shown_expressions
from evaluation.runs.methods import Motion


def test_a_performance_that_is_the_truth_scores_one(performance, truth):
    result = score(truth, performance)
    assert result.on_face == 1
    assert result.image["mimetic"]["nonrigid_r2"] == pytest.approx(1, abs=1e-6)
    assert result.surface["r2"] == pytest.approx(1, abs=1e-6)
    assert result.head["largest_deg"] < 1e-6
    assert result.overall["rmse"] == 0
    assert min(curve["correlation"] for curve in result.controls.values()) == pytest.approx(1)


def test_head_motion_alone_explains_none_of_the_non_rigid_motion(performance, truth):
    result = score(truth, performance).image["its head motion alone"]
    assert abs(result["nonrigid_r2"]) < 0.35  # frame 1 of the sample is not at rest
    assert result["r2"] > result["nonrigid_r2"]


def test_files_of_different_frames_are_scored_on_those_they_share(performance, truth):
    late = dataclasses.replace(truth, frame=truth.frame + 30)
    assert score(late, performance).num_frames == 10
    with pytest.raises(InvalidInput, match="share 0 frames"):
        score(dataclasses.replace(truth, frame=truth.frame + 300), performance)
    other = dataclasses.replace(truth, image_size=np.array([640, 480]))
    with pytest.raises(InvalidInput, match="not of the same footage"):
        score(other, performance)


def test_expressions_are_scored_on_their_own_frames_and_pooled(performance, truth):
    wrong = truth.tracks.copy()
    wrong[20:] += 3
    shown = dataclasses.replace(
        truth, expressions=["first", "second"], expression_frames=[[2, 20], [21, 40]]
    )
    take = Take(None, "muscles", "still")
    take = dataclasses.replace(take, clip=argparse.Namespace(name="one"))
    motion = Motion(wrong, truth.points, performance)
    first, second = shown_expressions(take, shown, {"mimetic": motion})
    assert first.image["mimetic"].r2 == pytest.approx(1, abs=1e-9)
    assert second.image["mimetic"].r2 < 0.9
    assert second.image["mimetic"].median == pytest.approx(3 * np.sqrt(2))
    both = Explained.all_of([first.image["mimetic"], second.image["mimetic"]])
    assert both.error == second.image["mimetic"].error
    assert "second" in expression_tables.as_text([first, second])
    drift = drift_of(dataclasses.replace(truth, activations=0 * truth.activations), performance)
    assert drift.degrees == pytest.approx(0, abs=1e-9)


def test_reports_hold_the_figures(performance, truth):
    result = score(truth, performance, "clip")
    assert "R2 non-rigid" in as_text(result)
    assert "1.000" in summary([result])
    (read,) = json.loads(as_json([result]))
    assert read["name"] == "clip"
    assert read["image"]["mimetic"]["nonrigid_r2"] == pytest.approx(1, abs=1e-6)


def test_the_command_scores_files(tmp_path, capsys, performance, truth):
    truth.save(tmp_path / "t.npz")
    performance.save(tmp_path / "p.npz")
    options = evaluate_options(truth=tmp_path / "t.npz", performance=tmp_path / "p.npz", json=True)
    assert run_evaluate(options) == 0
    assert json.loads(capsys.readouterr().out)[0]["name"] == "p"
    with pytest.raises(InvalidInput, match="both"):
        run_evaluate(evaluate_options(truth=tmp_path / "t.npz"))
    files = {"truth": tmp_path / "t.npz", "performance": tmp_path / "p.npz"}
    with pytest.raises(InvalidInput, match="--out goes with"):
        run_evaluate(evaluate_options(**files, out=tmp_path / "out"))
    for arguments in (files, {"what": "head"}):
        with pytest.raises(InvalidInput, match="goes with plain"):
            run_evaluate(evaluate_options(**arguments, set="full"))


def evaluate_options(**given):
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    options = parser.parse_args([])
    for name, value in given.items():
        setattr(options, name, value)
    return options
