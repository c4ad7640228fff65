# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Graph Editor tells of how far a baked face's curves may be off."""

import dataclasses

import bpy
import numpy as np
import pytest
from panel_texts import drawn

LEFT, RIGHT = "muscle_00.L", "muscle_00.R"
OFF = 1.645 * 0.1


@pytest.fixture
def captured(sheet):
    """Lost in frame 31; the first muscle is not told from the second in frames 11 to 20."""
    confounded, quality = np.full((40, 36), -1), np.ones(40)
    confounded[10:20, 0], confounded[10:20, 1], quality[30] = 1, 0, 0.1
    return dataclasses.replace(
        sheet,
        activations_std=np.full((40, 36), 0.1),
        confounded_with=confounded,
        quality=quality,
    )


@pytest.fixture
def select(extension):
    def run(face, *names):
        for row in extension("scene_out").face_curves.of(face):
            row.curve.select = row.shape in names

    return run


@pytest.mark.parametrize("to", ["KEYS", "CONTROLS"])
def test_of_the_selected_curves_value_and_interval_are_told(
    extension, scene, bake, captured, select, to
):
    face = bake(captured, to=to)
    select(face, LEFT)
    errors = extension("baked_errors")
    found = errors.of_selected(bpy.context)
    assert [curve.shape for curve in found.curves] == [LEFT]
    value = captured.activations[4, 0]
    assert errors.line_of(found, found.curves[0], 5) == f"{LEFT}: {value:.2f} ± {OFF:.2f}"
    (one,) = found.curves
    assert one.curve.evaluate(5) == pytest.approx(value * one.unit, abs=1e-5)
    scene.frame_set(15)
    told = drawn("MIMETIC_PT_error_bars")
    assert f"{captured.activations[14, 0]:.2f} ± {OFF:.2f}" in told
    assert "told apart" in told and RIGHT in told
    assert errors.line_of(found, one, 31) == f"{LEFT}: not measured in this frame"
    assert errors.line_of(found, one, 99) == f"{LEFT}: not measured in this frame"


def test_frames_are_those_of_the_footage_at_another_rate(extension, scene, bake, captured, select):
    scene.render.fps = 50
    select(bake(captured), LEFT)
    errors = extension("baked_errors")
    found = errors.of_selected(bpy.context)
    assert found.step == pytest.approx(2.0)
    first = found.row.scene_first
    assert [found.footage_frame(first + after) for after in (0, 2, 20)] == [1, 2, 11]


def test_frames_are_those_of_a_take_that_was_retimed(extension, bake, captured, select):
    select(bake(captured), LEFT)
    assert bpy.ops.mimetic.retime_curves(factor=2.0, frames_later=100.0) == {"FINISHED"}
    found = extension("baked_errors").of_selected(bpy.context)
    assert found.step == pytest.approx(2.0)
    assert [found.footage_frame(frame) for frame in (101, 103, 179)] == [1, 2, 40]


def test_a_curve_that_was_edited_is_told_as_captured(extension, bake, captured, select):
    face = bake(captured)
    select(face, LEFT)
    errors = extension("baked_errors")
    (one,) = errors.of_selected(bpy.context).curves
    one.curve.keyframe_points[4].co.y += 0.4
    line = errors.line_of(errors.of_selected(bpy.context), one, 5)
    assert f"{captured.activations[4, 0]:.2f} ±" in line


def test_the_take_that_plays_is_told_of(extension, bake, captured, select):
    weak = dataclasses.replace(captured, activations=0.5 * captured.activations)
    face = bake(captured)
    bake(weak, "again")
    errors = extension("baked_errors")
    for take, source in (("again", weak), ("hero", captured)):
        assert bpy.ops.mimetic.play_take(take=take) == {"FINISHED"}
        select(face, LEFT)
        found = errors.of_selected(bpy.context)
        assert f"{source.activations[4, 0]:.2f} ±" in errors.line_of(found, found.curves[0], 5)


@pytest.fixture
def into(scene, tmp_path):
    """Captures into a folder, by the name that the command gives, and bakes that."""

    def run(performance, folder: str, **options):
        path = tmp_path / folder / "performance.npz"
        path.parent.mkdir(exist_ok=True)
        performance.save(path)
        assert bpy.ops.mimetic.load_performance(filepath=str(path)) == {"FINISHED"}
        options = {"use_texture": False, "use_contact": False, **options}
        assert bpy.ops.mimetic.bake(**options) == {"FINISHED"}
        return scene.mimetic.face

    scene.render.fps, scene.render.fps_base = 25, 1.0
    return run


