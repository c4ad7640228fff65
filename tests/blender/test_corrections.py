# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a take corrected in the clip editor, and refined."""

import contextlib
import json
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from last_result import result
from test_clips import take_of

pytestmark = pytest.mark.oldest_and_newest

FRAME = 15


@pytest.fixture
def captured(scene, clip_path, captured_file):
    """The clip, with its take, at a frame."""
    bpy.ops.mimetic.load_clip(filepath=str(clip_path))
    bpy.ops.mimetic.load_performance(filepath=str(captured_file))
    scene.frame_set(FRAME)
    return scene.mimetic.clip


@pytest.fixture
def performance(captured_file):
    from mimetic.performance.document import Performance

    return Performance.load(captured_file)


def kept(extension, clip):
    return extension("corrections").of_clip(clip)


def nose(performance) -> tuple[float, float]:
    from mimetic.template.face_template import load_template

    vertex = load_template().landmark("lip_upper")
    i = performance.index_of(FRAME)
    x, y = performance.project(performance.surface_in_camera(i)[[vertex]])[0]
    return float(x), float(y)


def refine(tmp_path, **options):
    from mimetic.performance.document import Performance

    path = tmp_path / "refined.npz"
    assert bpy.ops.mimetic.refine(filepath=str(path), **options) == {"FINISHED"}
    return Performance.load(path)


def test_a_place_of_the_skin_goes_where_it_is_dragged(extension, captured, performance, tmp_path):
    x, y = nose(performance)
    assert bpy.ops.mimetic.pin_skin(grab=(x, y), to=(x, y - 3), reach=6.0) == {"FINISHED"}
    ((pin,),) = [entry.pins for entry in kept(extension, captured)]
    np.testing.assert_allclose(pin.pixel, (x, y - 3), atol=1e-3)
    refined = refine(tmp_path)
    assert result()["frames"] == [FRAME]
    board = extension("corrections").native.correcting().PinBoard(refined)
    ends = board.lines(kept(extension, captured), FRAME) * (400, 300)
    assert np.linalg.norm(ends[0] - ends[1]) < pin.std
    far = np.abs(performance.frame - FRAME) > 6
    np.testing.assert_allclose(refined.head_pose[far], performance.head_pose[far], atol=1e-6)
    assert json.loads(refined.corrections[0])["frame"] == FRAME


def test_a_pin_is_grabbed_again(extension, captured, performance):
    x, y = nose(performance)
    bpy.ops.mimetic.pin_skin(grab=(x, y), to=(x + 12, y))
    bpy.ops.mimetic.pin_skin(grab=(x + 13, y), to=(x, y + 9))
    ((pin,),) = [entry.pins for entry in kept(extension, captured)]
    np.testing.assert_allclose(pin.pixel, (x, y + 9), atol=1e-3)


def test_beside_the_face_nothing_is_pinned(extension, captured):
    with pytest.raises(RuntimeError, match="no skin of the captured face is seen at 2, 3"):
        bpy.ops.mimetic.pin_skin(grab=(2, 3), to=(5, 5))
    assert kept(extension, captured) == ()


def test_values_and_pose_are_stated(extension, captured, performance, tmp_path):
    bpy.ops.mimetic.correct_value(value_name="lid_upper.L", value=0.9, std=0.02, reach=4.0)
    bpy.ops.mimetic.correct_value(value_name="lip_gap", value=0.004, std=2e-4, frame=22)
    bpy.ops.mimetic.correct_value(value_name="gaze_yaw.R", value=21.0, frame=22)
    bpy.ops.mimetic.correct_pose(turn=(0.0, 3.0, 0.0), frame=8, reach=20.0)
    assert [entry.frame for entry in kept(extension, captured)] == [8, FRAME, 22]
    refined = refine(tmp_path)
    lid = performance.articulators.index("lid_upper.L")
    i = performance.index_of(FRAME)
    assert refined.articulator_values[i, lid] > 0.6 > performance.articulator_values[i, lid]
    gaze = performance.articulators.index("gaze_yaw.R")
    assert abs(refined.articulator_values[performance.index_of(22), gaze] - 21) < 1
    i = performance.index_of(8)
    turned = refined.head_pose[i, :3, :3] @ performance.head_pose[i, :3, :3].T
    angle = np.degrees(np.arccos((np.trace(turned) - 1) / 2))
    assert 2 < angle < 4
    with pytest.raises(RuntimeError, match="the take has no such value"):
        bpy.ops.mimetic.correct_value(value_name="nose")
    with pytest.raises(RuntimeError, match="jaw_open cannot be 21: it is from -1 to 1"):
        bpy.ops.mimetic.correct_value(value_name="jaw_open", value=21.0)
    with pytest.raises(RuntimeError, match="frame 200 is not in the performance"):
        bpy.ops.mimetic.correct_value(frame=200)


