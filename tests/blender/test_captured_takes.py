# SPDX-License-Identifier: GPL-3.0-or-later
"""Captured takes of a clip: a row a performance file, which of them is used, and files that go."""

import dataclasses
import os
from pathlib import Path

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from scene_state import in_window
from test_clips import films  # noqa: F401 # a fixture


@pytest.fixture
def captured(scene, films, sheet, tmp_path):  # noqa: F811
    """A clip with two captured takes, of which the second, corrected and shorter, is used."""
    bpy.ops.mimetic.load_clip(filepath=str(films[0]))
    quality = np.ones(40)
    quality[[4, 5, 6]] = 0.1
    first = dataclasses.replace(sheet, quality=quality, notes=["calibrated to this person: skin"])
    first.save(tmp_path / "anna.performance.npz")
    corrections = ['{"frame": 7, "values": {"jaw_open": {"value": 0.4, "std": 0.03}}, "reach": 8}']
    second = dataclasses.replace(sheet, corrections=corrections)
    second.save(tmp_path / "anna.002.performance.npz")
    for name in ("anna.performance.npz", "anna.002.performance.npz"):
        bpy.ops.mimetic.load_performance(filepath=str(tmp_path / name))
    return scene.mimetic.clip


def rows(extension, clip) -> list[str]:
    return [row.name for row in extension("captured_takes").of_clip(clip)]


def used(extension, clip) -> str:
    takes = extension("takes")
    return Path(takes.find(takes.of_clip(bpy.context.scene, clip))).name


def test_a_row_says_which_frames_how_well_and_how_it_was_captured(extension, captured):
    takes = extension("captured_takes")
    first, second = takes.of_clip(captured)
    assert (first.name, first.first, first.last, first.num_lost) == ("anna", 1, 40, 3)
    assert first.quality == pytest.approx(1.0)
    assert takes.settings_of(first) == "lens of 47 mm on 36 mm, calibrated"
    assert takes.settings_of(second) == "lens of 47 mm on 36 mm, 1 frame corrected"
    assert second.date.startswith("20")
    texts = drawn("MIMETIC_PT_captured_takes")
    assert "MIMETIC_UL_captured_takes" in texts
    assert "1 frame corrected" in texts


def test_another_take_is_used_in_one_undo_step(extension, captured):
    assert used(extension, captured) == "anna.002.performance.npz"
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.use_captured_take("EXEC_DEFAULT", True, take="anna") == {"FINISHED"}
    assert used(extension, captured) == "anna.performance.npz"
    assert result()["take"] == "anna" and result()["footage_frames"] == [1, 40]
    assert rows(extension, captured) == ["anna", "anna.002"]
    in_window(bpy.ops.ed.undo)
    clip = bpy.context.scene.mimetic.clip
    assert used(extension, clip) == "anna.002.performance.npz"
    clip.mimetic.footage[0].active_captured = 0
    assert bpy.ops.mimetic.use_captured_take() == {"FINISHED"}  # the row that is shown
    assert used(extension, clip) == "anna.performance.npz"
    assert bpy.ops.mimetic.bake(use_contact=False, use_texture=False) == {"FINISHED"}
    (row,) = bpy.context.scene.mimetic.face.mimetic.takes
    assert row.performance == "anna.performance.npz"


def test_a_file_loaded_again_is_the_same_row(extension, captured, tmp_path):
    path = tmp_path / "anna.performance.npz"
    bpy.ops.mimetic.load_performance(filepath=str(path))
    assert rows(extension, captured) == ["anna", "anna.002"]
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / path.name
    other.write_bytes(path.read_bytes())
    bpy.ops.mimetic.load_performance(filepath=str(other))
    assert rows(extension, captured)[2] == "other/anna"


def test_a_missing_file_says_so_and_what_to_do(extension, captured, tmp_path):
    os.rename(tmp_path / "anna.performance.npz", tmp_path / "gone.npz")
    with pytest.raises(RuntimeError, match=r"anna\.performance\.npz is missing: look for it"):
        bpy.ops.mimetic.use_captured_take(take="anna")
    assert used(extension, captured) == "anna.002.performance.npz"
    captured.mimetic.footage[0].active_captured = 0
    assert "anna.performance.npz is missing" in drawn("MIMETIC_PT_captured_takes")
    away = tmp_path / "away"
    away.mkdir()
    os.rename(tmp_path / "gone.npz", away / "anna.performance.npz")
    assert bpy.ops.mimetic.find_missing(directory=str(tmp_path)) == {"FINISHED"}
    assert result()["files"] == ["anna.performance.npz"]
    assert bpy.ops.mimetic.use_captured_take(take="anna") == {"FINISHED"}
    with pytest.raises(RuntimeError, match=r"no captured take x: it has anna, anna\.002"):
        bpy.ops.mimetic.use_captured_take(take="x")


