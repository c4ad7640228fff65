# SPDX-License-Identifier: GPL-3.0-or-later
"""No line of a panel is cut off in a sidebar of 300 pixels, whatever state the scene is in."""

import bpy
import pytest
from recorded_layout import drawn, text_width

WIDGETS = 243  # pixels that they have in a sidebar of 300, beside its tabs and the panel's frame


@pytest.fixture
def cut_off(extension, monkeypatch):
    """Texts of all panels that show something, each with the pixels that it lacks."""
    paragraph = extension("panels.paragraph")
    monkeypatch.setattr(paragraph, "_measure", lambda: (300 - paragraph.MARGINS, text_width))

    def find():
        found, num_drawn = [], 0
        for panel in extension("panels").CLASSES:
            if not issubclass(panel, bpy.types.Panel):
                continue
            if getattr(panel, "poll", lambda _: True)(bpy.context):
                num_drawn += 1
                found += [
                    f"{panel.bl_idname}: {text} ({width - WIDGETS:.0f} more)"
                    for text, width in drawn(panel, bpy.context).wider_than(WIDGETS)
                ]
        assert num_drawn > 5
        return found

    return find


def test_a_row_that_is_too_wide_is_noticed(extension, cut_off, monkeypatch):
    panel = extension("panels").head.MIMETIC_PT_head_view
    monkeypatch.setattr(panel, "draw", lambda self, context: self.layout.label(text="wide " * 12))
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
