# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts give operators in the call, and what operators tell them they made."""

import os

import bpy
import pytest
from last_result import result


@pytest.fixture
def baked(scene, footage, performance_file):
    """A face baked with its footage."""
    scene.render.fps = 25
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    return scene.mimetic.face


def test_every_operator_tells_what_it_made(scene, footage, performance_file, tmp_path):
    scene.render.fps = 25
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    made = result()
    assert (made["operator"], made["status"]) == ("mimetic.load_clip", "FINISHED")
    assert (made["clip"], made["size"], made["num_frames"]) == ("stripes.mp4", [400, 300], 40)
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    assert result()["performance"] == str(performance_file)
    assert result()["footage_frames"] == [1, 40]
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    made = result()
    assert bpy.data.objects[made["object"]] == scene.mimetic.face
    assert bpy.data.objects[made["camera"]] == scene.camera
    assert made["num_curves"] > 36 and made["scene_frames"] == [1.0, 40.0]
    bpy.ops.mimetic.reduce_keys(tolerance=0.1)
    assert 0 < result()["num_keys"] < result()["num_keys_before"]
    out = tmp_path / "face.glb"
    bpy.ops.mimetic.export_gltf(filepath=str(out))
    assert os.path.samefile(result()["file"], out)
    bpy.ops.mimetic.hold_head_still(smoothing=0.0)
    assert result()["num_frames"] == 40


def test_why_an_operator_failed_is_in_its_result(tmp_path):
    path = tmp_path / "no film.mp4"
    path.write_bytes(b"no film at all" * 100)
    with pytest.raises(RuntimeError):
        bpy.ops.mimetic.load_clip(filepath=str(path))
    made = result()
    assert (made["operator"], made["status"]) == ("mimetic.load_clip", "CANCELLED")
    assert "no film.mp4" in made["message"] and "clip" not in made


def test_head_motion_goes_where_the_call_says(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    empty = bpy.data.objects.new("Follower", None)
    scene.collection.objects.link(empty)
    bpy.ops.mimetic.bake_head(target="Follower", use_translation=False, smoothing=0.0)
    assert result()["object"] == "Follower" and result()["scene_frames"][0] == 1.0
    settings = scene.mimetic.head
    assert settings.target == empty and not settings.use_translation and settings.smoothing == 0.0
    num_turns = result()["num_curves"]
    bpy.ops.mimetic.bake_head(use_translation=True, translation_scale=2.0)
    assert result()["num_curves"] == num_turns + 3


def test_a_target_that_is_not_there_is_told(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    with pytest.raises(RuntimeError, match="no object Nobody"):
        bpy.ops.mimetic.bake_head(target="Nobody")
    assert result()["status"] == "CANCELLED"


def test_the_frames_of_a_capture_are_in_the_call(extension, scene, footage, monkeypatch):
    native = extension("native")
    asked = []

    def capture(path, frames, fit, lens, progress, corrections, so_far, summary):
        asked.append(frames)
        raise native.invalid_input("no face here")

    monkeypatch.setattr(native.clip_capture(), "capture", capture)
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = 5, 6
    for arguments in ({}, {"frame_first": 3}, {"frame_first": 3, "frame_last": 9}):
        with pytest.raises(RuntimeError, match="no face here"):
            bpy.ops.mimetic.capture(**arguments)
    assert asked == [(5, 6), (3, None), (3, 9)]
    with pytest.raises(RuntimeError, match="frames 9:3: the first is after the last"):
        bpy.ops.mimetic.capture(frame_first=9, frame_last=3)


def test_settings_of_a_call_are_of_that_call_alone(baked, scene):
    empty = bpy.data.objects.new("Follower", None)
    scene.collection.objects.link(empty)
    scene.mimetic.head.target = empty
    bpy.ops.mimetic.set_rest_frame(frame=7)
    assert scene.mimetic.head.rest_frame == 7 and result()["frame"] == 7
    bpy.ops.mimetic.set_rest_frame()
    shown = scene.mimetic.head.rest_frame
    assert shown != 7
    clip = scene.mimetic.clip
    last = clip.frame_duration
    with pytest.raises(RuntimeError, match=f"frame 5000: {clip.name} has frames 1 to {last}"):
        bpy.ops.mimetic.set_rest_frame(frame=5000)
    assert scene.mimetic.head.rest_frame == shown


def test_every_setting_of_a_panel_is_in_a_call(extension):
    """But for what is drawn alone, and the list of looks, which has operators of its own."""
    drawn = {"show_picture", "show_plots", "view_size", "view_corner"}
    drawn |= {"looks", "active_look", "advice"}
    calls = {
        prop.identifier
        for operator in extension("operators").CLASSES
        for prop in getattr(bpy.ops.mimetic, operator.bl_idname[8:]).get_rna_type().properties
    }
    groups = bpy.context.scene.mimetic.head, bpy.context.scene.mimetic.live
    names = {prop.identifier for group in groups for prop in group.bl_rna.properties}
    assert names - {"rna_type", "name"} - drawn - calls == set()
    assert {"lens", "frame_first", "frame_last", "value_name", "reach"} <= calls


def test_results_are_not_kept_in_files(scene, footage, tmp_path):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    assert result()["clip"]
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.context.window_manager.mimetic_result = ""
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.context.window_manager.mimetic_result == ""


def test_expressions_tell_their_actions(scene):
    bpy.ops.mimetic.add_face()
    assert result()["object"] == bpy.context.active_object.name
    face = bpy.context.active_object
    keys = [key for key in face.data.shape_keys.key_blocks if key.name.startswith("zygomaticus")]
    for key in keys:
        key.value = 0.5
    bpy.ops.mimetic.keep_expression(name="Smile")
    assert bpy.data.actions[result()["action"]].name == "Smile"
    bpy.ops.mimetic.apply_expression(action="Smile", share=0.5)
    assert (result()["object"], result()["action"]) == (face.name, "Smile")


def test_a_range_the_wrong_way_round_names_both_numbers(scene, footage, performance_file):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    for operator in (bpy.ops.mimetic.refine, bpy.ops.mimetic.capture):
        with pytest.raises(RuntimeError, match="frames 30:20: the first is after the last"):
            operator(frame_first=30, frame_last=20)
        assert result()["status"] == "CANCELLED"


def test_a_live_session_takes_its_settings_from_the_call(scene):
    bpy.ops.mimetic.add_face()
    with pytest.raises(RuntimeError, match="A camera needs Blender's window"):
        bpy.ops.mimetic.live(source="CAMERA", stillness=0.25, channels={"MOUTH"}, countdown=3)
    settings = scene.mimetic.live
    assert (settings.source, settings.stillness, settings.countdown) == ("CAMERA", 0.25, 3)
    assert settings.channels == {"MOUTH"}


def test_a_switch_tells_what_it_is_now(scene):
    bpy.ops.mimetic.add_face()
    for is_wire in (True, False):
        bpy.ops.mimetic.face_as_lines()
        assert (result()["operator"], result()["is_wire"]) == ("mimetic.face_as_lines", is_wire)
