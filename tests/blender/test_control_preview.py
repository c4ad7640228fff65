# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a character's own controls, seen on the character while it is edited."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_face_bones import acting_file, rig  # noqa: F401
from test_own_controls import character, played  # noqa: F401

pytestmark = pytest.mark.newest


@pytest.fixture
def shown(character, played, scene, extension):  # noqa: F811
    """A character on show at a frame at which its jaw is open."""
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(played))
    for key in character.data.shape_keys.key_blocks:  # new ones are at 1 since Blender 5
        key.value = {"Hair": 0.5, "jawOpen": 0.125}.get(key.name, 0.0)
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    yield character
    extension("control_preview").end()


def values(head) -> dict[str, float]:
    return {key.name: key.value for key in head.data.shape_keys.key_blocks}


def open_frame(extension, head, scene) -> int:
    """The frame at which the jaw is widest open."""
    preview = extension("control_preview").active.preview
    rows = extension("control_rows").rows_of(head)
    first, last = preview._frames[[0, -1]]
    frames = range(int(np.ceil(first)), int(last) + 1)
    return max(frames, key=lambda frame: preview.values(frame, rows)["jawOpen"])


def test_rows_show_at_once_at_any_frame_and_nothing_is_keyed(extension, shown, scene):
    scene.frame_set(open_frame(extension, shown, scene))
    whole = values(shown)["jawOpen"]
    assert whole > 0.3
    row = shown.mimetic.controls["jawOpen"]
    row.gain = 0.5
    assert values(shown)["jawOpen"] == pytest.approx(0.5 * whole, rel=1e-5)
    row.offset, row.highest = 0.2, 0.25
    assert values(shown)["jawOpen"] == pytest.approx(0.25)
    row.is_on = False
    assert values(shown)["jawOpen"] == pytest.approx(0.125)  # as it was before
    row.is_on, row.gain, row.offset, row.highest = True, 1.0, 0.0, 1.0
    assert values(shown)["jawOpen"] == pytest.approx(whole, rel=1e-5)
    assert values(shown)["Hair"] == pytest.approx(0.5)
    assert shown.data.shape_keys.animation_data.action is None
    assert shown.animation_data is None


def test_what_is_shown_is_what_a_bake_keys(extension, shown, scene):
    shown.mimetic.controls["jawOpen"].gain = 0.5
    frame = open_frame(extension, shown, scene)
    scene.frame_set(frame)
    seen = values(shown)
    assert bpy.ops.mimetic.bake_controls(use_head_motion=False) == {"FINISHED"}
    assert not shown.mimetic.before_preview
    scene.frame_set(frame)
    assert values(shown) == pytest.approx(seen, abs=1e-4)


def test_again_puts_all_back(shown, scene):
    scene.frame_set(scene.frame_current + 5)
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    assert values(shown)["jawOpen"] == pytest.approx(0.125)
    assert values(shown)["eyeBlinkLeft"] == 0
    assert shown.mimetic.before_preview == ""
    shown.mimetic.controls["jawOpen"].gain = 0.5
    assert values(shown)["jawOpen"] == pytest.approx(0.125)


def test_undo_takes_a_row_back_and_brings_no_shown_pose(extension, shown, scene):
    scene.frame_set(open_frame(extension, shown, scene))
    name, whole = shown.name, values(shown)["jawOpen"]
    bpy.ops.ed.undo_push(message="before")
    shown.mimetic.controls["jawOpen"].gain = 0.5
    bpy.ops.ed.undo_push(message="Gain")
    bpy.ops.ed.undo()
    head = bpy.data.objects[name]
    assert head.mimetic.controls["jawOpen"].gain == 1
    assert values(head)["jawOpen"] == pytest.approx(whole, rel=1e-5)
    bpy.context.view_layer.objects.active = head
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    bpy.ops.ed.redo()  # to a state in which the character was on show
    assert values(bpy.data.objects[name])["jawOpen"] == pytest.approx(0.125)


def test_a_saved_file_has_the_character_as_it_was(extension, shown, scene, tmp_path):
    scene.frame_set(open_frame(extension, shown, scene))
    seen, name = values(shown)["jawOpen"], shown.name
    path = tmp_path / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    assert values(bpy.data.objects[name])["jawOpen"] == pytest.approx(seen)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert values(bpy.data.objects[name])["jawOpen"] == pytest.approx(0.125)


def test_it_goes_on_after_a_file_that_could_not_be_saved(extension, shown, scene, tmp_path):
    scene.frame_set(open_frame(extension, shown, scene))
    seen = values(shown)["jawOpen"]
    with pytest.raises(RuntimeError):
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "missing" / "saved.blend"))
    assert values(shown)["jawOpen"] == pytest.approx(seen) != 0.125


def test_bones_of_a_rig_are_shown_and_put_back(rig, scene, acting_file):  # noqa: F811
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(acting_file))
    bpy.context.view_layer.objects.active = rig
    rig.pose.bones["lips.R"].location = (0.001, 0, 0)
    before = {bone.name: np.array(bone.matrix_basis) for bone in rig.pose.bones}
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    scene.frame_set(6)
    moved = np.abs(np.array(rig.pose.bones["brow.L"].location)).max()
    assert moved > 1e-3
    along = max(
        (row for row in rig.mimetic.controls if row.name.startswith("brow.L along")),
        key=lambda row: abs(rig.pose.bones["brow.L"].location["xyz".index(row.name[-1])]),
    )
    along.is_on = False
    assert rig.pose.bones["brow.L"].location["xyz".index(along.name[-1])] == 0
    assert rig.animation_data is None
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    for bone in rig.pose.bones:
        np.testing.assert_allclose(np.array(bone.matrix_basis), before[bone.name], atol=1e-6)


def test_muscles_attached_meanwhile_end_it_and_a_followed_drag_shows_it_again(extension, shown):
    preview, dragged = extension("control_preview"), extension("dragged_landmarks")
    assert preview.is_moving(shown)
    following = dragged.Following(shown.name, {}, extension("job_run").Run("Attach"), shown.name)
    dragged._following = following
    dragged._show_again()  # Esc: the job ended and has attached nothing
    assert preview.active is not None and dragged._following is None
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert "the preview has ended" in result()["message"]
    assert preview.active is None and not shown.mimetic.before_preview
    assert values(shown)["jawOpen"] == pytest.approx(0.125)
    dragged._following = following
    dragged._show_again()
    assert preview.is_of(shown)