@pytest.mark.parametrize("in_clip", [False, True])
@pytest.mark.parametrize("options", [{}, {"exaggeration": 1.5}])
def test_takes_of_files_of_one_name_are_each_told_of_their_own(
    extension, scene, into, captured, select, footage, in_clip, options
):
    if in_clip:
        bpy.ops.mimetic.load_clip(filepath=str(footage))
    weak = dataclasses.replace(captured, activations=0.5 * captured.activations)
    into(captured, "take1", **options)
    face = into(weak, "take2", **options)
    names = [row.name for row in face.mimetic.takes]
    assert {row.performance for row in face.mimetic.takes} == {"performance.npz"}
    errors = extension("baked_errors")
    for name, source in zip(names, (captured, weak), strict=True):
        assert bpy.ops.mimetic.play_take(take=name) == {"FINISHED"}
        select(face, LEFT)
        found = errors.of_selected(bpy.context)
        assert f"{source.activations[4, 0]:.2f} ±" in errors.line_of(found, found.curves[0], 5)


def test_a_capture_into_the_same_file_is_another(extension, into, captured, select):
    select(into(captured, "take"), LEFT)
    errors = extension("baked_errors")
    assert errors.of_selected(bpy.context).curves
    off = dataclasses.replace(captured, activations_std=2 * captured.activations_std)
    face = into(off, "take")
    first, second = (row.name for row in face.mimetic.takes)
    bpy.ops.mimetic.play_take(take=first)
    told = f"performance.npz holds another capture than {first} was baked from"
    assert errors.of_selected(bpy.context) == told
    assert told in drawn("MIMETIC_PT_error_bars")
    bpy.ops.mimetic.play_take(take=second)
    select(face, LEFT)
    assert errors.of_selected(bpy.context).curves


def test_a_file_is_found_again_from_a_blend_that_was_saved_elsewhere(
    extension, scene, into, captured, select, tmp_path
):
    select(into(captured, "take"), LEFT)
    scene.mimetic.performance_path = ""
    for folder in ("one", "two"):
        (tmp_path / folder / "deeper").mkdir(parents=True)
        blend = tmp_path / folder / "deeper/face.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    (row,) = bpy.context.scene.mimetic.face.mimetic.takes
    assert row.performance_path == bpy.path.native_pathsep("//../../take/performance.npz")
    assert extension("baked_errors").of_selected(bpy.context).curves


def test_a_take_of_an_earlier_version_goes_by_its_files_name(extension, into, captured, select):
    face = into(captured, "take")
    select(face, LEFT)
    row = face.mimetic.takes[0]
    row.performance_path = row.capture = ""
    assert extension("baked_errors").of_selected(bpy.context).curves


def test_why_there_is_nothing_is_said(extension, scene, bake, captured, select, tmp_path):
    errors = extension("baked_errors")
    assert errors.of_selected(bpy.context) == "Bake a take first: error bars are of its curves"
    face = bake(captured)
    select(face)
    assert errors.of_selected(bpy.context) == "Select a curve of a muscle, the jaw, lids or lips"
    assert "Select a curve" in drawn("MIMETIC_PT_error_bars")
    select(face, *captured.muscles)
    assert errors.of_selected(bpy.context) == "Select at most 8 curves"
    shorter = {
        field.name: value[:30]
        for field in dataclasses.fields(captured)
        if isinstance(value := getattr(captured, field.name), np.ndarray)
        and len(value) == 40
        and field.name != "muscle_modes"
    }
    path = tmp_path / "hero.performance.npz"
    dataclasses.replace(captured, **shorter).save(path)
    assert "holds another capture than hero was baked from" in errors.of_selected(bpy.context)
    path.write_bytes(b"nothing")
    assert isinstance(errors.of_selected(bpy.context), str)
    path.unlink()
    assert (
        errors.of_selected(bpy.context)
        == "hero.performance.npz, which hero was baked from, is missing"
    )
    face.data.shape_keys.animation_data.action = None
    assert errors.of_selected(bpy.context) == f"{face.name} plays no baked take"