def test_a_row_that_is_not_used_goes_and_its_file_stays(extension, captured, tmp_path):
    with pytest.raises(RuntimeError, match=r"is the take that is used: use another one first"):
        bpy.ops.mimetic.remove_captured_take(take="anna.002")
    assert bpy.ops.mimetic.remove_captured_take(take="anna") == {"FINISHED"}
    assert rows(extension, captured) == ["anna.002"]
    assert (tmp_path / "anna.performance.npz").is_file()


def test_the_list_is_saved_and_moves_along(extension, captured, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    paths = [row.performance_path for row in captured.mimetic.footage[0].captured]
    assert paths == ["//anna.performance.npz", "//anna.002.performance.npz"]
    (tmp_path / "a").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a" / "copy.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a" / "copy.blend"))
    clip = bpy.context.scene.mimetic.clip
    takes, found = extension("takes"), extension("captured_takes").of_clip(clip)
    assert [takes.find(row) for row in found] == [
        str(tmp_path / name) for name in ("anna.performance.npz", "anna.002.performance.npz")
    ]
    assert bpy.ops.mimetic.use_captured_take(take="anna") == {"FINISHED"}


def test_a_take_of_an_earlier_version_is_listed_when_another_comes(
    extension, scene, captured, tmp_path
):
    record = captured.mimetic.footage[0]
    record.captured.clear()
    assert not bpy.ops.mimetic.use_captured_take.poll()
    bpy.ops.mimetic.load_performance(filepath=str(tmp_path / "anna.performance.npz"))
    assert rows(extension, captured) == ["anna.002", "anna"]


def test_bake_and_refine_wait_behind_a_capture(extension, captured, monkeypatch):
    jobs = extension("jobs")
    for subject in ("other.mp4", captured.name):
        monkeypatch.setattr(jobs, "running", jobs.Run("Capture", subject))
        assert bpy.ops.mimetic.bake.poll() and bpy.ops.mimetic.refine.poll()
    monkeypatch.setattr(jobs, "waiting", [jobs.Run("Bake", captured.name)])
    assert not bpy.ops.mimetic.bake.poll() and bpy.ops.mimetic.refine.poll()


@pytest.mark.newest
def test_a_take_whose_file_is_read_only_is_saved_elsewhere_and_why_is_told(
    extension, sheet, tmp_path
):
    path = tmp_path / "mine.npz"
    path.write_bytes(b"mine")
    path.chmod(0o444)
    takes = extension("takes")
    spare, (note, *_) = takes.save(sheet, takes.new_take("clip.mp4", str(path)))
    assert path.read_bytes() == b"mine" and Path(spare).is_file() and spare != str(path)
    assert "mine.npz is read-only" in note and "None" not in note


@pytest.mark.parametrize("letter", ["a", "я", "笑"])
def test_a_take_of_footage_with_a_long_name_is_saved_beside_the_file(
    extension, sheet, tmp_path, letter
):
    """A name of 255 bytes is legal, and an ending more than that is not."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    takes, stem = extension("takes"), letter * (251 // len(letter.encode()))
    for number in ("", ".002"):
        path, notes = takes.save(sheet, takes.new_take(f"{stem}.mp4"))
        name = Path(path).name
        kept = name.removesuffix(f"{number}.performance.npz")
        assert Path(path).parent == tmp_path and Path(path).is_file() and notes == []
        assert kept != name and stem.startswith(kept) and len(kept.encode()) > 200


@pytest.mark.newest
def test_a_take_is_saved_elsewhere_where_a_new_name_cannot_even_be_looked_up(
    extension, sheet, tmp_path, monkeypatch
):
    takes = extension("takes")
    new = dataclasses.replace(takes.new_take("clip.mp4"), folder=tmp_path / "shut")
    exists = Path.exists

    def look_up(path, **options):
        if path.parent == new.folder:
            raise PermissionError(13, "Permission denied", str(path))
        return exists(path, **options)

    monkeypatch.setattr(Path, "exists", look_up)
    spare, (note, *_) = takes.save(sheet, new)
    assert Path(spare).is_file() and Path(spare).parent == new.spare
    assert f"{new.folder} cannot be written (Permission denied)" in note
