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
def captured(performance):
    """Lost in frame 31; the first muscle is not told from the second in frames 11 to 20."""
    confounded, quality = np.full((40, 36), -1), np.ones(40)
    confounded[10:20, 0], confounded[10:20, 1], quality[30] = 1, 0, 0.1
    return dataclasses.replace(
        performance,
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
