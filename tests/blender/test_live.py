# SPDX-License-Identifier: GPL-3.0-or-later
"""A face driven live: headless through a whole clip, and as its timer drives it."""

import time
import wave
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from last_result import result
from live_clip import ffmpeg, play_unpaced

pytestmark = pytest.mark.oldest_and_newest

SMILE, BROW, RATE = "zygomaticus_major.L", "frontalis_medial.L", 30
CHANNELS = {"HEAD_POSITION", "HEAD_ROTATION", "EYES", "MOUTH", "BROWS"}


NUM_FRAMES = 45
FITTED = (1, 5)


@pytest.fixture(scope="session")
def clip(tmp_path_factory):
    """The first frames of a real clip, in which a man begins to smile; with a sound."""
    from fetched_footage import fetched_clip

    path = tmp_path_factory.mktemp("live") / "clip.mkv"
    ffmpeg(
        *("-i", str(fetched_clip("single_face.mp4"))),
        *("-f", "lavfi", "-i", "sine=frequency=440:sample_rate=48000", "-shortest"),
        *("-map", "0:v", "-map", "1:a", "-frames:v", str(NUM_FRAMES), "-c:v", "ffv1"),
        *("-c:a", "pcm_s16le", str(path)),
    )
    return path


@pytest.fixture(scope="module")
def brief_clip(clip, tmp_path_factory):
    """Its beginning, for what a few pictures show as well."""
    path = tmp_path_factory.mktemp("live") / "brief.mkv"
    ffmpeg("-i", str(clip), "-frames:v", "12", "-c:v", "copy", str(path))
    return path


@pytest.fixture(scope="module")
def clip_fit(brief_clip):
    """The fit of the man's face, as Find Face has it."""
    from mimetic.solve import clip_capture

    return clip_capture.find_face(brief_clip, frames=FITTED)


@pytest.fixture
def face(scene, clip):
    scene.mimetic.live.source = "CLIP"
    scene.mimetic.live.clip_path = str(clip)
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return bpy.context.active_object


def curves_of(extension, block):
    holder = extension("compat").curves(block)
    return {} if holder is None else {(c.data_path, c.array_index): c for c in holder.fcurves}


def values_of(curve):
    return np.array([point.co[1] for point in curve.keyframe_points])


def strips_of(scene):
    editor = scene.sequence_editor
    return editor.strips if hasattr(editor, "strips") else editor.sequences


def slider(name):
    return f'key_blocks["{name}"].value', 0


def test_a_clip_is_recorded_whole(scene, face, clip, extension):
    scene.frame_set(11)
    rate = scene.render.fps, scene.render.fps_base
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    assert (scene.render.fps, scene.render.fps_base) == rate
    muscles = curves_of(extension, face.data.shape_keys)
    smile = muscles[slider(SMILE)]
    assert smile.keyframe_points[0].co[0] == pytest.approx(11)
    values = values_of(smile)
    assert len(values) == NUM_FRAMES and values[:8].max() < 0.2 < 0.4 < values[-8:].min()
    head = curves_of(extension, face)
    assert values_of(head["rotation_quaternion", 0])[0] == pytest.approx(1)
    assert 0.001 < np.ptp(values_of(head["location", 0])) < 0.1  # metres
    facts = result()
    from mimetic.performance.document import Performance

    assert Performance.load(facts["takes"][0]).num_frames == NUM_FRAMES
    sound_path = Path(facts["takes"][0]).with_suffix(".wav")
    if bpy.app.build_options.audaspace:
        (strip,) = strips_of(scene)
        assert Path(bpy.path.abspath(strip.sound.filepath)) == sound_path
        assert strip.frame_start == pytest.approx(11) and strip.channel == 1
    with wave.open(str(sound_path)) as sound:
        assert sound.getnframes() / sound.getframerate() == pytest.approx(
            (NUM_FRAMES - 1) / RATE, abs=0.05
        )


