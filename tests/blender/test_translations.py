# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of words and values are shown in Blender's language where a translation has them."""

import sys

import bpy
import pytest
from conftest import MODULE
from german_texts import LANGUAGE, TEXTS
from last_result import result
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
