# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores mean what they say, bad truth is refused, rendered truth agrees with its picture."""

import argparse
import dataclasses
import json

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.evaluate import Truth, expression_tables, flow, scores
from mimetic.evaluate.command import add_arguments, run_evaluate
from mimetic.evaluate.curves import onset_and_peak, timing_errors
from mimetic.evaluate.deviation import Explained
from mimetic.evaluate.drift import drift_of
from mimetic.evaluate.expressions import Take, shown_expressions
from mimetic.evaluate.methods import Motion
from mimetic.evaluate.peers import dis_tracks
from mimetic.evaluate.prediction import follow
from mimetic.evaluate.score import score
from mimetic.evaluate.tables import as_json, as_text, summary
from mimetic.evaluate.vertex_flow import SeenVertices
from mimetic.footage import Footage
from sample_performance import make_performance


def make_truth(performance, num_points=40, **changes):
    """Truth that a performance explains exactly: points of its own surface."""
    rng = np.random.default_rng(3)
    middle = performance.image_size / 2
    pixels = middle + rng.uniform(-25, 25, (num_points, 2))
    followed = follow(performance, pixels)
    values = {
        "frame": performance.frame,
        "fps": performance.fps,
        "image_size": performance.image_size,
        "intrinsics": performance.intrinsics,
        "head_pose": performance.head_pose,
        "points": followed.points,
        "tracks": followed.tracks,
        "visible": np.ones(followed.tracks.shape[:2], bool),
        "muscles": performance.muscles,
        "groups": performance.groups,
        "activations": performance.activations,
    }
    return Truth(**(values | changes))


@pytest.fixture
def performance():
    return make_performance(num_frames=40)


@pytest.fixture
def truth(performance):
    return make_truth(performance)


def test_a_performance_that_is_the_truth_scores_one(performance, truth):
    made = score(truth, performance)
    assert made.on_face == 1
    assert made.image["mimetic"]["nonrigid_r2"] == pytest.approx(1, abs=1e-6)
    assert made.surface["r2"] == pytest.approx(1, abs=1e-6)
    assert made.head["largest_deg"] < 1e-6
    assert made.overall["rmse"] == 0
    assert min(curve["correlation"] for curve in made.controls.values()) == pytest.approx(1)


def test_head_motion_alone_explains_none_of_the_non_rigid_motion(performance, truth):
    made = score(truth, performance).image["its head motion alone"]
    assert abs(made["nonrigid_r2"]) < 0.35  # frame 1 of the sample is not at rest
    assert made["r2"] > made["nonrigid_r2"]


def test_r2_is_that_of_a_known_error(truth):
    rigid = scores.project(truth.points[:1], truth.head_pose, truth.intrinsics)
    halfway = (truth.tracks + rigid) / 2
    made = scores.image_motion(truth.tracks, rigid, truth.visible, halfway)
    assert made["nonrigid_r2"] == pytest.approx(0.75)
    unmoved = np.repeat(truth.tracks[:1], len(truth.frame), axis=0)
    still = scores.image_motion(truth.tracks, rigid, truth.visible, unmoved)
    assert still["r2"] == pytest.approx(0)


def test_a_still_face_has_no_r2(truth):
    still = np.repeat(truth.points[:1], len(truth.frame), axis=0)
    rigid = scores.project(still, truth.head_pose, truth.intrinsics)
    made = scores.image_motion(rigid + 1e-6, rigid, truth.visible, rigid)
    assert np.isnan(made["nonrigid_r2"])
    assert np.isnan(scores.surface_motion(still, truth.visible, still)["r2"])


def test_hidden_points_do_not_count(truth):
    rigid = scores.project(truth.points[:1], truth.head_pose, truth.intrinsics)
    seen = truth.visible.copy()
    seen[:, 0] = False
    wrong = truth.tracks.copy()
    wrong[:, 0] += 50
    assert scores.image_motion(truth.tracks, rigid, seen, wrong)["r2"] == pytest.approx(1)


