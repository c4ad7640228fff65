# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections of a rendered clip whose mouth something covers while it opens, against its truth."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.commands.cli import main
from mimetic.performance.corrections import (
    FrameCorrection,
    Pinned,
    corrected_frames,
    save_corrections,
)
from mimetic.performance.document import Performance
from mimetic.performance.gaze import seen_articulators
from mimetic.score.truth import Truth
from mimetic.solve.clip_capture import capture, find_face
from mimetic.solve.refining import refined
from mimetic.template.face_template import load_template
from spoilt_clip import FIRST, LAST, cover_mouth, error, pixels_of, places_of

CORRECTED, REACH = (38, 44), 7.0


@pytest.fixture(scope="module")
def spoilt(rendered_clip, tmp_path_factory):
    """Footage, fit and capture of the clip with something before the mouth for a while, truth."""
    footage = tmp_path_factory.mktemp("spoilt") / "spoilt.mp4"
    fit = find_face(rendered_clip.footage, 1)
    cover_mouth(rendered_clip.footage, fit, footage)
    return footage, fit, capture(footage, fit=fit), Truth.load(rendered_clip.truth)


@pytest.fixture(scope="module")
def places(spoilt):
    """Places of the lower face, as pins of the first frame, and their true pixels in all."""
    return places_of(spoilt[2], spoilt[3])