def test_refining_makes_a_take_and_keeps_the_one_before(captured, captured_file, scene, tmp_path):
    before = captured_file.read_bytes()
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.4)
    refine(tmp_path)
    assert captured_file.read_bytes() == before
    assert scene.mimetic.clip.mimetic.footage[0].performance_path.endswith("refined.npz")


def test_a_refined_take_that_cannot_be_written_is_kept_elsewhere(captured, tmp_path):
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.4)
    file = tmp_path / "file"
    file.touch()
    path = file / "refined.npz"
    assert bpy.ops.mimetic.refine(filepath=str(path)) == {"FINISHED"}
    assert f"{path} cannot be written" in result()["message"]
    assert Path(result()["performance"]).is_file()


def test_the_take_is_read_once_for_drawing_and_for_corrections(extension, captured, monkeypatch):
    takes, readings = extension("takes"), []
    load = takes.load
    monkeypatch.setattr(takes, "load", lambda take: readings.append(take) or load(take))
    extension("overlay").forget_takes()
    performance = extension("shown_take").performance_or_none(bpy.context)
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.4)
    assert extension("corrections").board(bpy.context).performance is performance
    assert len(readings) == 1


def test_a_deleted_correction_is_taken_back(extension, captured, performance, tmp_path):
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.5)
    jaw, i = performance.articulators.index("jaw_open"), performance.index_of(FRAME)
    assert refine(tmp_path).articulator_values[i, jaw] > 0.4
    assert bpy.ops.mimetic.delete_correction() == {"FINISHED"}
    back = refine(tmp_path)
    np.testing.assert_allclose(back.articulator_values, performance.articulator_values, atol=0.03)
    with pytest.raises(RuntimeError, match="nothing is corrected in frame 15"):
        bpy.ops.mimetic.delete_correction()


def test_a_pose_says_how_surely_it_is_there(extension, captured, performance):
    stds = {"rotation_std": 0.03, "translation_std": 0.004}
    assert bpy.ops.mimetic.correct_pose(shift=(0.01, 0.0, 0.0), **stds) == {"FINISHED"}
    pose = kept(extension, captured)[0].pose
    assert (pose.rotation_std, pose.translation_std) == pytest.approx((0.03, 0.004))
    moved = pose.head_pose - performance.head_pose[performance.index_of(FRAME)]
    np.testing.assert_allclose(moved[:3, 3], (0.01, 0, 0), atol=1e-6)


def test_one_thing_that_is_stated_is_taken_back(extension, captured, performance):
    x, y = nose(performance)
    bpy.ops.mimetic.pin_skin(grab=(x, y), to=(x, y - 3))
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.5)
    bpy.ops.mimetic.correct_value(value_name="lip_gap", value=0.003)
    bpy.ops.mimetic.correct_pose(turn=(0.0, 3.0, 0.0))
    parts = extension("stated_parts").stated_parts(kept(extension, captured)[0])
    assert [part.name for part in parts] == ["pin 1", "pose", "jaw_open", "lip_gap"]
    assert [part.text for part in parts[2:]] == ["jaw_open 0.50", "lip_gap 3.0 mm"]
    for count, part in enumerate(parts, 1):
        assert bpy.ops.mimetic.delete_correction(what=part.name) == {"FINISHED"}
        left = kept(extension, captured)
        assert sum(len(extension("stated_parts").stated_parts(e)) for e in left) == 4 - count
        if left and part.name != "lip_gap":
            with pytest.raises(RuntimeError, match="frame 15"):
                bpy.ops.mimetic.delete_correction(what=part.name)
    assert kept(extension, captured) == ()