def test_surface_score_does_not_depend_on_where_the_head_frame_lies(truth):
    angle = 0.2
    turn = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    moved = truth.points @ turn.T + (0.01, 0.02, -0.01)
    made = scores.surface_motion(truth.points, truth.visible, moved)
    assert made["r2"] == pytest.approx(1, abs=1e-9)
    assert made["neutral_shape_median_mm"] < 1e-6


@pytest.mark.parametrize(("axis", "name"), [(0, "pitch_deg"), (1, "yaw_deg"), (2, "roll_deg")])
def test_a_turn_too_far_shows_on_its_axis(axis, name):
    degrees = np.linspace(0, 3, 31)
    pose = np.tile(np.eye(4), (31, 1, 1))
    for i, angle in enumerate(np.radians(degrees)):
        a, b = [k for k in range(3) if k != axis]
        pose[i, a, a] = pose[i, b, b] = np.cos(angle)
        pose[i, a, b], pose[i, b, a] = -np.sin(angle), np.sin(angle)
    made = scores.head_motion(np.tile(np.eye(4), (31, 1, 1)), pose)
    assert made[name] == pytest.approx(np.abs(degrees[1:]).mean())
    assert made["largest_deg"] == pytest.approx(3)
    assert sum(made[key] for key in ("pitch_deg", "yaw_deg", "roll_deg")) == pytest.approx(
        made[name]
    )


def test_lag_is_found_within_a_tenth_of_a_frame():
    time = np.arange(60.0)

    def curve(start):
        return 1 / (1 + np.exp(-(time - start) / 2))

    assert scores.lag_frames(curve(20), curve(22.5)) == pytest.approx(2.5, abs=0.1)


def test_intervals_hold_nine_in_ten_only_if_the_deviations_are_honest():
    rng = np.random.default_rng(0)
    true = np.tile(np.linspace(0, 1, 2000)[:, None], (1, 5))
    estimated = true + rng.normal(0, 0.1, true.shape)
    std = np.full(true.shape, 0.1)
    assert scores.activations(true, estimated, std)["coverage_90"] == pytest.approx(0.9, abs=0.02)
    assert scores.activations(true, estimated, std / 3)["coverage_90"] < 0.5


def test_a_silent_muscle_that_moves_is_a_false_activation():
    true = np.zeros((20, 2))
    true[:, 0] = np.linspace(0, 1, 20)
    estimated = true.copy()
    estimated[7, 1] = 0.3
    made = scores.activations(true, estimated, np.ones(true.shape))
    assert made["largest_false"] == pytest.approx(0.3)
    assert made["rmse_active"] == 0


def test_a_face_elsewhere_in_the_image_is_an_error(performance):
    with pytest.raises(InvalidInput, match="covers no point"):
        follow(performance, np.array([[2.0, 2.0]]))


def test_dis_flow_follows_a_sliding_picture():
    rng = np.random.default_rng(1)
    coarse = np.kron(rng.integers(40, 216, (24, 32)), np.ones((10, 10)))
    kernel = np.ones(7) / 7
    for axis in (0, 1):
        coarse = np.apply_along_axis(np.convolve, axis, coarse, kernel, "same")
    images = [
        np.repeat(np.roll(coarse, 2 * i, 1)[..., None], 3, 2).astype(np.uint8) for i in range(5)
    ]
    start = np.array([[100.0, 80.0], [200.0, 150.0]])
    for tracks in dis_tracks(images, start).values():
        np.testing.assert_allclose(tracks[4], start + np.array([8, 0]), atol=0.3)


def test_files_of_different_frames_are_scored_on_those_they_share(performance, truth):
    late = dataclasses.replace(truth, frame=truth.frame + 30)
    assert score(late, performance).num_frames == 10
    with pytest.raises(InvalidInput, match="share 0 frames"):
        score(dataclasses.replace(truth, frame=truth.frame + 300), performance)
    other = dataclasses.replace(truth, image_size=np.array([640, 480]))
    with pytest.raises(InvalidInput, match="not of the same footage"):
        score(other, performance)


