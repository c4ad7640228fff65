# SPDX-License-Identifier: GPL-3.0-or-later
import csv
import re
from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.analyse.comparison import PlaceMotion, compare
from mimetic.analyse.comparison_report import FILES
from mimetic.analyse.timing import analyse_timing
from mimetic.commands.cli import main
from mimetic.muscles.action_units import action_unit, unit_names
from mimetic.template.face_template import load_template
from sample_performance import make_performance

FRAMES = 50


@pytest.fixture(scope="module")
def template():
    return load_template()


WHOLE = (12, 22, 30, 40), (0, 0.8, 0.8, 0)
RELEASED = (0, 20), (0.8, 0)
RISING = (0, 8, 16, 30), (0.5, 0.8, 0.8, 0)  # from a half on
HALVED = (0, 6, 20, 32, 45), (0.6, 0.8, 0.35, 0.8, 0)  # and risen again


def moved_by(template, unit, further=0.0, course=WHOLE):
    """A performance of one muscle whose mode is an action unit, and whatever moves the forehead.

    course: rows and values between which the muscle goes straight.
    """
    mode = action_unit(unit, template.vertices, template).mode
    modes = np.zeros((4, *mode.shape), np.float32)
    modes[0] = mode
    modes[1, template.landmark("glabella")] = (0, further, 0)
    ramp = np.interp(np.arange(FRAMES), *course)
    activations = np.zeros((FRAMES, 4))
    activations[:, :2] = ramp[:, None]
    return make_performance(
        FRAMES,
        muscles=[f"muscle_{i}.{side}" for i in range(2) for side in "LR"],
        groups=np.array([1, 1, 5, 5]),
        muscle_modes=modes,
        activations=activations,
        activations_std=np.full((FRAMES, 4), 0.02),
        articulators=[],
        articulator_values=np.zeros((FRAMES, 0)),
        articulator_modes=None,
        neutral_vertices=template.vertices,
        faces=template.faces,
        quality=np.ones(FRAMES),
    )


def test_a_face_moved_by_a_unit_alone_has_no_energy_outside(template):
    timing = analyse_timing(moved_by(template, "AU12"), kinds=("group",))
    comparison = compare(timing, "AU12", template)
    assert comparison.spatial.intensity == pytest.approx(0.8, abs=0.01)
    assert comparison.spatial.outside_share < 1e-6
    assert comparison.spatial.inside_explained > 0.999
    assert comparison.temporal.rank_one_share > 0.9999
    assert comparison.temporal.ramp_explained > 0.99
    assert {motion.verdict for motion in comparison.places if motion.seen < 1e-6} <= {
        *("no", "not decidable")
    }


@pytest.mark.parametrize(
    ("seen", "unit", "std", "verdict"),
    [
        (2.5, 0.4, 1.0, "yes"),
        (2.5, 0.6, 1.0, "not decidable"),
        (2.5, 4.4, 1.0, "not decidable"),
        (2.5, 4.6, 1.0, "no"),  # the unit moves further
        (0.7, 0.0, 0.4, "no"),  # and here nothing moves
        (1.1, 0.0, 0.6, "not decidable"),
    ],
)
def test_a_place_moves_more_than_the_unit_or_less_by_two_deviations(seen, unit, std, verdict):
    assert PlaceMotion("temples", seen, unit, std, True).verdict == verdict


def test_motion_elsewhere_is_energy_outside(template):
    timing = analyse_timing(moved_by(template, "AU12", further=0.03), kinds=("group",))
    spatial = compare(timing, "AU12", template).spatial
    assert spatial.outside_share > 0.02
    assert spatial.outside_far_share > 0.8 * spatial.outside_share  # of another group, high above


