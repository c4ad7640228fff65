# SPDX-License-Identifier: GPL-3.0-or-later
import tracemalloc

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.cli import main
from mimetic.commands.points import read_points, track_points, write_tracks
from mimetic.performance.document import Performance
from sample_performance import make_performance


def still_performance(**changes):
    """The sample without expression, so that a rigid motion is all there is."""
    return make_performance(
        activations=np.zeros((12, 36)), articulator_values=np.zeros((12, 2)), **changes
    )


def test_in_its_own_frame_a_point_stays_where_it_is():
    performance = make_performance()
    points = np.array([[150.0, 100.0], [170.25, 130.5], [140.0, 140.75]])
    for frame in (1, 7, 12):
        result = track_points(performance, points, frame)
        assert result.on_face.all()
        np.testing.assert_allclose(result.tracks[frame - 1], points, atol=1e-6)
        assert result.visible[frame - 1].all()


def test_points_follow_the_heads_motion():
    performance = still_performance()
    points = np.array([[150.0, 100.0], [165.0, 125.0]])
    result = track_points(performance, points, 1)
    rays = np.column_stack([points, np.ones(2)]) @ np.linalg.inv(performance.intrinsics).T
    pose = performance.head_pose
    # The sample's neutral is z = 0.08 - 4 x^2 - 3 y^2, seen from 0.7 m.
    for k, ray in enumerate(rays):
        depth = 0.6
        for _ in range(50):
            x, y = ray[0] * depth, -ray[1] * depth
            depth = 0.7 - (0.08 - 4 * x**2 - 3 * y**2)
        place = np.array([x, y, 0.7 - depth, 1.0])
        for i in range(performance.num_frames):
            pixel = performance.project((pose[i] @ place)[None, :3])[0]
            # the limit surface lies inside of the control mesh by some tenths of a millimetre
            np.testing.assert_allclose(result.tracks[i, k], pixel, atol=0.6)


def test_pixels_beside_the_face_are_not_on_it():
    result = track_points(make_performance(), np.array([[5.0, 5.0], [159.5, 119.5], [1e6, -1e6]]))
    assert result.on_face.tolist() == [False, True, False]
    assert np.isnan(result.tracks[:, [0, 2]]).all() and not result.visible[:, [0, 2]].any()
    assert np.isfinite(result.tracks[:, 1]).all()


def test_a_point_that_turns_away_is_not_visible():
    turned = make_performance().head_pose.copy()
    turned[6] = turned[6] @ np.diag([-1.0, 1, -1, 1])  # the back of the head
    result = track_points(still_performance(head_pose=turned), np.array([[159.5, 119.5]]), 1)
    assert result.visible[:6, 0].all() and result.visible[7:, 0].all()
    assert not result.visible[6, 0]
    # Nor is anything under a pixel where all of the sample's skin faces away
    away = track_points(still_performance(head_pose=turned), np.array([[159.5, 119.5]]), 7)
    assert not away.on_face.any()


def test_the_command_writes_the_tracks(tmp_path, capsys):
    make_performance().save(tmp_path / "p.npz")
    (tmp_path / "at.csv").write_text("x,y\n150,100\n5,5\n")
    arguments = ["points", tmp_path / "p.npz", "--at", tmp_path / "at.csv", "--frame", "3"]
    assert main([str(word) for word in (*arguments, "--out", tmp_path / "t.npz")]) == 0
    assert "1 of 2 points on the face" in capsys.readouterr().out
    with np.load(tmp_path / "t.npz") as tracks:
        assert tracks["tracks"].shape == (12, 2, 2)
        assert tracks["visible"].shape == (12, 2) and tracks["visible"].dtype == bool
        assert tracks["on_face"].tolist() == [True, False]
        np.testing.assert_allclose(tracks["tracks"][2, 0], [150, 100], atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2\n3,4\n", "first line must be x,y"),
        ("x,y\n", "no points"),
        ("x,y\n1,2\n3\n", "line 3"),
        ("x,y\n1,two\n", "line 2"),
        ("x,y\nnan,2\n", "must be finite"),
        ("x,y\n1,2,3\n", "line 2"),
        ("", "first line must be x,y"),
        ("x,y\n\x00\n", "line 2|not a table"),
    ],
)
def test_bad_tables_are_refused_with_the_line(tmp_path, text, message):
    (tmp_path / "at.csv").write_text(text)
    with pytest.raises(InvalidInput, match=message):
        read_points(tmp_path / "at.csv")


def test_a_missing_table_and_a_missing_frame_are_named(tmp_path):
    with pytest.raises(UnreadableMedia, match=r"absent\.csv"):
        read_points(tmp_path / "absent.csv")
    with pytest.raises(InvalidInput, match="frame 99"):
        track_points(make_performance(), np.zeros((1, 2)), 99)


def test_the_table_may_have_a_byte_order_mark_and_windows_lines(tmp_path):
    (tmp_path / "at.csv").write_bytes(b"\xef\xbb\xbfx,y\r\n1.5,2\r\n")
    np.testing.assert_array_equal(read_points(tmp_path / "at.csv"), [[1.5, 2]])


def test_a_performance_loaded_again_gives_the_same_tracks(tmp_path):
    performance = make_performance()
    performance.save(tmp_path / "p.npz")
    points = np.array([[150.0, 100.0]])
    again = track_points(Performance.load(tmp_path / "p.npz"), points)
    np.testing.assert_allclose(again.tracks, track_points(performance, points).tracks, atol=1e-9)


def test_points_are_followed_alike_whoever_is_with_them():
    performance = make_performance()
    x, y = np.meshgrid(np.arange(90.0, 230, 7), np.arange(60.0, 180, 7))
    points = np.column_stack([x.ravel(), y.ravel()])
    together = track_points(performance, points)
    assert 50 < together.on_face.sum() < len(points)
    for k in (0, 57, 133, 160):
        alone = track_points(performance, points[k : k + 1])
        assert alone.on_face[0] == together.on_face[k]
        np.testing.assert_allclose(alone.tracks[:, 0], together.tracks[:, k], atol=1e-9)
        np.testing.assert_array_equal(alone.visible[:, 0], together.visible[:, k])


def test_tracks_of_many_points_are_written_frame_by_frame(tmp_path):
    num_frames, num_points = 400, 5000

    def frames():
        for i in range(num_frames):
            yield np.full((num_points, 2), float(i)), np.arange(num_points) % 3 == i % 3

    tracemalloc.start()
    write_tracks(tmp_path / "t.npz", num_frames, np.ones(num_points, dtype=bool), frames())
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8e6  # bytes; the tracks are 32 MB
    with np.load(tmp_path / "t.npz", allow_pickle=False) as tracks:
        assert tracks["tracks"].shape == (num_frames, num_points, 2)
        np.testing.assert_array_equal(tracks["tracks"][:, 7, 1], np.arange(num_frames))
        np.testing.assert_array_equal(tracks["visible"][1], np.arange(num_points) % 3 == 1)
        assert tracks["on_face"].all() and tracks["on_face"].dtype == bool


def test_the_command_tells_how_far_it_is(tmp_path, capsys, monkeypatch):
    make_performance().save(tmp_path / "p.npz")
    (tmp_path / "at.csv").write_text("x,y\n150,100\n")
    monkeypatch.setattr("mimetic.commands.console.PLAIN_EVERY", 0.0)
    words = ("points", tmp_path / "p.npz", "--at", tmp_path / "at.csv", "--out", tmp_path / "t.npz")
    assert main([str(word) for word in words]) == 0
    message = capsys.readouterr().err
    assert "looking for the skin" in message and "following: frame 12" in message
