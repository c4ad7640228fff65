# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a live take of a clip lies in the scene: in step with the clip, and with its sound."""

import bpy
import numpy as np
import pytest
from last_result import result
from live_clip import ffmpeg, play_unpaced
from test_live import SMILE, Session, curves_of, slider, strips_of
from test_own_controls import character  # noqa: F401

pytestmark = pytest.mark.newest

GREY, NUM_FRAMES, RATE = 10, 25, 30  # pictures without a face, and all


@pytest.fixture(scope="session")
def late_clip(tmp_path_factory):
    """A man's face after a third of a second of grey; with a sound."""
    from fetched_footage import fetched_clip

    path = tmp_path_factory.mktemp("late") / "late.mkv"
    ffmpeg(
        *("-i", str(fetched_clip("single_face.mp4"))),
        *("-f", "lavfi", "-i", "sine=frequency=440:sample_rate=48000", "-shortest"),
        *("-vf", f"tpad=start={GREY}:color=gray", "-map", "0:v", "-map", "1:a"),
        *("-frames:v", str(NUM_FRAMES), "-c:v", "ffv1", "-c:a", "pcm_s16le", str(path)),
    )
    return path


@pytest.fixture
def face(scene):
    scene.render.fps, scene.render.fps_base = RATE, 1.0
    scene.mimetic.live.source = "CLIP"
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return bpy.context.active_object


@pytest.fixture
def clip(scene, face, late_clip):
    """The scene's, trimmed."""
    clip = scene.mimetic.clip = bpy.data.movieclips.load(str(late_clip))
    clip.frame_start, clip.frame_offset = 101, 4
    return clip


def keyed(extension, face) -> np.ndarray:
    points = curves_of(extension, face.data.shape_keys)[slider(SMILE)].keyframe_points
    return np.array([point.co[0] for point in points])


def recorded():
    from mimetic.performance.document import Performance

    return Performance.load(result()["takes"][0])


def test_the_scenes_own_clip_is_keyed_where_the_scene_shows_it(scene, face, clip, extension):
    scene.frame_set(7)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    take, scene_in = recorded(), extension("scene_in")
    np.testing.assert_array_equal(take.frame, np.arange(GREY + 1, NUM_FRAMES + 1))
    assert take.footage == [clip.name, extension("clips").fingerprint(clip)]
    frames = keyed(extension, face)
    np.testing.assert_allclose(frames, [scene_in.scene_frame(clip, n) for n in take.frame])
    if bpy.app.build_options.audaspace:
        (strip,) = strips_of(scene)
        assert strip.frame_start == pytest.approx(frames[0])


@pytest.mark.parametrize("scene_rate", [RATE, 24])
def test_a_named_clip_begins_at_the_scenes_frame(
    scene, face, clip, late_clip, extension, scene_rate
):
    scene.mimetic.live.clip_path = str(late_clip)
    scene.render.fps = scene_rate
    scene.frame_set(7)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    numbers = np.arange(GREY, NUM_FRAMES)
    np.testing.assert_array_equal(recorded().frame, 1 + numbers)
    frames = keyed(extension, face)
    np.testing.assert_allclose(frames, 7 + numbers * scene_rate / RATE, atol=1e-4)
    if bpy.app.build_options.audaspace:
        (strip,) = strips_of(scene)
        assert strip.frame_start == pytest.approx(frames[0], abs=1e-4)


@pytest.mark.parametrize("is_named", [False, True])
def test_a_take_that_is_punched_in(scene, face, clip, late_clip, extension, monkeypatch, is_named):
    """Over the scene's clip it lies where that shows it, else from the scene's frame on."""
    scene.mimetic.live.clip_path = str(late_clip) if is_named else ""
    play_unpaced(extension, monkeypatch, late_clip, is_looped=False)
    driven = Session(extension)
    thread = driven.session.thread
    scene.frame_set(50)

    def punch():
        if thread.names and not driven.session.is_recording:
            driven.live.begin_take(bpy.context, driven.session)

    driven.run(120, punch)
    driven.stop()
    assert driven.live.end_take(bpy.context, driven.session)
    driven.session.end()
    from mimetic.performance.document import Performance

    numbers = Performance.load(driven.session.takes[0]).frame
    first = 50 if is_named else numbers[0] + 101 - 1 - 4
    np.testing.assert_allclose(keyed(extension, face), first + numbers - numbers[0])
    assert numbers[0] > GREY


def test_own_controls_are_keyed_where_the_scene_shows_the_clip(
    scene,
    character,  # noqa: F811
    extension,
    acted,
):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    place = extension("scene_out.live").Place(101, 4)
    puppet = extension("scene_out.live_controls").ControlPuppet(scene, character)
    summary = puppet.record(scene, acted[0], "take", place, frozenset())
    assert (summary.first, summary.last) == (97, 97 + acted[0].num_frames - 1)
