# SPDX-License-Identifier: GPL-3.0-or-later
"""Where clip and scene part in time, it is said; one button brings them together."""

from fractions import Fraction

import bpy
import numpy as np
import pytest
from panel_texts import drawn

NTSC = {"24000/1001": (24, 1.001), "30000/1001": (30, 1.001), "25": (25, 1.0), "0.5": (1, 2.0)}


@pytest.fixture(params=NTSC)
def clip_at(request, tmp_path):
    """Twelve black frames at a rate, as the scene's clip; the rate."""
    from imageio_ffmpeg import write_frames

    path = tmp_path / "black.mp4"
    writer = write_frames(str(path), (64, 48), fps=Fraction(request.param), macro_block_size=1)
    writer.send(None)
    for _ in range(12):
        writer.send(np.zeros((48, 64, 3), np.uint8).tobytes())
    writer.close()
    scene = bpy.context.scene
    scene.mimetic.clip = bpy.data.movieclips.load(str(path))
    return request.param


def time_of(scene) -> tuple:
    render = scene.render
    return render.fps, round(render.fps_base, 6), scene.frame_start, scene.frame_end


def test_the_scene_gets_the_clips_rate_and_range_exactly(scene, clip_at):
    fps, base = NTSC[clip_at]
    scene.render.fps, scene.render.fps_base = 60, 1.0
    clip = scene.mimetic.clip
    clip.frame_start, clip.frame_offset = 1001, 2
    scene.frame_start, scene.frame_end = 1, 250
    assert bpy.ops.mimetic.scene_as_clip() == {"FINISHED"}
    assert (scene.render.fps, scene.render.fps_base) == (fps, np.float32(base))
    assert (scene.frame_start, scene.frame_end) == (1001, 1010)  # two of twelve are skipped
    rate = Fraction(clip_at)
    assert fps / scene.render.fps_base == pytest.approx(float(rate), rel=1e-7)
    assert not bpy.ops.mimetic.scene_as_clip.poll()  # nothing is left to do


@pytest.mark.parametrize(("start", "range"), [(1000, (1000, 1039)), (-9, (0, 30))])
def test_the_range_goes_where_the_clip_is(scene, footage, start, range):
    """A scene's range starts at 0 at the earliest."""
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    scene.mimetic.clip.frame_start = start
    bpy.ops.mimetic.scene_as_clip()
    assert (scene.frame_start, scene.frame_end) == range
    assert not bpy.ops.mimetic.scene_as_clip.poll()


def test_the_panels_say_where_the_rates_part_and_only_there(scene, footage, performance_file):
    scene.render.fps, scene.render.fps_base = 24, 1.0
    assert "frames/s" not in drawn("MIMETIC_PT_capture_view")
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    for panel in ("MIMETIC_PT_capture_view", "MIMETIC_PT_capture_clip"):
        output = drawn(panel)
        assert "The clip has 25 frames/s, the scene 24" in output
        assert "mimetic.scene_as_clip" in output
    scene.render.fps = 25
    assert "mimetic.scene_as_clip" not in drawn("MIMETIC_PT_capture_view")


def test_the_scene_is_never_changed_unasked(scene, footage, performance_file):
    scene.render.fps, scene.render.fps_base = 24, 1.001
    before = time_of(scene)
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.mimetic.bake()
    drawn("MIMETIC_PT_capture_view")
    assert time_of(scene) == before


def test_it_is_one_undo_step_and_the_same_again(footage):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 24, 1.001
    before = time_of(bpy.context.scene)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.scene_as_clip("EXEC_DEFAULT", True) == {"FINISHED"}
    after = time_of(bpy.context.scene)
    assert after == (25, 1.0, 1, 40)
    bpy.ops.ed.undo()
    assert time_of(bpy.context.scene) == before
    bpy.ops.ed.redo()
    assert time_of(bpy.context.scene) == after


def test_afterwards_picture_and_face_show_the_same_frame(extension, scene, footage, performance):
    """What the clip editor shows in a scene frame is what the face plays there."""
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    scene.render.fps, scene.render.fps_base = 30, 1.001
    scene_in = extension("scene_in")
    clock = scene_in.timing(scene, scene.mimetic.clip)
    assert scene_in.scene_frames(performance, clock)[-1] != performance.frame[-1]
    bpy.ops.mimetic.scene_as_clip()
    clock = scene_in.timing(scene, scene.mimetic.clip)
    np.testing.assert_array_equal(scene_in.scene_frames(performance, clock), performance.frame)


def test_a_clip_without_its_file_has_no_rate(footage, tmp_path):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.context.scene.mimetic.clip.filepath = "//nowhere.mp4"
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert not bpy.ops.mimetic.scene_as_clip.poll()
    assert "frames/s" not in drawn("MIMETIC_PT_capture_view")


def test_numbered_pictures_give_their_range_at_the_scenes_rate(scene, tmp_path):
    for number in range(1001, 1006):
        picture = bpy.data.images.new("black", 8, 8)
        picture.filepath_raw, picture.file_format = str(tmp_path / f"shot.{number}.png"), "PNG"
        picture.save()
    scene.render.fps, scene.render.fps_base = 24, 1.0
    clip = scene.mimetic.clip = bpy.data.movieclips.load(str(tmp_path / "shot.1001.png"))
    assert clip.source == "SEQUENCE"
    clip.frame_start = 1001
    assert bpy.ops.mimetic.scene_as_clip() == {"FINISHED"}
    assert time_of(scene) == (24, 1.0, 1001, 1005)
    assert not bpy.ops.mimetic.scene_as_clip.poll()
