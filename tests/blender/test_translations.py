# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of words and values are shown in Blender's language where a translation has them."""

import sys

import bpy
import numpy as np
import pytest
from conftest import MODULE
from german_texts import LANGUAGE, TEXTS
from last_result import result
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.rest_choice import RestChoice
from panel_texts import drawn

OWNER = "mimetic_german"


@pytest.fixture
def german(empty_file, monkeypatch):
    """Blender speaks German where the table has it.

    Blender as a module is built without translations, and gives every text back as it is: there
    the table stands for what it would look up. tests/window asks a whole Blender.
    """
    if not bpy.app.build_options.international:
        ours = [module for name, module in sys.modules.items() if name.startswith(MODULE)]
        for module in ours:
            for name in {"iface_", "rpt_"}.intersection(vars(module)):
                monkeypatch.setattr(module, name, look_up)
        yield
        return
    view = bpy.context.preferences.view
    bpy.app.translations.register(OWNER, {LANGUAGE: TEXTS})
    try:
        view.language = LANGUAGE
        view.use_translate_interface = view.use_translate_reports = True
        yield
    finally:
        bpy.app.translations.unregister(OWNER)
        view.language = "DEFAULT"


def look_up(text: str, context: str = "*") -> str:
    assert isinstance(text, str)
    return TEXTS.get((context, text), text)


def test_a_panel_is_drawn_in_blenders_language(german):
    assert "Muskeln an einem eigenen Kopf:" in drawn("MIMETIC_PT_muscles")


def test_a_grey_button_says_why_in_blenders_language(german, footage):
    with pytest.raises(RuntimeError, match=r"Zuerst den Film laden \(Clip laden\)"):
        bpy.ops.mimetic.find_face()
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    clip = bpy.context.scene.mimetic.clip.name
    with pytest.raises(RuntimeError, match=f"oder Darbietung laden: {clip} hat keine"):
        bpy.ops.mimetic.bake()


def test_a_report_is_in_blenders_language(german, footage):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    clip = bpy.context.scene.mimetic.clip
    assert result()["message"] == f"25 Bilder/s, 400 mal 300: {clip.name}"
    with pytest.raises(RuntimeError, match=f"{clip.name} hat {clip.frame_duration} Bilder, nicht"):
        bpy.ops.mimetic.set_rest_frame(frame=5000)


def test_why_a_frame_is_taken_as_rest_is_in_blenders_language(german, extension, footage):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    clip = bpy.context.scene.mimetic.clip
    assert "Rest = Shown Frame" in drawn("MIMETIC_PT_capture_clip")
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = 0.6
    size, camera = (400, 300), np.array([[480.0, 0, 199.5], [0, 480, 149.5], [0, 0, 1]])
    fit = FaceFit(4, size, camera, pose, {}, rest=RestChoice("usual", 16, 11))
    extension("scene_out").face_fit.keep(clip, fit)
    texts = drawn("MIMETIC_PT_capture_clip")
    assert "Ruhe ist Bild 4: 11 von 16 Bildern zeigen diesen Ausdruck" in " ".join(texts.split())


def test_a_job_is_named_in_blenders_language(german, extension):
    jobs = extension("jobs")
    jobs.running = jobs.Run(jobs.iface_("Capture", "Operator"))
    try:
        assert jobs.busy() == "Aufnehmen läuft; Esc beendet es"
    finally:
        jobs.running = None


def test_without_a_translation_it_is_english(footage):
    with pytest.raises(RuntimeError, match=r"Load the footage first \(Load Clip\)"):
        bpy.ops.mimetic.find_face()
    assert "Muscles on a head of your own:" in drawn("MIMETIC_PT_muscles")
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    assert result()["message"].endswith(": 400 x 300, 25 frames/s")