def test_channels_that_are_not_chosen_keep_their_curves(scene, face, extension):
    keys = face.data.shape_keys
    for name in (SMILE, BROW):
        keys.key_blocks[name].value = 0.7
        keys.key_blocks[name].keyframe_insert("value", frame=1)
    scene.mimetic.live.channels = {"MOUTH"}
    before = keys.animation_data.action.name
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    muscles = curves_of(extension, keys)
    assert values_of(muscles[slider(BROW)]) == pytest.approx([0.7])
    assert len(muscles[slider(SMILE)].keyframe_points) == NUM_FRAMES
    assert slider("lid_upper.L") not in muscles
    assert curves_of(extension, face) == {}  # the head
    assert keys.animation_data.action.name != before and before in bpy.data.actions


def test_a_second_take_keeps_the_first(scene, face, brief_clip):
    scene.mimetic.live.clip_path = str(brief_clip)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    first, path = face.data.shape_keys.animation_data.action, result()["takes"][0]
    scene.frame_set(100)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    assert face.data.shape_keys.animation_data.action != first and first.use_fake_user
    assert result()["takes"][0] != path


@pytest.mark.newest
def test_a_second_take_starts_from_where_the_head_stood_before_the_first(scene, face, extension):
    face.location = (0.5, 0, 0)
    starts = []
    for first in (11, 11 + NUM_FRAMES - 1):  # at the take's end the head is elsewhere
        scene.frame_set(first)
        assert bpy.ops.mimetic.live() == {"FINISHED"}
        curves = curves_of(extension, face)
        starts.append([curves["location", axis].evaluate(first) for axis in range(3)])
    assert starts[0] == pytest.approx([0.5, 0, 0], abs=1e-4)
    assert starts[1] == pytest.approx(starts[0], abs=1e-4)


@pytest.mark.newest
def test_a_baked_faces_eyes_turn_by_their_own_shapes(scene, face, brief_clip, extension):
    scene.mimetic.live.clip_path = str(brief_clip)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    from mimetic.performance.document import Performance

    performance = Performance.load(result()["takes"][0])
    extension("scene_out").bake(scene, performance, "baked")
    baked = scene.mimetic.face
    bpy.context.view_layer.objects.active = baked
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    assert result()["object"] == baked.name
    muscles = curves_of(extension, baked.data.shape_keys)
    assert slider("eye_left.L") in muscles and slider(SMILE) in muscles


class Session:
    """What the modal operator does, without its window: its ticks."""

    def __init__(self, extension):
        self.operators, self.live = extension("operators.live"), extension("live")
        self.session = self.operators._session(bpy.context)
        self.session.thread.start()

    def run(self, seconds, each=lambda: None):
        until = time.monotonic() + seconds
        while time.monotonic() < until and self.session.thread.is_running:
            self.operators.show(self.session)
            each()
            time.sleep(0.01)
        self.operators.show(self.session)  # what came since the last tick
        each()

    def stop(self):
        self.session.thread.stop()


def test_the_face_follows_and_is_put_back(scene, face, extension, monkeypatch):
    play_unpaced(extension, monkeypatch, scene.mimetic.live.clip_path, is_looped=False)
    scene.mimetic.live.channels = CHANNELS - {"BROWS"}
    keys = face.data.shape_keys.key_blocks
    keys[SMILE].value, keys[BROW].value = 0.25, 0.7
    place = face.matrix_basis.copy()
    driven = Session(extension)
    seen = []
    driven.run(120, lambda: seen.append((keys[SMILE].value, face.location[0], keys[BROW].value)))
    driven.stop()
    assert driven.session.thread.error is None
    smile, aside, brow = np.array(seen).T
    assert smile.max() > 0.4 and smile.min() < 0.2 and np.ptp(aside) > 1e-4
    assert brow == pytest.approx(0.7)  # left out since before the first picture
    contact = extension("scene_out.contact")
    assert face.name in contact.still_faces
    assert not face.modifiers["Subdivision"].show_viewport
    driven.session.end()
    driven.session.puppet.restore()
    assert face.name not in contact.still_faces
    assert face.modifiers["Subdivision"].show_viewport
    assert keys[SMILE].value == pytest.approx(0.25)
    assert face.matrix_basis == place


