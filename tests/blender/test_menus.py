# SPDX-License-Identifier: GPL-3.0-or-later
"""F3 finds what is in a menu: every button is in one."""

import bpy
import pytest
from panel_texts import Layout, drawn

MENUS = {"VIEW3D_MT_object": "MIMETIC_MT_object", "VIEW3D_MT_pose": "MIMETIC_MT_object"} | {
    "CLIP_MT_clip": "MIMETIC_MT_clip"
}


def test_every_operator_with_a_label_is_in_a_menu(extension):
    shown = " ".join(drawn(name) for name in set(MENUS.values())).split()
    operators = extension("operators").CLASSES
    internal = [one for one in operators if "INTERNAL" in getattr(one, "bl_options", ())]
    named = [one.bl_idname for one in operators if one.bl_label and one not in internal]
    assert len(named) > 20
    assert [name for name in named if name not in shown] == []
    assert [one.bl_idname for one in internal if one.bl_idname in shown] == []


def test_what_drives_a_face_is_in_the_objects_menu():
    shown = drawn("MIMETIC_MT_object").split()
    assert "mimetic.live" in shown and "mimetic.bake" in shown


@pytest.mark.parametrize("name", ["MIMETIC_MT_object", "MIMETIC_MT_clip"])
def test_menus_name_operators_that_exist(extension, name):
    known = {operator.bl_idname for operator in extension("operators").CLASSES}
    shown = [word for word in drawn(name).split() if word.startswith("mimetic.")]
    assert len(shown) == len(set(shown))
    assert set(shown) <= known


@pytest.mark.parametrize("place", MENUS)
def test_blenders_own_menus_show_ours(place):
    class Menu:
        pass

    menu = Menu()
    menu.layout = Layout([])
    for draw in getattr(bpy.types, place)._dyn_ui_initialize():
        if draw.__module__.startswith("bl_ext"):
            draw(menu, bpy.context)
    assert menu.layout.texts == [MENUS[place]]


def test_nothing_is_left_in_blenders_menus(extension):
    before = len(bpy.types.CLIP_MT_clip._dyn_ui_initialize())
    extension("menus").unregister()
    try:
        assert len(bpy.types.CLIP_MT_clip._dyn_ui_initialize()) == before - 1
        assert not hasattr(bpy.types, "MIMETIC_MT_clip")
    finally:
        extension("menus").register()


@pytest.mark.parametrize("name", ["capture", "head"])
def test_both_editors_have_the_panels(name):
    assert drawn(f"MIMETIC_PT_{name}_view") == drawn(f"MIMETIC_PT_{name}_clip") != ""