def corrections_of(places, frames=CORRECTED, count=3):
    pins, tracks = places
    chosen = [0, len(pins) // 3, 2 * len(pins) // 3][:count]
    return tuple(
        FrameCorrection(
            frame,
            REACH,
            tuple(replace(pins[k], pixel=tuple(tracks[frame - 1, k]), std=1.0) for k in chosen),
        )
        for frame in frames
    )


def test_pins_in_two_frames_mend_a_covered_mouth(spoilt, places):
    performance = spoilt[2]
    after = refined(performance, corrections_of(places))
    covered = range(FIRST, LAST + 1)
    assert error(performance, places, covered) > 2 * error(after, places, covered)
    assert corrected_frames(after) == list(CORRECTED)


def test_frames_beyond_the_reach_stay(spoilt, places):
    performance = spoilt[2]
    after = refined(performance, corrections_of(places))
    far = np.abs(performance.frame[:, None] - np.array(CORRECTED)).min(axis=1) > REACH
    assert far.sum() > 20
    for key in ("activations", "articulator_values", "head_pose", "activations_std"):
        np.testing.assert_allclose(
            getattr(after, key)[far], getattr(performance, key)[far], atol=1e-6
        )
    np.testing.assert_array_equal(after.quality, performance.quality)


def test_a_pins_own_point_lands_within_its_deviation(spoilt, places):
    corrections = corrections_of(places, CORRECTED[:1], count=1)
    after = refined(spoilt[2], corrections)
    pins = corrections[0].pins
    wanted = np.array([pin.pixel for pin in pins])
    off = pixels_of(after, pins, CORRECTED[:1])[0] - wanted
    assert np.linalg.norm(off, axis=1).max() < 1.0


def test_a_value_is_taken_and_its_neighbours_follow_it(spoilt):
    performance = spoilt[2]
    lid = performance.articulators.index("lid_upper.L")
    correction = FrameCorrection(15, 6, values={"lid_upper.L": Pinned(0.8, 0.02)})
    after = refined(performance, (correction,))
    moved = after.articulator_values[:, lid] - performance.articulator_values[:, lid]
    at = performance.index_of(15)
    assert moved[at] > 0.5
    assert moved[at] > moved[at + 2] > moved[at + 4] > -1e-3
    other = performance.articulators.index("lid_upper.R")
    np.testing.assert_allclose(
        after.articulator_values[:, other], performance.articulator_values[:, other], atol=0.03
    )


def test_a_gaze_is_taken_by_both_eyes_and_moves_no_skin(spoilt, tmp_path):
    performance = spoilt[2]
    at, names = performance.index_of(15), performance.articulators
    yaw = names.index("gaze_yaw.L")
    wanted = performance.articulator_values[at, yaw] + 12
    correction = FrameCorrection(15, 6, values={"gaze_yaw.L": Pinned(wanted, 0.5)})
    after = refined(performance, (correction,))
    moved = after.articulator_values - performance.articulator_values
    assert abs(after.articulator_values[at, yaw] - wanted) < 0.5
    np.testing.assert_allclose(moved[at, names.index("gaze_yaw.R")], 12, atol=2)
    assert moved[at, yaw] > moved[at + 2, yaw] > moved[at + 4, yaw] > 0
    assert not moved[[at - 6, at + 6], yaw].any()
    others = [name.startswith("gaze_yaw") for name in names]
    np.testing.assert_allclose(moved[:, np.logical_not(others)], 0, atol=1e-9)
    np.testing.assert_array_equal(after.activations, performance.activations)
    np.testing.assert_allclose(after.head_pose, performance.head_pose, atol=1e-12)
    after.save(tmp_path / "performance.npz")
    again = refined(Performance.load(tmp_path / "performance.npz"), ())
    assert again.uncorrected is None
    np.testing.assert_allclose(again.articulator_values, performance.articulator_values, atol=1e-9)


def test_lids_stay_where_they_are_seen_as_the_gaze_is_corrected(spoilt):
    performance, values = spoilt[2], {"gaze_pitch.R": Pinned(-20.0, 0.5)}
    after = refined(performance, (FrameCorrection(15, 6, values=values),))
    at, lid = performance.index_of(15), performance.articulators.index("lid_upper.R")
    assert after.articulator_values[at, lid] < performance.articulator_values[at, lid] - 0.05
    np.testing.assert_allclose(
        seen_articulators(after)[at, lid], seen_articulators(performance)[at, lid], atol=1e-6
    )


def test_gaze_is_corrected_beside_skin_and_in_a_file_that_kept_none_of_it(spoilt, places):
    performance, of_skin = spoilt[2], corrections_of(places)
    yaw = performance.articulators.index("gaze_yaw.R")
    values = {"gaze_yaw.R": Pinned(20.0, 0.5)}
    both = tuple(replace(entry, values=values) for entry in of_skin)
    before = refined(performance, of_skin)
    after = refined(performance, both)
    np.testing.assert_array_equal(after.activations, before.activations)
    rows = [performance.index_of(frame) for frame in CORRECTED]
    np.testing.assert_allclose(after.articulator_values[rows, yaw], 20, atol=1)
    older = replace(before, uncorrected=before.uncorrected[:, :-4])
    again = refined(older, both)
    np.testing.assert_allclose(again.articulator_values, after.articulator_values, atol=1e-6)


def test_lips_are_brought_together(spoilt):
    from mimetic.muscles.feature_lines import feature_lines

    performance, lines = spoilt[2], feature_lines(load_template())
    after = refined(performance, (FrameCorrection(15, 6, lip_gap=Pinned(0.004, 2e-4)),))
    at = performance.index_of(15)
    upper, lower = (lines[f"lip_{lip}_inner"] for lip in ("upper", "lower"))
    middle = (upper[len(upper) // 2], lower[len(lower) // 2])
    surface = after.surface(at)
    assert abs(surface[middle[0], 1] - surface[middle[1], 1] - 0.004) < 6e-4


def test_corrections_that_are_gone_are_taken_back(spoilt, places):
    performance = spoilt[2]
    again = refined(refined(performance, corrections_of(places)), ())
    assert again.corrections is None
    assert again.uncorrected is None
    for key in ("activations", "articulator_values", "activations_std", "head_pose", "evidence"):
        np.testing.assert_allclose(
            getattr(again, key), getattr(performance, key), rtol=1e-12, atol=1e-9
        )


def test_what_is_corrected_does_not_depend_on_what_was_before(spoilt, places, tmp_path):
    performance, wanted = spoilt[2], corrections_of(places)
    before = refined(performance, corrections_of(places, (36, 47), count=2))
    before.save(tmp_path / "performance.npz")
    after = refined(Performance.load(tmp_path / "performance.npz"), wanted)
    directly = refined(performance, wanted)
    for key in ("activations", "articulator_values", "activations_std", "head_pose", "evidence"):
        np.testing.assert_allclose(
            getattr(after, key), getattr(directly, key), rtol=1e-9, atol=1e-9
        )


def test_corrections_of_a_file_that_does_not_keep_them_apart_are_solved_away(spoilt, places):
    performance = spoilt[2]
    corrected = replace(refined(performance, corrections_of(places)), uncorrected=None)
    again = refined(corrected, ())
    assert again.corrections is None
    moved = np.abs(corrected.activations - performance.activations).max()
    assert np.abs(again.activations - performance.activations).max() < moved / 4


def test_what_is_kept_of_another_face_is_refused(spoilt, places):
    corrected = refined(spoilt[2], corrections_of(places))
    other = replace(corrected, uncorrected=corrected.uncorrected[:, 3:])
    with pytest.raises(InvalidInput, match=r"uncorrected has \d+ numbers a frame.*capture"):
        refined(other, ())


def test_a_direction_and_a_range_leave_other_frames_alone(spoilt, places):
    performance, corrections = spoilt[2], corrections_of(places)
    rows = {"forward": slice(0, 37), "backward": slice(44, None)}
    for direction, kept in rows.items():
        after = refined(performance, corrections, direction=direction)
        np.testing.assert_array_equal(after.activations[kept], performance.activations[kept])
        assert np.abs(after.activations - performance.activations).max() > 0.05
    after = refined(performance, corrections, frames=(38, 46))
    changed = np.flatnonzero(np.abs(after.activations - performance.activations).max(axis=1) > 1e-9)
    assert changed.min() >= 37 and changed.max() <= 45


def test_a_correction_of_a_frame_that_may_not_change_is_refused(spoilt, places):
    performance, corrections = spoilt[2], corrections_of(places)
    with pytest.raises(InvalidInput, match=r"frame 38 is corrected, but frames 40 to 50 alone"):
        refined(performance, corrections, frames=(40, None))
    # One that is honoured and reaches none of them stays
    early = FrameCorrection(15, 6.0, values={"jaw_open": Pinned(0.3, 0.02)})
    before = refined(performance, (early,))
    after = refined(before, (early, *corrections), frames=(31, None))
    np.testing.assert_array_equal(after.activations[:30], before.activations[:30])
    assert corrected_frames(after) == [15, *CORRECTED]
    changed = replace(early, reach=7.0)
    with pytest.raises(InvalidInput, match="frame 15 is corrected"):
        refined(before, (changed, *corrections), frames=(31, None))


def test_what_limits_kept_of_a_withdrawn_correction_is_taken_back_later(spoilt, places):
    performance = spoilt[2]
    half = refined(refined(performance, corrections_of(places)), (), frames=(1, 40))
    assert half.corrections is None
    assert np.abs(half.activations[40:] - performance.activations[40:]).max() > 0.05
    again = refined(half, ())
    assert again.uncorrected is None
    np.testing.assert_allclose(again.activations, performance.activations, atol=1e-9)


@pytest.mark.parametrize("frame", [37, 38])
def test_nothing_is_solved_over_a_cut(spoilt, places, frame):
    performance = spoilt[2]
    near = replace(performance, scene_starts=np.array([38]))
    poses = performance.head_pose.copy()
    poses[37:, 2, 3] += 0.1  # the evidence is of steps from wherever the head is
    cut = replace(near, head_pose=poses)
    value = FrameCorrection(frame, REACH, values={"jaw_open": Pinned(0.3, 0.02)})
    gaze = FrameCorrection(frame, REACH, values={"gaze_yaw.L": Pinned(20.0, 0.5)})
    other = slice(37, None) if frame == 37 else slice(0, 37)
    for entry in (value, gaze):
        after = refined(cut, (entry,))
        moved = refined(near, (entry,)).head_pose - near.head_pose
        np.testing.assert_allclose(after.head_pose - poses, moved, atol=1e-6)
        for key in ("activations", "articulator_values", "head_pose"):
            np.testing.assert_array_equal(getattr(after, key)[other], getattr(cut, key)[other])
        assert after.scene_starts.tolist() == [38]
        again = refined(after, ())
        assert again.uncorrected is None
        np.testing.assert_allclose(again.head_pose, poses, atol=1e-9)


def test_a_stopped_refinement_changes_nothing(spoilt, places):
    performance = spoilt[2]
    kept = refined(performance, corrections_of(places), progress=lambda *_: False)
    np.testing.assert_array_equal(kept.activations, performance.activations)


def test_a_performance_without_evidence_is_refused(spoilt, places):
    with pytest.raises(InvalidInput, match=r"keeps no evidence.*capture the footage again"):
        refined(replace(spoilt[2], evidence=None), corrections_of(places))


def test_a_capture_honours_them_as_a_refinement_does(spoilt, places, tmp_path):
    footage, fit, performance, _ = spoilt
    corrections = corrections_of(places)
    at_once = capture(footage, fit=fit, corrections=corrections)
    after = refined(performance, corrections)
    np.testing.assert_allclose(at_once.activations, after.activations, atol=1e-3)
    np.testing.assert_allclose(at_once.head_pose, after.head_pose, atol=1e-4)
    assert corrected_frames(at_once) == list(CORRECTED)


def test_the_command_refines_a_file_and_refuses_wrong_ones(spoilt, places, tmp_path, capsys):
    footage, _, performance, _ = spoilt
    file, out = tmp_path / "p.npz", tmp_path / "refined.npz"
    performance.save(file)
    save_corrections(tmp_path / "c.json", corrections_of(places))
    command = ["refine", str(file), str(footage), "--corrections", str(tmp_path / "c.json")]
    assert main([*command, "--out", str(out)]) == 0
    assert corrected_frames(Performance.load(out)) == list(CORRECTED)
    assert "2 frames corrected" in capsys.readouterr().err
    before = file.read_bytes()
    save_corrections(tmp_path / "c.json", (FrameCorrection(900),))
    assert main(command) == 2
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert "corrections of frame 900: the capture has frames 1 to 50" in message
    assert main(["capture", str(footage), "--out", str(tmp_path / "o"), *command[3:]]) == 2
    assert "frame 900: the capture has frames 1 to 50" in capsys.readouterr().err
    assert file.read_bytes() == before