@pytest.mark.newest
def test_corrections_live_in_the_file_and_in_its_next_capture(extension, captured, scene, tmp_path):
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.5, frame=6)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    clip = bpy.context.scene.mimetic.clip
    assert [entry.frame for entry in kept(extension, clip)] == [6]
    path = tmp_path / "again.npz"
    bpy.ops.mimetic.capture(filepath=str(path), frame_first=1, frame_last=8)
    from mimetic.performance.document import Performance

    again = Performance.load(path)
    assert again.articulator_values[5, again.articulators.index("jaw_open")] > 0.35
    assert json.loads(again.corrections[0])["frame"] == 6


def test_corrections_edited_into_nonsense_are_refused(extension, captured):
    extension("clips").ensure(captured).corrections = '{"schema": 1, "corrections": [{}]}'
    with pytest.raises(RuntimeError, match="lacks frame"):
        bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.5)
    assert extension("corrections").frames_of(captured) == []


def test_what_a_shorter_take_does_not_have_waits_for_one_that_does(
    extension, captured, performance, clip_path, tmp_path
):
    bpy.ops.mimetic.correct_value(frame=25, value_name="jaw_open", value=0.4)
    bpy.ops.mimetic.correct_value(frame=4, value_name="jaw_open", value=0.4)
    short = take_of(performance, clip_path, tmp_path / "short.npz", 10)
    bpy.ops.mimetic.load_performance(filepath=str(short))
    refined = refine(tmp_path)
    assert [json.loads(text)["frame"] for text in refined.corrections] == [4]
    assert "1 more is of a frame that this take does not have" in result()["message"]
    assert [entry.frame for entry in kept(extension, captured)] == [4, 25]


class Waiting:
    """What a drag in the clip editor asks of Blender, without a window."""

    def __init__(self, kind, scene):
        self.drag = type("Drag", (kind,), {"report": lambda *_: None})()
        self.drag.frame, self.drag.is_of_shown = 0, False
        quiet = SimpleNamespace(
            cursor_modal_set=lambda _: None,
            cursor_modal_restore=lambda: None,
            status_text_set=lambda _: None,
            modal_handler_add=lambda _: None,
            screen=SimpleNamespace(areas=[]),
        )
        self.context = SimpleNamespace(
            window=quiet, workspace=quiet, window_manager=quiet, scene=scene, edit_movieclip=None
        )
        self.context.temp_override = lambda **_: contextlib.nullcontext()
        assert self.drag.invoke(self.context, None) == {"RUNNING_MODAL"}

    def press(self, kind: str, value: str = "PRESS"):
        event = SimpleNamespace(type=kind, value=value, mouse_x=0, mouse_y=0)
        return self.drag.modal(self.context, event)


def test_a_drag_that_waits_leaves_what_is_corrected_meanwhile(
    extension, captured, scene, monkeypatch
):
    part = extension("scene_in")
    monkeypatch.setattr(part, "no_picture", lambda context: "")
    monkeypatch.setattr(part, "footage_pixel", lambda *arguments: None)
    kind = extension("operators.dragging").Dragging
    first = Waiting(kind, scene)
    bpy.ops.mimetic.correct_value(frame=20, value_name="jaw_open", value=0.5)
    assert first.press("ESC") == {"CANCELLED"}
    assert [entry.frame for entry in kept(extension, captured)] == [20]
    first, second = Waiting(kind, scene), Waiting(kind, scene)
    assert "CANCELLED" in first.press("LEFTMOUSE")  # the other was begun instead
    assert second.press("LEFTMOUSE") == {"PASS_THROUGH"}


