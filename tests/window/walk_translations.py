# SPDX-License-Identifier: GPL-3.0-or-later
"""A translation is registered: a panel, a grey button and a report speak its language at once."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, install, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
OWNER = "mimetic_german"


class Texts:
    """Stands for a UILayout, and for all that one gives; keeps the texts of its labels."""

    def __init__(self) -> None:
        self.labels: list[str] = []

    def __getattr__(self, name: str):
        return self._answer

    def _answer(self, *_: object, text: str = "", **__: object) -> "Texts":
        self.labels.append(text)
        return self


def said(operator, **arguments: object) -> str:
    """Why it cannot run, or the error that it reports."""
    try:
        with bpy.context.temp_override(**override("VIEW_3D")):
            operator(**arguments)
    except RuntimeError as error:
        return str(error).strip()
    return ""


def labels() -> list[str]:
    shown = Texts()
    panel = bpy.types.MIMETIC_PT_muscles
    with bpy.context.temp_override(**override("VIEW_3D")):
        panel.draw_attaching(SimpleNamespace(), shown, bpy.context)
    return shown.labels


def look(walk: Walk, language: str, claims: dict) -> None:
    clip = bpy.context.scene.mimetic.clip
    found = {
        "panel": " ".join(labels()),
        "grey button": said(bpy.ops.mimetic.bake),
        "error": said(bpy.ops.mimetic.set_rest_frame, frame=5000),
    }
    path = str(walk.folder / walk.settings["clip"])
    bpy.ops.mimetic.load_clip(filepath=path)
    result = json.loads(bpy.context.window_manager.mimetic_result)
    found["report"] = result["message"]
    for place, text in claims.items():
        text = text.replace("CLIP", clip.name)
        walk.check(f"the {place} is in {language}", text in found[place], found[place])


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    walk.check("this Blender has translations", bpy.app.build_options.international)
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    look(walk, "English", walk.settings["english"])
    table = {(context, text): other for context, text, other in walk.settings["texts"]}
    language = walk.settings["language"]
    bpy.app.translations.register(OWNER, {language: table})
    view = bpy.context.preferences.view
    view.language = language
    view.use_translate_interface = view.use_translate_reports = True
    yield 1.0
    look(walk, "German", walk.settings["german"])
    yield from walk.picture("german")
    bpy.app.translations.unregister(OWNER)
    look(walk, "English again", walk.settings["english"])


start(steps)
