# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension comes, goes, and says why when it cannot work."""

import sys

import bpy
import pytest
from conftest import MODULE


def registered() -> set[str]:
    return {name for name in dir(bpy.types) if "mimetic" in name.lower()}


def test_switching_off_leaves_nothing(scene):
    assert registered()
    assert hasattr(scene, "mimetic")
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert registered() == set()
    assert not hasattr(scene, "mimetic")
    assert "mimetic.bake" not in dir(bpy.ops.mimetic)


def test_off_and_on_again(scene):
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert bpy.ops.preferences.addon_enable(module=MODULE) == {"FINISHED"}
    assert hasattr(scene, "mimetic")


@pytest.fixture
def without_module(monkeypatch):
    """A Blender whose Python the compiled module was not built for."""
    bpy.ops.preferences.addon_disable(module=MODULE)
    for name in [n for n in sys.modules if n == "mimetic" or n.startswith("mimetic.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "mimetic._core", None)
    monkeypatch.delitem(sys.modules, f"{MODULE}.native", raising=False)
    for name in [n for n in sys.modules if n.startswith(MODULE)]:
        monkeypatch.delitem(sys.modules, name)
    assert bpy.ops.preferences.addon_enable(module=MODULE) == {"FINISHED"}
    yield
    bpy.ops.preferences.addon_disable(module=MODULE)


def test_without_its_module_the_extension_says_why(without_module, extension):
    native = extension("native")
    assert native.status().state.name in ("missing", "broken")
    assert "Install" in native.problem() or "install" in native.problem()
    assert hasattr(bpy.types, "MIMETIC_PT_capture_view")
    for operator in ("load_clip", "find_face", "capture", "load_performance", "bake"):
        assert not getattr(bpy.ops.mimetic, operator).poll()
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.mimetic.bake()


def test_a_module_of_another_version_asks_for_a_restart(extension, monkeypatch):
    import mimetic

    native = extension("native")
    native.status.cache_clear()
    monkeypatch.setattr(mimetic, "__version__", "9.9.9")
    assert native.status().state is native.State.other_version
    assert "Restart Blender" in native.problem()
    native.status.cache_clear()


def test_grey_buttons_open_one_by_one(extension, scene, footage, performance_file):
    def open_buttons() -> set[str]:
        names = ("find_face", "capture", "bake", "export_gltf")
        return {name for name in names if getattr(bpy.ops.mimetic, name).poll()}

    assert open_buttons() == set()
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    assert open_buttons() == {"find_face", "capture"}
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    assert open_buttons() == {"find_face", "capture", "bake"}
    bpy.ops.mimetic.bake(use_texture=False)
    assert open_buttons() == {"find_face", "capture", "bake", "export_gltf"}


def test_reloading_the_file_keeps_the_extension_working(tmp_path, scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.mimetic.bake()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert bpy.context.scene.mimetic.face.name == "Face"
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