def editor(clip, x: int, kind: str = "CLIP_EDITOR", **settings):
    """An area 100 pixels wide and high, as far as the mouse over it is concerned."""
    of_space = {"show_stable": False, "type": kind, "clip": clip} | settings
    space = SimpleNamespace(**of_space)
    return SimpleNamespace(x=x, y=0, width=100, height=100, spaces=SimpleNamespace(active=space))


def test_the_editor_under_the_mouse_is_looked_for_at_each_click(extension, captured):
    part, other = extension("scene_in"), captured.copy()
    stable = SimpleNamespace(
        use_proxy=False,
        tracking=SimpleNamespace(stabilization=SimpleNamespace(use_2d_stabilization=True)),
    )
    areas = [
        *(editor(captured, 0), editor(other, 100), editor(None, 200, "VIEW_3D")),
        editor(stable, 300, show_stable=True),
    ]
    context = SimpleNamespace(window=SimpleNamespace(screen=SimpleNamespace(areas=areas)))
    assert part.footage_area(context, 50, 50) is areas[0]
    assert part.footage_area(context, 50, 50, captured) is areas[0]
    assert part.footage_area(context, 150, 50) is areas[1]
    assert part.footage_area(context, 150, 50, captured) is None  # another clip is seen there
    assert part.footage_area(context, 250, 50) is part.footage_area(context, 350, 50) is None
    assert part.footage_area(context, 450, 50) is None
    areas.pop(0)  # as full screen does
    assert part.footage_area(context, 50, 50, captured) is None
    context.window = None
    assert part.footage_area(context, 150, 50) is None
    with bpy.context.temp_override(edit_movieclip=other):  # in the middle of a drag
        assert part.clip_of(bpy.context) == other


class Opened:
    """Drags a value up; `fails`: in the middle."""

    fails = False

    def grab_at(self, pixel):
        self.value = 0.1

    def drag_to(self, pixel):
        if self.fails:
            raise RuntimeError("the editor is gone")
        self.value += 0.1

    def change(self, context, earlier, frame):
        from mimetic.solve import correcting

        return correcting.with_value(earlier, frame, "jaw_open", self.value, 0.03, 8.0)


@pytest.mark.parametrize("end", ["RELEASE", "ESC", "ERROR"])
def test_a_drag_leaves_nothing_half_made(extension, captured, scene, monkeypatch, end):
    part, restored = extension("scene_in"), []
    monkeypatch.setattr(part, "no_picture", lambda context: "")
    monkeypatch.setattr(part, "footage_area", lambda *arguments: editor(captured, 0))
    monkeypatch.setattr(part, "footage_pixel", lambda *arguments: (200.0, 150.0))
    names = {"bl_label": "Drag", "bl_idname": "MIMETIC_OT_drag"}
    kind = type("Drags", (Opened, extension("operators.dragging").Dragging), names)
    drag = Waiting(kind, scene)
    drag.context.window.cursor_modal_restore = lambda: restored.append(True)
    assert drag.press("LEFTMOUSE") == {"RUNNING_MODAL"}
    assert drag.press("MOUSEMOVE", "NOTHING") == {"RUNNING_MODAL"}
    ((entry,)) = kept(extension, captured)
    assert entry.values["jaw_open"].value == pytest.approx(0.2)
    if end == "ERROR":
        drag.drag.fails = True
        with pytest.raises(RuntimeError, match="the editor is gone"):
            drag.press("MOUSEMOVE", "NOTHING")
        assert "CANCELLED" in drag.press("MOUSEMOVE", "NOTHING")  # which ends it for Blender
    elif end == "ESC":
        assert drag.press("ESC") == {"CANCELLED"}
    else:
        assert drag.press("LEFTMOUSE", "RELEASE") == {"FINISHED"}
    assert restored == [True]
    assert len(kept(extension, captured)) == (end == "RELEASE")
