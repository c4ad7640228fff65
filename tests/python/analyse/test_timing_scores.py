# SPDX-License-Identifier: GPL-3.0-or-later
import csv
from dataclasses import replace

import numpy as np
import pytest
from mimetic import _core
from mimetic.analyse.smiles import smiles_of, summary_of
from mimetic.analyse.timing import analyse_timing, curves_of
from mimetic.analyse.timing_report import FILES
from mimetic.commands.cli import main
from mimetic.performance.corrections import FrameCorrection, Pinned, texts_of
from sample_performance import make_performance

FRAMES = 80


def firing(onset, amplitude=0.7):
    return shape_of(onset, amplitude).values(np.arange(1.0, FRAMES + 1))


def shape_of(onset, amplitude):
    shape = _core.PhaseShape()
    shape.onset, shape.amplitude, shape.rise, shape.hold = onset, amplitude, 9, 10
    shape.exponent, shape.release_time = -2, 4
    return shape


def smiling(mouth=20.0, eyes=23.0, left=0.7, right=0.7):
    """Mouth and eyes fire, all else is silent; the groups of the sample have 8 and 4 muscles."""
    rng = np.random.default_rng(3)
    activations = np.abs(rng.normal(0, 0.002, (FRAMES, 36)))
    activations[:, 0:8:2] += firing(mouth, left)[:, None]
    activations[:, 1:8:2] += firing(mouth, right)[:, None]
    if eyes is not None:
        activations[:, 32:] += firing(eyes, 0.5)[:, None]
    return make_performance(
        FRAMES, activations=np.clip(activations, 0, 1), quality=np.ones(FRAMES), fps=30
    )


def test_groups_sides_and_muscles_are_curves():
    curves = list(curves_of(smiling()))
    assert [
        sum(curve.kind == kind for curve in curves) for kind in ("group", "side", "muscle")
    ] == [*(7, 14, 36)]
    group = curves[0]
    assert group.measured_std == pytest.approx(0.05)
    assert group.stds[0] == pytest.approx(0.05 / np.sqrt(8))


def test_only_what_fires_has_events_and_the_eyes_are_late():
    timing = analyse_timing(smiling(), kinds=("group", "side"))
    certain = [event for event in timing.of_kind("group") if event.fit.is_certain]
    assert [event.curve.group for event in certain] == [1, 7]
    assert certain[0].fit.onset.value == pytest.approx(20, abs=1)
    [pair] = timing.delays
    assert pair.delay.lag.value == pytest.approx(3, abs=0.5)
    assert pair.delay.is_delayed


def by_pictures(performance, **changes):
    """The performance with pictures that agree with twice its brows' activations."""
    size = 6 + len(performance.muscles)
    is_brow = performance.groups == 5
    performance.activations[:, is_brow] += firing(20.0, 0.2)[:, None]
    evidence = []
    for values in performance.activations:
        step = np.zeros(size)
        step[6:][is_brow] = values[is_brow]
        information = 1e4 * np.eye(size)
        packed = [information[i, : i + 1] for i in range(size)]
        evidence.append(np.concatenate([*packed, information @ step]))
    return replace(performance, evidence=np.array(evidence, np.float32), **changes)


def test_phases_are_of_what_the_pictures_say_unless_a_person_corrected_it():
    [event] = certain(by_pictures(smiling()), group=5)
    assert event.fit.amplitude.value == pytest.approx(0.4, abs=0.01)
    assert event.fit.smoothing == 0
    pinned = FrameCorrection(30, values={"muscle_00.L": Pinned(0.5, 0.03)})
    corrected = by_pictures(smiling(), corrections=texts_of([pinned]))
    [event] = certain(corrected, group=5)
    assert event.fit.amplitude.value == pytest.approx(0.2, abs=0.01)


def certain(performance, group):
    timing = analyse_timing(performance, kinds=("group",))
    return [event for event in timing.of_group(group) if event.fit.is_certain]


def test_no_delay_is_told_of_groups_that_fire_together_or_not_at_all():
    [pair] = analyse_timing(smiling(eyes=20.0), kinds=("group",)).delays
    assert not pair.delay.is_delayed
    assert analyse_timing(smiling(eyes=None), kinds=("group",)).delays == []