@pytest.mark.parametrize("course", [RELEASED, RISING])
def test_what_is_there_when_its_scene_begins_is_measured_from_its_release(template, course):
    timing = analyse_timing(moved_by(template, "AU12", course=course), kinds=("group",))
    with pytest.raises(InvalidInput, match=r"or name one by --event \(1\)"):
        compare(timing, "AU12", template)
    comparison = compare(timing, "AU12", template, 1)
    assert not comparison.is_onset_seen and comparison.rest == len(comparison.rows) - 1
    assert comparison.spatial.intensity == pytest.approx(0.8, abs=0.01)
    assert comparison.spatial.outside_share < 1e-6
    assert len(comparison.course) == len(comparison.ramp) == len(comparison.rows)
    apex = int(course is RISING) * 8
    assert comparison.course[apex] == pytest.approx(1) and comparison.ramp[apex] > 0.9


def test_what_is_never_at_rest_is_refused_and_not_advised(template):
    timing = analyse_timing(moved_by(template, "AU12", course=HALVED), kinds=("group",))
    assert timing.of_group(1)[0].fit.begins_before
    with pytest.raises(InvalidInput, match="already in its first frame 1 and still in its last"):
        compare(timing, "AU12", template, 1)
    alone = replace(timing, events=timing.of_group(1)[:1])
    with pytest.raises(InvalidInput, match=r"capture more of it$"):
        compare(alone, "AU12", template)


def test_units_are_even_and_move_as_their_names_say(template):
    vertices = template.vertices
    for name in unit_names():
        mode = action_unit(name, vertices, template).mode
        np.testing.assert_allclose(mode[template.mirror] * (-1, 1, 1), mode, atol=5e-4)
    brow = action_unit("2", vertices, template).mode[template.landmark("brow_middle.L")]
    assert brow[1] == pytest.approx(0.013, abs=0.004)  # science: 13 mm up
    corner = action_unit("AU12", vertices, template).mode[template.landmark("mouth_corner.L")]
    assert corner[0] > 0.004 and corner[1] > 0.004 and corner[2] < 0
    with pytest.raises(InvalidInput, match="AU6 is no action unit"):
        action_unit("AU6", vertices, template)


def test_the_command_writes_figures_and_the_numbers_behind_them(tmp_path, template):
    moved_by(template, "AU12").save(tmp_path / "performance.npz")
    out = tmp_path / "out"
    command = ["compare", str(tmp_path / "performance.npz"), "--with", "facs", "--out", str(out)]
    assert main([*command, "--expression", "AU12"]) == 0
    assert {path.name for path in out.iterdir()} == set(FILES)
    with open(out / "comparison.csv", newline="") as stream:
        [row] = csv.DictReader(stream)
    assert float(row["outside_energy"]) < 0.05


def test_an_onset_that_is_not_seen_is_said(tmp_path, template, capsys):
    moved_by(template, "AU12", course=RELEASED).save(tmp_path / "performance.npz")
    out = tmp_path / "out"
    command = ["compare", str(tmp_path / "performance.npz"), "--out", str(out), "--event", "1"]
    assert main(command) == 0
    with open(out / "comparison.csv", newline="") as stream:
        [row] = csv.DictReader(stream)
    assert row["begins_before_clip"] == "1" and row["rest_frame"] == row["last_frame"]
    assert row["application_line_r2"] == row["best_ramp_r2"] == ""
    words = "onset is not seen, as it is there when its scene begins: displacements are from frame"
    words += f" {row['rest_frame']}"
    assert words in capsys.readouterr().out
    page = (out / "report.html").read_text(encoding="utf-8")
    assert words in page and "nan" not in re.sub("src='[^']*'", "", page)


def test_bad_input_is_one_line(tmp_path, template, capsys):
    path = tmp_path / "performance.npz"
    moved_by(template, "AU12").save(path)
    out = ["--out", str(tmp_path / "out")]
    assert main(["compare", str(path), "--expression", "AU6", *out]) == 2
    assert "known are AU1" in capsys.readouterr().err
    assert main(["compare", str(path), "--event", "9", *out]) == 2
    assert "group 1 has 1 event (phases.csv" in capsys.readouterr().err
    assert main(["compare", str(path), "--expression", "AU2", *out]) == 2
    assert "no event that is certain" in capsys.readouterr().err
    make_performance().save(path)
    assert main(["compare", str(path), *out]) == 2
    assert "canonical head" in capsys.readouterr().err
