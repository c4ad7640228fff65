# SPDX-License-Identifier: GPL-3.0-or-later
from types import SimpleNamespace

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.commands.cli import main
from mimetic.head.tracking import MODELS, UNSEEN_COV, _HeadMotion, head_shape, track_head
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.performance.rows import Rows
from mimetic.report.head_drawing import HeadDrawing
from mimetic.score.truth import Truth
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.template.face_template import load_template


@pytest.fixture(scope="module")
def fit(rest_fit):
    return rest_fit


def degrees_between(poses, others):
    turn = np.einsum("nji,njk->nik", poses[:, :3, :3], others[:, :3, :3])
    return np.degrees(np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1) / 2, -1, 1)))


def turned_since(poses, i):
    return np.einsum("nij,kj->nik", poses[:, :3, :3], poses[i, :3, :3])


@pytest.mark.parametrize("model", ["ellipsoid", "surface"])
def test_the_head_turns_as_it_did(rendered_clip, fit, model):
    result = track_head(rendered_clip.footage, model, (1, 20), fit)
    truth = Truth.load(rendered_clip.truth).head_pose[:20]
    assert result.frame.tolist() == list(range(1, 21))
    assert np.median(result.quality) > 0.5
    start = fit.frame - 1
    apart = degrees_between(turned_since(result.head_pose, start), turned_since(truth, start))
    assert np.median(apart) < 1.5
    assert np.all(result.activations == 0) and np.all(result.activations_std >= 0.2)


def test_models_stand_where_the_head_is(fit):
    template = load_template()
    neutral = fit.neutral_vertices(template)
    shapes = {model: head_shape(model, neutral, template) for model in MODELS}
    ellipsoid = shapes["ellipsoid"]
    assert np.all((ellipsoid.half_axes > 0.05) & (ellipsoid.half_axes < 0.18))
    assert ellipsoid.depth_error < shapes["plane"].depth_error
    vertices, faces = _core.mesh_of_model(ellipsoid)
    radius = np.linalg.norm((vertices - ellipsoid.centre) / ellipsoid.half_axes, axis=1)
    np.testing.assert_allclose(radius, 1, atol=1e-12)
    assert faces.min() == 0 and faces.max() == len(vertices) - 1
    cut, _ = _core.mesh_of_model(ellipsoid, -0.08, 0.05)
    np.testing.assert_allclose((cut[:, 1].min(), cut[:, 1].max()), (-0.08, 0.05), atol=1e-12)
    with pytest.raises(InvalidInput, match="cube"):
        head_shape("cube", neutral, template)


def test_the_drawing_marks_the_head_and_leaves_the_wall(rendered_clip, fit):
    result = track_head(rendered_clip.footage, "ellipsoid", (1, 2), fit)
    shape = head_shape("ellipsoid", result.neutral_vertices, load_template())
    image = Footage(rendered_clip.footage).read(1)
    painted = HeadDrawing(result, shape).paint(image, 0)
    scale = painted.shape[0] // image.shape[0]
    changed = np.any(painted[::scale, ::scale].astype(int) != image, axis=2)
    pixel = result.project(
        (result.head_pose[0, :3, :3] @ shape.centre + result.head_pose[0, :3, 3])[None]
    )
    x, y = np.rint(pixel[0]).astype(int)
    near = changed[y - 20 : y + 20, x - 20 : x + 20]
    assert near.mean() > 0.05


def test_the_command_writes_motion_overlay_and_plot(rendered_clip, fit, tmp_path):
    fit.save(tmp_path / "fit.json")
    arguments = ["head", str(rendered_clip.footage), "--out", str(tmp_path / "out")]
    arguments += ["--frames", "1:4", "--model", "plane", "--fit", str(tmp_path / "fit.json")]
    assert main(arguments) == 0
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"performance.npz", "fit.json", "overlay.mp4", "motion.png"}
    assert Performance.load(tmp_path / "out/performance.npz").num_frames == 4


def test_a_stopped_run_keeps_and_marks_what_is_done(rendered_clip, fit):
    calls = []

    def progress(fraction, text):
        calls.append(fraction)
        return len(calls) < 6

    summary = CaptureSummary()
    result = track_head(
        rendered_clip.footage, "ellipsoid", (fit.frame, None), fit, progress, summary
    )
    assert summary.stopped and result.num_frames == 6
    assert any("stopped by the user" in note for note in result.notes)


def test_bad_input_is_told_in_one_line(rendered_clip, tmp_path, capsys):
    out = ["--out", str(tmp_path / "out")]
    assert main(["head", str(tmp_path / "absent.mp4"), *out]) == 2
    assert main(["head", str(rendered_clip.footage), *out, "--model", "cube"]) == 2
    assert main(["head", str(rendered_clip.footage), *out, "--frames", "90000:90010"]) == 2
    assert "it has frames 1 to" in capsys.readouterr().err.splitlines()[-1]


class StandInClip:
    """The footage of a walk whose reference is frame 5."""

    def __init__(self, seconds_a_frame):
        self.footage = SimpleNamespace(time_of=lambda frame: frame * seconds_a_frame)
        self.fit = SimpleNamespace(frame=5)


@pytest.mark.parametrize("seconds_a_frame", [1 / 24, 1 / 60])
def test_a_lost_heads_covariance_grows_with_the_time_since_it_was_seen(seconds_a_frame):
    def estimate(held=False):
        covariance = (4 if held else 1) * 1e-5 * np.eye(6)
        return SimpleNamespace(
            held=held,
            camera_from_head=np.eye(4),
            covariance=covariance,
            quality=0.1 + 0.8 * (not held),
        )

    motion = _HeadMotion.__new__(_HeadMotion)
    motion.walk = StandInClip(seconds_a_frame)
    seen = [None, estimate(True), None, estimate(True), estimate(), None]
    for way in (1, -1):
        rows = Rows()
        motion._append(rows, [(5 + way * n, one) for n, one in enumerate(seen, 1)], estimate())
        variances = np.array(rows.pose_cov)[:, 0, 0]
        np.testing.assert_allclose(np.diff(variances[:4]), UNSEEN_COV[0, 0] * seconds_a_frame)
        assert variances[0] > variances[4] == 1e-5
        assert variances[5] == pytest.approx(variances[0])
        assert rows.quality == [0, 0, 0, 0, 0.9, 0]


def test_a_tracker_refuses_frames_of_another_size(rendered_clip, fit):
    template = load_template()
    shape = head_shape("ellipsoid", fit.neutral_vertices(template), template)
    image = np.ascontiguousarray(Footage(rendered_clip.footage).read(fit.frame))
    tracker = _core.HeadTracker(fit.camera, shape, image, fit.head_pose)
    with pytest.raises(InvalidInput, match="camera"):
        tracker.advance(np.ascontiguousarray(image[:100]))
    with pytest.raises(InvalidInput, match="2 poses for 1 reference"):
        tracker.move_views([fit.head_pose, fit.head_pose])
    assert tracker.place_on(head_shape("surface", fit.neutral_vertices(template), template)) == []
