# SPDX-License-Identifier: GPL-3.0-or-later
"""The redo panel of every operator: a setting is changed in it by the screen's own mouse and keys,
and gives what a call with that value gives; an undo leaves nothing of either."""

import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import redo_panels
import redo_scenes
from redo_table import TABLE, Trial, with_settings
from undoing import PACKAGE, at_rest, becomes, difference, document, press
from walk import Steps, Walk, install, override, start


def call(trial: Trial, **options) -> set[str]:
    """As a button does: with a step for undo."""
    with bpy.context.temp_override(**override(trial.kind)):
        return getattr(bpy.ops.mimetic, trial.name)("EXEC_DEFAULT", True, **options)


def try_out(walk: Walk, trial: Trial) -> Steps:
    name, options, typed = f"redo-{trial.name}", dict(trial.options), trial.typed
    redo_scenes.opened(walk, trial.scene)
    redo_scenes.show_editor(trial.kind)
    if trial.is_file:
        options[trial.setting] = str(walk.folder / options[trial.setting])
        typed = str(walk.folder / typed)
    yield 0.2
    before = document()
    answer = call(trial, **options)
    walk.check(f"{trial.name} runs", answer == {"FINISHED"}, answer)
    at_first = document()
    yield from redo_panels.change(walk, name, trial.kind, trial.setting, typed, trial.row)
    changed = yield from at_rest(walk, name)
    walk.check(f"{trial.setting} changes what it gives", difference(at_first, changed))
    given = redo_panels.values()
    if trial.name in walk.settings["pictured"]:
        yield from walk.picture(name)
    yield from press(walk, f"{name}-undo", trial.kind, "ctrl+z")
    yield from becomes(walk, before, f"undo leaves nothing of {trial.name}")
    answer = call(trial, **given)
    walk.check("a call with what the panel shows runs", answer == {"FINISHED"}, answer)
    found = difference(changed, document())
    walk.check(f"and gives what the redo panel of {trial.name} gave", not found, found)


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.wm.save_as_mainfile(filepath=str(walk.folder / "empty.blend"))
    yield 0.5
    in_table = {trial.name for trial in TABLE}
    found = sorted(in_table ^ with_settings())
    walk.check("every operator with settings in its redo panel is tried", not found, found)
    for trial in TABLE:
        if walk.settings["only"] and trial.name not in walk.settings["only"]:
            continue
        begin = time.monotonic()
        yield from try_out(walk, trial)
        walk.arrays.setdefault("seconds", []).append([trial.name, time.monotonic() - begin])


start(steps)
