# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage to a corrected, baked and exported face by operators alone, in every Blender that is
claimed; after each step an undo leaves nothing of it, and a redo brings all of it back."""

import bpy
import numpy as np
import pytest
from last_result import result
from scene_state import assert_same, in_window, state

FRAMES = {"frame_first": 1, "frame_last": 6}
REST, CORRECTED = 3, 4


@pytest.fixture
def step(extension):
    """Calls an operator; the same scene is there again after undo and redo."""

    def step(name: str, **options) -> dict:
        before = state(extension)
        operator = getattr(bpy.ops.mimetic, name)
        assert operator("EXEC_DEFAULT", True, **options) == {"FINISHED"}, name
        answer, after = result(), state(extension)
        with pytest.raises(AssertionError):
            assert_same(before, after)
        in_window(bpy.ops.ed.undo)
        assert_same(before, state(extension), f"undo of {name}")
        in_window(bpy.ops.ed.redo)
        assert_same(after, state(extension), f"redo of {name}")
        return answer

    return step


def captured(extension):
    from mimetic.performance.document import Performance

    scene = bpy.context.scene
    return Performance.load(extension("takes").find(extension("clips").find(scene.mimetic.clip)))


def drag_landmark(clip, name: str) -> None:
    """As the mouse does it, by some pixels."""
    track = clip.tracking.objects["Face"].tracks[name]
    marker = track.markers.find_frame(REST)
    marker.co = (marker.co[0] + 4 / clip.size[0], marker.co[1])
    track.select = True


def skin_place(performance) -> tuple[float, float]:
    """Where the nose's tip is seen in the corrected frame, in pixels."""
    from mimetic.template.face_template import load_template

    surface = performance.surface_in_camera(performance.index_of(CORRECTED))
    x, y = performance.project(surface[[load_template().landmark("nose_tip")]])[0]
    return float(x), float(y)


def test_footage_becomes_a_corrected_baked_face(extension, step, clip_path, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.ed.undo_push(message="before")
    step("load_clip", filepath=str(clip_path))
    step("find_face", frame=REST)
    step("capture", **FRAMES)
    first = captured(extension)
    np.testing.assert_array_equal(first.frame, range(1, 7))

    drag_landmark(bpy.context.scene.mimetic.clip, "mouth_corner.L")
    bpy.context.scene.frame_current = REST
    bpy.ops.ed.undo_push(message="dragged")
    step("pin")
    assert extension("scene_out").face_fit.of_clip(bpy.context.scene.mimetic.clip).pins[REST]

    x, y = skin_place(first)
    step("pin_skin", frame=CORRECTED, grab=(x, y), to=(x, y - 2), reach=2.0)
    step("correct_value", frame=CORRECTED, value_name="lid_upper.L", value=0.5)
    refined = step("refine")
    assert refined["frames"] == [CORRECTED]
    value_at = extension("native").correcting().value_at
    assert value_at(captured(extension), CORRECTED, "lid_upper.L") == pytest.approx(0.5, abs=0.1)
    assert abs(skin_place(captured(extension))[1] - (y - 2)) < 1

    baked = step("bake", use_few_keys=True)
    assert baked["object"] == bpy.context.scene.mimetic.face.name
    step("smooth_curves", seconds=0.1)
    assert bpy.ops.mimetic.export_gltf(filepath=str(tmp_path / "face.glb")) == {"FINISHED"}
    assert (tmp_path / "face.glb").stat().st_size > 100_000
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert len(bpy.context.scene.mimetic.face.mimetic.takes) == 1
