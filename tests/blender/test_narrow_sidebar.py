# SPDX-License-Identifier: GPL-3.0-or-later
"""No line of a panel is cut off in a sidebar of 300 pixels, whatever state the scene is in."""

import time
from pathlib import Path

import bpy
import pytest
from recorded_layout import drawn, text_width

LONG = "interview_sc03_tk07.mp4"
LONGEST = "interview_sc03_tk07_cam_B_graded_without_sound_v12.mp4"
WIDGETS = 243  # pixels that they have in a sidebar of 300, beside its tabs and the panel's frame


@pytest.fixture
def cut_off(extension, monkeypatch):
    """Texts of all panels that show something, each with the pixels that it lacks."""
    paragraph = extension("panels.paragraph")
    narrow = (300 - paragraph.MARGINS, text_width, paragraph.UNIT)
    monkeypatch.setattr(paragraph, "_measure", lambda: narrow)

    def find():
        found, num_drawn = [], 0
        for panel in extension("panels").CLASSES:
            if not issubclass(panel, bpy.types.Panel):
                continue
            if getattr(panel, "poll", lambda _: True)(bpy.context):
                num_drawn += 1
                layout = drawn(panel, bpy.context)
                lacks = [(text, width - WIDGETS) for text, width in layout.wider_than(WIDGETS)]
                found += [
                    f"{panel.bl_idname}: {text} ({width:.0f} more)"
                    for text, width in [*lacks, *layout.overfull()]
                ]
        assert num_drawn > 5
        return found

    return find


def test_a_row_that_is_too_wide_is_noticed(extension, cut_off, monkeypatch):
    panel = extension("panels").head.MIMETIC_PT_head_view
    monkeypatch.setattr(panel, "draw", lambda self, context: self.layout.label(text="wide " * 12))
    assert any("wide wide" in text for text in cut_off())


def test_a_row_of_a_list_that_is_too_wide_is_noticed(
    extension, scene, footage, acted, cut_off, monkeypatch
):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    bpy.ops.mimetic.bake(use_texture=False, use_contact=False)
    assert cut_off() == []
    monkeypatch.setattr(extension("panels").list_rows, "row_name", lambda *_: "wide " * 8)
    assert any("wide wide" in text for text in cut_off())


def test_an_empty_scene(cut_off):
    assert cut_off() == []


@pytest.mark.parametrize("source", ["CAMERA", "CLIP"])
def test_live_sources(scene, cut_off, source):
    scene.mimetic.live.source = source
    assert cut_off() == []


def test_a_clip_and_a_head_to_drive(scene, footage, cut_off):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    settings = scene.mimetic.head
    rig = bpy.data.objects.new("Hero Rig", bpy.data.armatures.new("Hero Rig"))
    scene.collection.objects.link(rig)
    settings.target, settings.use_translation = rig, True
    assert cut_off() == []


def test_a_baked_face(scene, footage, acted, cut_off):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    bpy.ops.mimetic.bake(use_texture=False)
    assert scene.mimetic.face is not None
    assert cut_off() == []
    bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.5, frame=7)
    assert cut_off() == []
    for name, value in (("levator_labii_superioris_alaeque_nasi.L", 0.5), ("lip_gap", 0.004)):
        bpy.ops.mimetic.correct_value(value_name=name, value=value, frame=7)
    bpy.ops.mimetic.correct_pose(turn=(0.0, 2.0, 0.0), frame=7)
    scene.frame_set(7)
    assert cut_off() == []


@pytest.fixture(params=[LONG, LONGEST])
def long_clip(request, footage, tmp_path):
    path = tmp_path / request.param
    path.write_bytes(footage.read_bytes())
    bpy.ops.mimetic.load_clip(filepath=str(path))
    return bpy.context.scene.mimetic.clip


def test_a_clip_with_a_long_name_and_its_take(scene, long_clip, acted, tmp_path, cut_off):
    assert cut_off() == []
    path = tmp_path / long_clip.name.replace(".mp4", ".002.performance.npz")
    path.write_bytes(Path(acted[1]).read_bytes())
    bpy.ops.mimetic.load_performance(filepath=str(path))
    assert cut_off() == []
    for _ in range(2):
        bpy.ops.mimetic.bake(use_texture=False, use_contact=False)
    takes = scene.mimetic.face.mimetic.takes
    takes[0].is_edited, takes[1].num_lost, takes[1].last = True, 1234, 23456
    assert cut_off() == []
    path.unlink()
    assert cut_off() == []
    Path(bpy.path.abspath(long_clip.filepath)).unlink()
    assert cut_off() == []


def test_a_head_with_a_long_name(scene, long_clip, acted, cut_off):
    bpy.ops.mimetic.add_face()
    head = bpy.context.active_object
    head.name = LONGEST
    bpy.ops.mimetic.load_performance(filepath=acted[1])
    assert cut_off() == []
    control = head.mimetic.controls.add()
    control.name, control.is_edited = "CTRL_L_mouth_cornerPull_corrective_02", True
    assert cut_off() == []


def test_a_job_at_work_and_jobs_that_wait(extension, long_clip, cut_off, monkeypatch):
    jobs = extension("jobs")
    run = jobs.Run("Calibrate", long_clip.name)
    run.fraction, run.begun = 0.12, time.monotonic() - 300
    run.what = "following the face from the reference frame 123 to 4567: frame 2345"
    monkeypatch.setattr(jobs, "running", run)
    monkeypatch.setattr(jobs, "waiting", [jobs.Run("Capture", LONG), jobs.Run("Capture", LONGEST)])
    assert cut_off() == []