def test_truth_comes_back_as_saved(tmp_path, truth):
    truth.save(tmp_path / "truth.npz")
    loaded = Truth.load(tmp_path / "truth.npz")
    np.testing.assert_array_equal(loaded.tracks, truth.tracks)
    assert loaded.muscles == truth.muscles
    assert loaded.fps == truth.fps
    assert [path.name for path in tmp_path.iterdir()] == ["truth.npz"]


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("tracks", None, "lacks the key tracks"),
        ("tracks", np.zeros((3, 2, 2)), "tracks has the shape"),
        ("points", "nan", "points is not finite"),
        ("visible", np.zeros((40, 40)), "visible has the type"),
        ("schema", np.array([2]), "schema 2"),
        ("units", np.array(["jawOpen"]), "both or none of units and unit_values"),
        ("muscles", np.array([{}], object), "Python objects"),
    ],
)
def test_a_wrong_truth_file_is_refused(tmp_path, truth, key, value, said):
    path = tmp_path / "truth.npz"
    truth.save(path)
    arrays = dict(np.load(path))
    if value is None:
        del arrays[key]
    elif isinstance(value, str):
        arrays[key][1, 1] = float(value)
    else:
        arrays[key] = value
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match=said):
        Truth.load(path)


def test_no_file_and_no_archive_are_unreadable(tmp_path):
    with pytest.raises(UnreadableMedia, match="no such file"):
        Truth.load(tmp_path / "absent.npz")
    (tmp_path / "text.npz").write_text("not an archive")
    with pytest.raises(UnreadableMedia, match="damaged"):
        Truth.load(tmp_path / "text.npz")


def test_reports_hold_the_figures(performance, truth):
    made = score(truth, performance, "clip")
    assert "R2 non-rigid" in as_text(made)
    assert "1.000" in summary([made])
    (read,) = json.loads(as_json([made]))
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


def evaluate_options(**given):
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    options = parser.parse_args([])
    for name, value in given.items():
        setattr(options, name, value)
    return options


def test_people_of_tuning_and_held_out_clips_do_not_meet():
    from evaluation.expressions.recipes import SETS as EXPRESSIONS
    from evaluation.recipes import HELD_OUT, SETS

    held_out = {recipe.seed for recipe in HELD_OUT}
    held_out |= {take.recipe.seed for take in EXPRESSIONS["full"]}
    others = {r.seed for name, rs in SETS.items() if name != "held-out" for r in rs}
    others |= {take.recipe.seed for take in EXPRESSIONS["full-tuning"]}
    assert min(held_out) >= 100 > max(others)


def test_every_expression_is_shown_by_ten_people():
    from evaluation.expressions.recipes import SETS

    shown = [name for take in SETS["full"] for name in take.expressions]
    assert {shown.count(name) for name in shown} == {10}
    assert len({take.recipe.seed for take in SETS["full"]}) == 30


def test_rendered_truth_agrees_with_its_picture(rendered_clip):
    """Patches about the points look alike where truth says they went, and less so 2 px beside."""
    truth = Truth.load(rendered_clip.truth)
    images = [image.mean(2) for _, image in Footage(rendered_clip.footage)]
    assert len(images) == len(truth.frame)
    last = int(np.linalg.norm(truth.tracks - truth.tracks[0], axis=2).mean(1).argmax())
    at = truth.visible[last] & truth.visible[0]
    first, moved = truth.tracks[0][at], truth.tracks[last][at]
    right = _likeness(images[0], images[last], first, moved)
    for offset in ((2, 0), (-2, 0), (0, 2), (0, -2)):
        assert right > _likeness(images[0], images[last], first, moved + offset) + 0.1
    assert right > 0.6


def _likeness(a, b, at_a, at_b, reach=4):
    """Median correlation of the patches about pixels of two grey images."""
    from mimetic.evaluate.peers import sampled

    steps = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1.0)] * 2), 2).reshape(-1, 2)
    patches = [
        sampled(im[..., None], at[:, None] + steps)[..., 0] for im, at in ((a, at_a), (b, at_b))
    ]
    patches = [p - p.mean(1, keepdims=True) for p in patches]
    norms = [np.linalg.norm(p, axis=1) for p in patches]
    return np.median((patches[0] * patches[1]).sum(1) / (norms[0] * norms[1]))