def test_an_error_in_a_tick_leaves_nothing_behind(face, extension, monkeypatch):
    operators, live, jobs = extension("operators.live"), extension("live"), extension("jobs")
    pressed = operators.MIMETIC_OT_live

    class Pressed(jobs.Modal):
        """The operator as Blender makes it, which only Blender can."""

        handle, leave, _tick, _told = pressed.handle, pressed.leave, pressed._tick, 0.0

    def fail(_):
        raise RuntimeError("no such face")

    monkeypatch.setattr(operators, "show", fail)
    live.active = operators._session(bpy.context)
    jobs.running = live.active.run
    session = live.active
    session.thread.start()
    pressed = Pressed()
    pressed._run = jobs.running
    with pytest.raises(RuntimeError, match="no such face"):
        pressed.modal(bpy.context, SimpleNamespace(type="TIMER", value="NOTHING"))
    session.thread.join(60)
    assert not session.thread.is_running
    assert live.active is None and not jobs.busy()
    assert bpy.context.preferences.system.viewport_aa != "OFF"
    assert face.name not in extension("scene_out.contact").still_faces


def test_what_the_end_of_a_take_tells_is_reported(scene, extension, monkeypatch):
    operators, live, jobs = extension("operators.live"), extension("live"), extension("jobs")
    pressed, reports = operators.MIMETIC_OT_live, []

    class Pressed(jobs.Modal):
        bl_idname, leave = pressed.bl_idname, jobs.Modal.leave
        _end, _report_lines = pressed._end, pressed._report_lines

        def report(self, levels, line):
            reports.append((*levels, line))

    def end_take(_context, session):
        session.thread.told.append("microphone headset: there is no such microphone")
        return "takes recorded"

    monkeypatch.setattr(live, "end_take", end_take)
    thread = SimpleNamespace(stop=lambda: None, error=None, told=["the head is known"])
    puppet = SimpleNamespace(name="Face")
    session = live.Session(jobs.Run("Live"), thread, puppet, takes=["a.npz"])
    assert Pressed()._end(bpy.context, session) == {"FINISHED"}
    assert [line for _, line in reports] == [
        *("the head is known", "microphone headset: there is no such microphone"),
        "takes recorded",
    ]


def test_a_take_can_be_punched_in(scene, face, extension, monkeypatch):
    play_unpaced(extension, monkeypatch, scene.mimetic.live.clip_path, is_looped=True)
    driven = Session(extension)
    thread = driven.session.thread

    def punch():
        if thread.names and not driven.session.is_recording:
            scene.frame_set(50)
            driven.live.begin_take(bpy.context, driven.session)
        elif driven.session.is_recording and len(thread._take.states) > 3:
            thread.stop()

    driven.run(120, punch)
    driven.stop()
    assert driven.live.end_take(bpy.context, driven.session)
    smile = curves_of(extension, face.data.shape_keys)[slider(SMILE)]
    assert smile.keyframe_points[0].co[0] == pytest.approx(50)
    assert not driven.session.is_recording
    driven.session.end()


def test_no_face_in_the_clip_changes_nothing(scene, face, tmp_path):
    grey = tmp_path / "grey.mp4"
    source = ("-f", "lavfi", "-i", "color=gray:size=320x240:rate=25", "-frames:v", "10")
    ffmpeg(*source, str(grey))
    scene.mimetic.live.clip_path = str(grey)
    num_actions = len(bpy.data.actions)
    with pytest.raises(RuntimeError, match="No face was seen"):
        bpy.ops.mimetic.live()
    assert len(bpy.data.actions) == num_actions and face.data.shape_keys.animation_data is None


