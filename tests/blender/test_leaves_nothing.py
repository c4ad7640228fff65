# SPDX-License-Identifier: GPL-3.0-or-later
"""Switched off and on, undone and redone many times: nothing of the extension is left behind."""

import gc
import sys
import threading
from types import FunctionType

import bpy
import pytest
from conftest import MODULE, enable

SWITCHES, UNDOS = 50, 20
ENABLE = bpy.ops.preferences.addon_enable
DISABLE = bpy.ops.preferences.addon_disable


def handlers() -> dict[str, int]:
    return {
        name: len(entries)
        for name in dir(bpy.app.handlers)
        if isinstance(entries := getattr(bpy.app.handlers, name), list)
    }


def data_blocks() -> dict[str, int]:
    """How many there are of each kind."""
    kinds = {
        name: getattr(bpy.data, name)
        for name in dir(bpy.data)
        if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    }
    return {name: len(blocks) for name, blocks in kinds.items()}


def functions() -> list[FunctionType]:
    """All of the extension's, which might be a timer."""
    modules = [module for name, module in sys.modules.items() if name.startswith(MODULE)]
    return [
        thing
        for module in modules
        for thing in vars(module).values()
        if isinstance(thing, FunctionType)
    ]


def registered() -> set[str]:
    return {name for name in dir(bpy.types) if "mimetic" in name.lower()}


@pytest.fixture
def drawn(monkeypatch):
    """Draw callbacks that are registered now: Blender does not list them."""
    kept = []
    for space in (bpy.types.SpaceView3D, bpy.types.SpaceClipEditor):
        add, remove = space.draw_handler_add, space.draw_handler_remove

        def added(*given, add=add):
            kept.append(add(*given))
            return kept[-1]

        def removed(handle, *given, remove=remove):
            if handle in kept:  # else of before the test
                kept.remove(handle)
            return remove(handle, *given)

        monkeypatch.setattr(space, "draw_handler_add", added, raising=False)
        monkeypatch.setattr(space, "draw_handler_remove", removed, raising=False)
    return kept


def test_fifty_times_off_and_on_leave_nothing(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.mimetic.bake()
    on = handlers(), threading.active_count(), data_blocks(), registered()
    for _ in range(SWITCHES):
        timers = functions()
        assert len(timers) > 100
        assert DISABLE(module=MODULE) == {"FINISHED"}
        assert [one.__name__ for one in timers if bpy.app.timers.is_registered(one)] == []
        assert registered() == set()
        assert ENABLE(module=MODULE) == {"FINISHED"}
    assert (handlers(), threading.active_count(), data_blocks(), registered()) == on
    DISABLE(module=MODULE)
    assert not any(
        getattr(one, "__module__", "").startswith(MODULE)
        for name in handlers()
        for one in getattr(bpy.app.handlers, name)
    )


def test_handlers_go_although_an_error_ended_the_timer_beside_them(extension):
    before, dragged = handlers(), extension("dragged_landmarks")
    extension("handlers").add(dragged.HANDLERS)  # as in a window
    assert handlers() != before and not bpy.app.timers.is_registered(dragged.watch)
    dragged.unregister()
    assert handlers() == before
    dragged.unregister()  # another extension may have emptied a list


def test_draw_callbacks_go_with_the_extension(drawn):
    if MODULE in bpy.context.preferences.addons:
        DISABLE(module=MODULE)
    drawn.clear()
    enable_again = ENABLE(module=MODULE)
    assert enable_again == {"FINISHED"}
    count = len(drawn)
    if count == 0:
        pytest.skip("this Blender draws nothing without a window, or its callbacks cannot be seen")
    for _ in range(3):
        DISABLE(module=MODULE)
        assert drawn == []
        ENABLE(module=MODULE)
        assert len(drawn) == count


def test_twenty_undos_and_redos_leave_as_much_as_there_was(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.ed.undo_push(message="loaded")
    before = data_blocks()
    bpy.ops.mimetic.bake(use_contact=False)
    bpy.ops.ed.undo_push(message="baked")
    after, on, threads = data_blocks(), handlers(), threading.active_count()
    assert after != before
    window = bpy.context.window_manager.windows[0]
    for _ in range(UNDOS):
        with bpy.context.temp_override(window=window, screen=window.screen):
            assert bpy.ops.ed.undo() == {"FINISHED"}
            assert data_blocks() == before
            assert bpy.ops.ed.redo() == {"FINISHED"}
            assert data_blocks() == after
    gc.collect()
    assert (handlers(), threading.active_count()) == (on, threads)


def test_the_extension_is_enabled_at_the_end():
    """Other tests of the file leave it as they found it."""
    if MODULE not in bpy.context.preferences.addons:
        enable()
    assert registered()
