# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's ordinary tools work on what was baked: on shape keys and on a control object."""

from contextlib import contextmanager

import bpy
import numpy as np
import pytest
from test_control_object import baked, control_of, of_the_muscles

pytestmark = pytest.mark.oldest_and_newest


@pytest.fixture(params=["KEYS", "CONTROLS"])
def animated(request, extension, scene, performance):
    """What holds the curves of a baked face, and a curve of a muscle: its holder and path."""
    face = baked(extension, scene, performance, use_controls=request.param == "CONTROLS")
    bpy.context.view_layer.objects.active = face
    if request.param == "KEYS":
        return face.data.shape_keys, f'key_blocks["{performance.muscles[0]}"].value'
    control = control_of(face)
    bpy.context.view_layer.objects.active = control
    control.select_set(True)
    return control, f'pose.bones["{performance.muscles[0]}"]["activation"]'


@pytest.fixture
def posed(extension, scene, performance):
    """A control object in pose mode, without a take."""
    control = control_of(baked(extension, scene, performance, use_controls=True))
    control.animation_data.action = None
    for bone in control.pose.bones:
        for name, _ in bone.items():
            bone[name] = 0.0
    bpy.context.view_layer.objects.active = control
    bpy.ops.object.mode_set(mode="POSE")
    return control


def curve_of(extension, animated) -> bpy.types.FCurve:
    block, path = animated
    return extension("compat").curves(block).fcurves.find(path)


@contextmanager
def graph_editor():
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "GRAPH_EDITOR"
    area.spaces.active.dopesheet.show_only_selected = False
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        yield


def test_keys_decimate(extension, animated):
    with graph_editor():
        bpy.ops.graph.select_all(action="SELECT")
        assert bpy.ops.graph.decimate(mode="ERROR", remove_error_margin=0.05) == {"FINISHED"}
    curve = curve_of(extension, animated)
    assert 2 <= len(curve.keyframe_points) < 40


def test_the_graph_editor_smooths(extension, animated):
    curve = curve_of(extension, animated)
    curve.keyframe_points[20].co.y += 0.3
    curve.update()
    with graph_editor():
        bpy.ops.graph.select_all(action="SELECT")
        assert bpy.ops.graph.gaussian_smooth(sigma=2.0) == {"FINISHED"}
    values = np.array([p.co.y for p in curve_of(extension, animated).keyframe_points])
    assert abs(values[20] - 0.5 * (values[19] + values[21])) < 0.1


def test_strips_blend_two_takes(extension, scene, animated):
    block, path = animated
    animation = block.animation_data
    values = [value_at(scene, block, path, frame) for frame in (1, 20)]
    take = animation.action
    animation.action = None
    lower = animation.nla_tracks.new()
    extension("compat").add_strip(lower, "first", 1, take)
    upper = animation.nla_tracks.new()
    upper_strip = extension("compat").add_strip(upper, "second", 20, take)
    upper_strip.use_auto_blend = False
    upper_strip.use_animated_influence = True
    upper_strip.influence = 0.5
    upper_strip.keyframe_insert("influence", frame=20)
    assert value_at(scene, block, path, 1) == pytest.approx(values[0], abs=1e-5)
    both = value_at(scene, block, path, 20)
    assert both == pytest.approx(0.5 * (values[0] + values[1]), abs=1e-5)


def value_at(scene, block, path: str, frame: int) -> float:
    scene.frame_set(frame)
    return float(block.path_resolve(path))


def test_the_pose_library_applies_and_blends(extension, posed, performance):
    name = performance.muscles[0]
    compat = extension("compat")
    action, holder = compat.free_action("smile", "OBJECT")
    for path, value in ((f'pose.bones["{name}"]["activation"]', 0.8),):
        compat.new_curve(holder, path, 0, name).keyframe_points.insert(1, value)
    bpy.ops.pose.select_all(action="SELECT")
    posed.pose.blend_pose_from_action(action, blend_factor=0.5, evaluation_time=1)
    assert posed.pose.bones[name]["activation"] == pytest.approx(0.4)
    posed.pose.apply_pose_from_action(action, evaluation_time=1)
    assert posed.pose.bones[name]["activation"] == pytest.approx(0.8)
    bpy.context.view_layer.update()
    face = bpy.context.scene.mimetic.face
    evaluated = face.data.shape_keys.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert evaluated.key_blocks[name].value == pytest.approx(0.8)


def test_a_pose_is_pasted_mirrored(posed):
    name = of_the_muscles(posed)
    assert name.endswith(".L")
    posed.pose.bones[name]["activation"] = 0.7
    jaw = posed.pose.bones["jaw"]
    jaw.location.x = 0.01
    bpy.ops.pose.select_all(action="SELECT")
    bpy.ops.pose.copy()
    assert bpy.ops.pose.paste(flipped=True) == {"FINISHED"}
    assert posed.pose.bones[f"{name[:-2]}.R"]["activation"] == pytest.approx(0.7)
    assert posed.pose.bones[name]["activation"] == pytest.approx(0.0)
    assert jaw.location.x == pytest.approx(-0.01)


def test_bones_are_baked_by_blender(extension, scene, performance):
    """What Rigify's own bake calls: a key a frame of what bones do, their properties too."""
    control = control_of(baked(extension, scene, performance, use_controls=True))
    before = control.animation_data.action
    path = f'pose.bones["{performance.muscles[0]}"]["activation"]'
    expected = [value_at(scene, control, path, frame) for frame in (5, 20)]
    bpy.context.view_layer.objects.active = control
    bpy.ops.object.mode_set(mode="POSE")
    bpy.ops.pose.select_all(action="SELECT")
    baked_kinds = {"bake_types": {"POSE"}, "channel_types": {"LOCATION", "ROTATION", "PROPS"}}
    bpy.ops.nla.bake(frame_start=1, frame_end=40, only_selected=True, **baked_kinds)
    assert control.animation_data.action != before
    actual = [value_at(scene, control, path, frame) for frame in (5, 20)]
    np.testing.assert_allclose(actual, expected, atol=1e-5)


def test_a_bones_path_is_drawn(posed, scene):
    """Motion paths need bones that move in space."""
    bpy.ops.pose.select_all(action="SELECT")
    bpy.ops.pose.paths_calculate()
    assert posed.pose.bones["jaw"].motion_path is not None