def test_the_true_surface_scores_well_on_the_rendered_clip(rendered_clip):
    """The clip's own person and motion as a performance: what a perfect capture would score."""
    truth = Truth.load(rendered_clip.truth)
    made = score(
        truth, true_performance(truth), images=(i for _, i in Footage(rendered_clip.footage))
    )
    assert made.image["mimetic"]["nonrigid_r2"] > 0.97
    assert abs(made.image["its head motion alone"]["nonrigid_r2"]) < 0.05
    assert made.surface["r2"] > 0.97
    for peer in ("chained", "direct"):
        assert made.image[f"DIS flow, {peer}"]["r2"] > 0.8


def true_performance(truth):
    from mimetic.face_template import load_template

    template = load_template()
    moving = [u for u, name in enumerate(truth.units) if truth.unit_values[:, u].max() > 0]
    num_frames = len(truth.frame)
    modes = np.zeros((36, *template.vertices.shape), np.float32)
    activations = np.zeros((num_frames, 36))
    modes[: len(moving)] = template.unit_modes[moving]
    activations[:, : len(moving)] = truth.unit_values[:, moving]
    return make_performance(
        num_frames,
        frame=truth.frame,
        fps=truth.fps,
        image_size=truth.image_size,
        intrinsics=truth.intrinsics,
        head_pose=truth.head_pose,
        muscle_modes=modes,
        activations=activations,
        articulators=[],
        articulator_values=np.zeros((num_frames, 0)),
        articulator_modes=None,
        neutral_vertices=truth.neutral_vertices,
        faces=template.faces,
    )


def test_onset_and_peak_are_read_between_frames():
    time = np.arange(30.0)
    curve = np.interp(time, [5, 10, 14, 20], [0, 1, 1, 0])
    onset, peak = onset_and_peak(curve)
    assert onset == pytest.approx(6, abs=0.05)
    assert peak == pytest.approx((9.5 + 14.6) / 2, abs=0.05)
    late = {"a": (curve, np.interp(time - 2.5, time, curve)), "b": (curve, curve)}
    errors = timing_errors(late, slice(0, 30))
    assert errors["onset"] == pytest.approx([2.5, 0], abs=0.3)
    assert errors["delay"] == pytest.approx([2.5], abs=0.3)


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


def test_vertices_on_the_flow_follow_a_rigid_head(performance, truth):
    """Where the flow is a rigid motion, nothing moves in the head frame."""
    seen = SeenVertices.under(performance, truth.tracks[0])
    poses = performance.head_pose
    tracks = scores.project(seen.neutral[None], poses, performance.intrinsics)
    points = seen.points(tracks)
    np.testing.assert_allclose(points - points[:1], 0, atol=2e-5)


def test_flow_that_knows_its_error_has_the_normalised_error_two():
    rng = np.random.default_rng(4)
    std = rng.uniform(0.05, 0.5, 20000)
    off = rng.normal(0, 1, (20000, 2)) * std[:, None]
    error = np.linalg.norm(off, axis=1)
    honest = flow.by_decile(flow.FlowErrors(std**2, error, (error / std) ** 2))
    for row in honest.values():
        assert row["normalised"] == pytest.approx(2, abs=0.25)
        assert row["typical"] == pytest.approx(2, abs=0.25)
        assert row["rms"] == pytest.approx(row["std"], rel=0.08)
    assert honest["tenth 1"]["std"] < 0.1 < honest["tenth 10"]["std"]


def test_flow_is_compared_with_the_true_motion_of_points(truth):
    """A picture that does not move, of points that do: the error is their motion."""
    noise = np.random.default_rng(6).integers(0, 255, tuple(truth.image_size[::-1]), np.uint8)
    moving = dataclasses.replace(truth, tracks=truth.tracks[:1] + np.arange(40)[:, None, None])
    pairs = list(flow.flow_errors(moving, [noise] * 3, "dis", 2))
    assert len(pairs) == 1
    np.testing.assert_allclose(pairs[0].error, 2 * np.sqrt(2), atol=0.2)
    assert (pairs[0].normalised > 0).all()