def test_a_scene_that_begins_in_a_smile_shows_no_onset():
    cut = replace(smiling(), scene_starts=np.array([34]))
    before, smile = smiles_of(analyse_timing(cut, kinds=("group", "side")))
    assert before.event.fit.ends_after and before.event.fit.last == 32
    assert smile.event.fit.begins_before and smile.event.fit.first == 33
    assert np.isnan(smile.rise_seconds.value) and smile.eye_delay is None
    words = summary_of(smile)
    assert "its onset is not known" in words and "which began first is not known" in words


@pytest.mark.parametrize(("left", "right"), [(0.7, 0.0), (0.0, 0.7), (0.7, 0.02)])
def test_a_smile_of_one_side_is_uneven(left, right):
    [smile] = smiles_of(analyse_timing(smiling(left=left, right=right), kinds=("group", "side")))
    assert smile.asymmetry.value == pytest.approx((left - right) / (left + right), abs=0.05)
    assert np.sign(smile.asymmetry.lower) == np.sign(smile.asymmetry.upper) == np.sign(left - right)
    assert ("left" if left > right else "right") in summary_of(smile)


def test_a_smile_says_no_more_than_its_numbers():
    [smile] = smiles_of(analyse_timing(smiling(right=0.35), kinds=("group", "side")))
    assert smile.eye_ratio.value == pytest.approx(0.5 / 0.525, abs=0.1)
    assert smile.asymmetry.value == pytest.approx(1 / 3, abs=0.05)
    assert smile.asymmetry.lower > 0
    words = summary_of(smile)
    assert "left" in words and "after the mouth" in words
    [even] = smiles_of(analyse_timing(smiling(eyes=None), kinds=("group", "side")))
    assert "No significant difference between the sides" in summary_of(even)
    assert "No contraction about the eyes" in summary_of(even)
    for word in ("fake", "genuine", "posed", "felt"):
        assert word not in words + summary_of(even)


def test_a_smile_lasts_until_a_tenth_is_left():
    [smile] = smiles_of(analyse_timing(smiling(eyes=None), kinds=("group", "side")))
    seconds = (9 + 10 + 4 * np.log(10)) / 30  # rise, hold and fall of `firing`
    assert seconds == pytest.approx((19 + shape_of(20.0, 0.7).fall_time) / 30)
    total = smile.total_seconds
    assert total.value == pytest.approx(seconds, abs=0.05)
    assert total.lower < seconds < total.upper


def test_the_command_writes_tables_figures_and_a_page(tmp_path, capsys):
    smiling().save(tmp_path / "performance.npz")
    out = tmp_path / "out"
    assert main(["analyse", str(tmp_path / "performance.npz"), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == set(FILES)
    with open(out / "phases.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    mouth = next(row for row in rows if row["kind"] == "group" and row["group"] == "1")
    assert float(mouth["onset_frame_lower"]) <= 20 <= float(mouth["onset_frame_upper"])
    assert (out / "groups.svg").read_text().startswith("<?xml")
    assert "1 of 1 pair delayed" in capsys.readouterr().out


def test_the_page_of_a_capture_in_the_same_folder_stays(tmp_path):
    smiling().save(tmp_path / "performance.npz")
    (tmp_path / "report.html").write_text("of the capture")
    assert main(["analyse", str(tmp_path / "performance.npz"), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "report.html").read_text() == "of the capture"
    assert "when muscles fire" in (tmp_path / "timing.html").read_text(encoding="utf-8")
    other = tmp_path / "other"
    assert main(["analyse", str(tmp_path / "performance.npz"), "--out", str(other)]) == 0
    assert "when muscles fire" in (other / "report.html").read_text(encoding="utf-8")


def test_bad_input_is_one_line(tmp_path, capsys):
    assert main(["analyse", str(tmp_path / "none.npz"), "--out", str(tmp_path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_still_clip_gives_tables_without_rows(tmp_path):
    still = make_performance(activations=np.zeros((12, 36)), articulator_values=np.zeros((12, 2)))
    still.save(tmp_path / "performance.npz")
    assert main(["analyse", str(tmp_path / "performance.npz"), "--out", str(tmp_path / "o")]) == 0
    assert len((tmp_path / "o" / "phases.csv").read_text().splitlines()) == 1
