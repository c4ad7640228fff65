# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks taught in a window: listed, kept by a key while a clip runs, saved as a set."""

import importlib
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, install, invoke, open_sidebar, override, press, start

PACKAGE = "bl_ext.user_default.mimetic"
CLOSED = ("muscles", "head", "capture")  # above the panel that is looked at


def part(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def is_idle() -> bool:
    return part("jobs").running is None


def open_panels() -> None:
    """As if their headers had been clicked on: what is open is no setting that a script reaches."""
    for name in (*CLOSED, "live", "live_looks"):
        classes = part(f"panels.{name}").CLASSES
        for cls in reversed(classes):
            bpy.utils.unregister_class(cls)
        for cls in classes:
            cls.bl_options = {"DEFAULT_CLOSED"} if name in CLOSED else set()
            bpy.utils.register_class(cls)


def prepare(walk: Walk) -> Steps:
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    open_panels()
    invoke("VIEW_3D", bpy.ops.mimetic.add_face)
    yield from walk.until(is_idle, 120, "adding the face ends")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_selected()
        bpy.ops.view3d.view_axis(type="FRONT")
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    settings = bpy.context.scene.mimetic.live
    settings.source, settings.use_teaching = "CLIP", True
    settings.clip_path = str(walk.folder / walk.settings["clip"])
    invoke("VIEW_3D", bpy.ops.mimetic.add_usual_looks)
    yield from walk.picture("looks-listed")


def keep(walk: Walk) -> Steps:
    settings = bpy.context.scene.mimetic.live
    invoke("VIEW_3D", bpy.ops.mimetic.live)
    session = part("live").active
    keeper, told = session.thread.keeper, []
    walk.check("the session teaches", keeper is not None)
    yield from walk.until(lambda: keeper.is_ready, 60, "the person's head is known")
    for name in ("neutral", "smile"):
        chosen = settings.looks[settings.active_look].name
        walk.check(f"{name} is chosen", chosen == name, chosen)
        press("VIEW_3D", "K")
        yield from walk.until(lambda name=name: name in keeper.kept, 60, f"{name} is kept")
    yield from walk.picture("looks-kept")
    path = walk.folder / "looks.npz"
    told += [invoke("VIEW_3D", bpy.ops.mimetic.save_set, filepath=str(path))]
    yield 0.5
    walk.check("the set is written while the session runs", path.exists(), told)
    walk.check("and named", settings.taught_set == str(path), settings.taught_set)
    yield from walk.picture("looks-saved")
    press("VIEW_3D", "ESC")
    yield from walk.until(is_idle, 60, "Esc ends the session")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from prepare(walk)
    yield from keep(walk)


start(steps)
