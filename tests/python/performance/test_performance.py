# SPDX-License-Identifier: GPL-3.0-or-later
import io
import os
import zipfile

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.performance.document import OPTIONAL, REQUIRED, SCHEMA, Performance
from sample_performance import make_performance


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "performance.npz"
    make_performance(notes=["stopped after frame 12"]).save(path)
    return path


def rewrite(path, **changes):
    with np.load(path) as file:
        arrays = dict(file)
    for key, value in changes.items():
        if value is None:
            del arrays[key]
        else:
            arrays[key] = value
    np.savez(path, **arrays)


def test_a_saved_performance_loads_as_it_was(saved):
    before, after = make_performance(), Performance.load(saved)
    for key, (kind, _) in (REQUIRED | OPTIONAL).items():
        if kind != "U" and getattr(before, key) is not None:
            np.testing.assert_array_equal(getattr(before, key), getattr(after, key))
    assert after.muscles == before.muscles and after.articulators == before.articulators
    assert after.notes == ["stopped after frame 12"]
    assert abs(after.fps - 24000 / 1001) < 1e-12


def test_surface_is_neutral_plus_activated_modes():
    performance = make_performance()
    i = 7
    expected = performance.neutral_vertices.copy()
    for k in range(36):
        expected += performance.activations[i, k] * performance.muscle_modes[k]
    for k in range(2):
        expected += performance.articulator_values[i, k] * performance.articulator_modes[k]
    np.testing.assert_allclose(performance.surface(i), expected, atol=1e-7)


def test_surface_in_camera_applies_the_head_pose():
    performance = make_performance()
    rotation, translation = performance.head_pose[3, :3, :3], performance.head_pose[3, :3, 3]
    expected = [rotation @ point + translation for point in performance.surface(3)]
    np.testing.assert_allclose(performance.surface_in_camera(3), expected, atol=1e-12)


def test_details_move_the_surface():
    modes = np.zeros((1, 81, 3))
    modes[0, 40, 2] = 1
    detailed = make_performance(detail_modes=modes, detail_coefficients=np.full((12, 1), 0.01))
    moved = detailed.surface(0) - make_performance().surface(0)
    assert moved[40, 2] == pytest.approx(0.01, abs=1e-6)
    assert np.abs(np.delete(moved, 40, axis=0)).max() < 1e-7


def test_the_schema_has_the_shape_of_the_page(saved):
    with np.load(saved) as file:
        assert file["schema"].shape == (1,)
        assert file["schema"].dtype == np.int64


@pytest.mark.parametrize("key", REQUIRED)
def test_a_missing_key_is_named(saved, key):
    rewrite(saved, **{key: None})
    with pytest.raises(InvalidInput, match=f"lacks the key {key}"):
        Performance.load(saved)


@pytest.mark.parametrize("key", [k for k, (kind, _) in REQUIRED.items() if kind in "fm"])
def test_nan_is_named_with_its_key(saved, key):
    with np.load(saved) as file:
        value = file[key].copy()
    value.reshape(-1)[0] = np.nan
    rewrite(saved, **{key: value})
    with pytest.raises(InvalidInput, match=f"{key} is not finite"):
        Performance.load(saved)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"schema": np.int64(SCHEMA + 1)}, "newer version of Mimetic"),
        ({"schema": None}, "no schema"),
        ({"activations": np.full((11, 36), 0.5)}, "activations has the shape"),
        ({"activations": np.full((12, 36), 1.5)}, "activations must lie in 0 to 1"),
        ({"activations": np.full((12, 36), "x")}, "activations has the type"),
        ({"quality": np.full(12, -1.0)}, "quality must lie in 0 to 1"),
        ({"frame": np.arange(12)}, "frame must count upwards"),
        ({"frame": np.full(12, 3)}, "frame must count upwards"),
        ({"faces": np.full((4, 4), 81)}, "faces name vertices that do not exist"),
        ({"faces": np.zeros((0, 4), np.int64)}, "no faces"),
        ({"head_pose": np.tile(2 * np.eye(4), (12, 1, 1))}, "not a rigid motion at frame 1"),
        ({"head_pose_cov": np.tile(-np.eye(6), (12, 1, 1))}, "not a covariance at frame 1"),
        ({"intrinsics": -np.eye(3)}, "not a pinhole"),
        ({"fps": np.array([0.0])}, "fps is 0"),
        ({"groups": np.full(36, 8)}, "groups must be 1 to 7"),
        ({"muscles": np.full(36, "frontalis")}, "distinct names"),
        ({"detail_modes": np.zeros((1, 81, 3))}, "both or none"),
        ({"frame": np.full(12, None)}, "Python objects"),
        ({"scene_starts": np.array([9, 5])}, "scene_starts must ascend"),
    ],
)
def test_bad_content_is_refused_with_the_reason(saved, changes, message):
    rewrite(saved, **changes)
    with pytest.raises(InvalidInput, match=message):
        Performance.load(saved)


def test_a_small_file_that_claims_terabytes_is_refused_unread(saved, tmp_path):
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (2_000_000, 600_000)}
    )
    bomb = tmp_path / "bomb.npz"
    with zipfile.ZipFile(saved) as source, zipfile.ZipFile(bomb, "w") as target:
        for name in source.namelist():
            if name != "neutral_vertices.npy":
                target.writestr(name, source.read(name))
        target.writestr("neutral_vertices.npy", header.getvalue())
    with pytest.raises(InvalidInput, match="bytes of arrays"):
        Performance.load(bomb)


def test_files_that_are_no_performance_are_refused(tmp_path):
    cases = {"empty.npz": b"", "text.npz": b"hello", "cut.npz": None}
    make_performance().save(tmp_path / "whole.npz")
    cases["cut.npz"] = (tmp_path / "whole.npz").read_bytes()[:-200]
    for name, content in cases.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(UnreadableMedia, match=name):
            Performance.load(tmp_path / name)
    with pytest.raises(UnreadableMedia, match="no such file"):
        Performance.load(tmp_path / "absent.npz")
    with pytest.raises(UnreadableMedia, match="is a folder"):
        Performance.load(tmp_path)


def test_damaged_bytes_inside_are_refused(saved):
    content = bytearray(saved.read_bytes())
    content[len(content) // 2] ^= 0xFF
    saved.write_bytes(content)
    with pytest.raises((UnreadableMedia, InvalidInput)):
        Performance.load(saved)


def test_a_failed_save_leaves_the_old_file_and_no_litter(saved, monkeypatch):
    before = saved.read_bytes()

    def full_disk(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full_disk)
    with pytest.raises(OSError, match="No space left"):
        make_performance().save(saved)
    assert saved.read_bytes() == before
    assert [path.name for path in saved.parent.iterdir()] == [saved.name]


def test_scenes_are_runs_of_rows_and_one_where_no_cut_is_known(tmp_path):
    frame = np.delete(np.arange(13) + 101, 4)
    cut = make_performance(frame=frame, scene_starts=np.array([90, 101, 105, 110, 400]))
    cut.save(tmp_path / "cut.npz")
    scenes = Performance.load(tmp_path / "cut.npz").scenes
    assert scenes == [slice(0, 4), slice(4, 8), slice(8, 12)]
    assert make_performance().scenes == [slice(0, 12)]


def test_frames_are_found_by_number():
    performance = make_performance(frame=np.arange(12) + 101)
    assert performance.index_of(105) == 4
    with pytest.raises(InvalidInput, match="frames 101 to 112"):
        performance.index_of(99)