@pytest.mark.parametrize(
    ("source", "path", "message"),
    [("CAMERA", "", "needs Blender's window"), ("CLIP", "/no/such.mp4", "no/such.mp4")],
)
def test_a_source_that_is_none_is_said(scene, face, source, path, message):
    scene.mimetic.live.source, scene.mimetic.live.clip_path = source, path
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.mimetic.live()


@pytest.mark.newest
def test_the_clips_fit_is_the_head_from_the_first_picture_on(
    scene, face, brief_clip, clip_fit, extension
):
    live = extension("live")
    loaded = bpy.data.movieclips.load(str(brief_clip))
    scene.mimetic.clip, scene.mimetic.live.clip_path = loaded, ""
    assert live.person_of(bpy.context) is None
    extension("scene_out").face_fit.store(loaded, clip_fit)
    person = live.person_of(bpy.context)
    assert live.lens_of(bpy.context, person).focal_mm > 0
    assert live.person_of(bpy.context) is person
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    from mimetic.performance.document import Performance
    from mimetic.template.face_template import load_template

    take = Performance.load(result()["takes"][0])
    neutral = person.neutral_vertices(load_template())
    np.testing.assert_allclose(take.neutral_vertices, neutral, atol=1e-6)
    assert bpy.ops.mimetic.live(use_fit=False) == {"FINISHED"}
    stranger = Performance.load(result()["takes"][0])
    assert np.abs(stranger.neutral_vertices - neutral).max() > 1e-4


@pytest.mark.newest
def test_a_fit_of_other_footage_is_the_persons(
    scene, face, brief_clip, clip_fit, extension, tmp_path
):
    loaded = bpy.data.movieclips.load(str(brief_clip))
    scene.mimetic.clip, scene.mimetic.live.clip_path = loaded, str(brief_clip)
    extension("scene_out").face_fit.store(loaded, clip_fit)
    live, path = extension("live"), tmp_path / "fit.json"
    assert live.person_of(bpy.context) is None  # the clip that is named may show another person
    extension("scene_out").face_fit.of_clip(loaded).save(path)
    scene.mimetic.live.fit_path = str(path)
    assert live.person_of(bpy.context).identity
    assert live.lens_of(bpy.context, live.person_of(bpy.context)) is None
    scene.mimetic.live.fit_path = str(tmp_path / "none.json")
    with pytest.raises(RuntimeError, match=r"none\.json"):
        bpy.ops.mimetic.live()


def test_a_taught_set_that_is_none_is_said(scene, face, tmp_path):
    scene.mimetic.live.taught_set = str(tmp_path / "no_set.npz")
    with pytest.raises(RuntimeError, match=r"no_set\.npz"):
        bpy.ops.mimetic.live()


def test_fast_view_puts_back_what_it_lowered(face, extension):
    preferences, modifier = bpy.context.preferences, face.modifiers["Subdivision"]
    before, is_dirty = preferences.system.viewport_aa, preferences.is_dirty
    assert before != "OFF" and modifier.show_viewport
    fast = extension("fast_view").FastView(face)
    assert preferences.system.viewport_aa == "OFF" and not modifier.show_viewport
    assert preferences.is_dirty == is_dirty  # else Blender would keep it when it quits
    fast.end()
    fast.end()
    assert preferences.system.viewport_aa == before and modifier.show_viewport
    assert preferences.is_dirty == is_dirty


def test_fast_view_leaves_what_was_changed_or_off_meanwhile(face, extension):
    system, modifier = bpy.context.preferences.system, face.modifiers["Subdivision"]
    before, modifier.show_viewport = system.viewport_aa, False
    fast = extension("fast_view").FastView(face)
    system.viewport_aa = "FXAA"
    fast.end()
    assert system.viewport_aa == "FXAA" and not modifier.show_viewport
    system.viewport_aa = before


def test_without_a_face_the_button_is_grey():
    assert not bpy.ops.mimetic.live.poll()


def test_the_settings_name_the_packages_channels(extension):
    from mimetic.puppet import channels

    assert extension("live_settings").package_channels(CHANNELS) == frozenset(channels.CHANNELS)
    assert extension("live").ALL == CHANNELS
