# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks taught in Blender: listed, kept while a clip runs in a camera's place, saved as a set."""

import json
import time
from pathlib import Path

import bpy
import pytest
from last_result import result
from live_clip import ffmpeg, play_unpaced

SMILE = "zygomaticus_major.L"
NUM_FRAMES = 72  # of the clip, which is played there, back and there again
NEUTRAL_FRAME, SMILE_FRAME = 2 * NUM_FRAMES + 10, 3 * NUM_FRAMES - 10


@pytest.fixture(scope="session")
def clip(tmp_path_factory):
    """A man begins to smile, stops, and does so again; his head is known after four seconds."""
    from fetched_footage import fetched_clip

    path = tmp_path_factory.mktemp("looks") / "there_and_back.mkv"
    ffmpeg(
        *("-i", str(fetched_clip("single_face.mp4")), "-an", "-filter_complex"),
        "[0]split=3[a][b][c];[b]reverse[r];[a][r][c]concat=n=3",
        *("-c:v", "ffv1", str(path)),
    )
    return path


@pytest.fixture
def settings(scene, clip):
    settings = scene.mimetic.live
    settings.source, settings.clip_path = "CLIP", str(clip)
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    return settings


def keep_two(settings, tmp_path):
    """A set of two looks by their frames, without a window."""
    bpy.ops.mimetic.add_look(look="neutral", frame=NEUTRAL_FRAME)
    bpy.ops.mimetic.add_look(look="smile", frame=SMILE_FRAME)
    assert bpy.ops.mimetic.live(use_teaching=True) == {"FINISHED"}
    path = tmp_path / "looks.npz"
    assert bpy.ops.mimetic.save_set(filepath=str(path)) == {"FINISHED"}
    return path


@pytest.mark.newest
def test_looks_of_a_clips_frames_are_kept_and_saved_in_one_undo_step(
    settings, clip, tmp_path, extension
):
    bpy.ops.ed.undo_push(message="before")
    path = keep_two(settings, tmp_path)
    bpy.ops.ed.undo_push(message="saved")
    from mimetic.puppet.templates import TaughtSet

    taught = TaughtSet.load(path)
    assert taught.looks == ["neutral", "smile"] == extension("live_looks").kept()
    smile = taught.look_values[:, taught.channels.index(SMILE)]
    assert smile[0] < 0.2 < 0.4 < smile[1]
    assert "mouth" in taught.template_parts
    assert settings.taught_set == str(path) and settings.advice
    facts = result()
    assert facts["looks"] == taught.looks and facts["advice"] == settings.advice.split("\n")
    assert "d'" in facts["advice"][-1]
    # It drives, as any set that a camera taught
    beginning = tmp_path / "beginning.mkv"
    ffmpeg("-i", str(clip), "-frames:v", "20", "-c:v", "copy", str(beginning))
    settings.clip_path = str(beginning)
    assert bpy.ops.mimetic.live(use_teaching=False, set_use="DRIVE") == {"FINISHED"}
    scene = bpy.context.scene
    scene.mimetic.live.taught_set = scene.mimetic.live.advice = ""
    bpy.ops.ed.undo_push(message="emptied")
    bpy.ops.ed.undo()
    assert bpy.context.scene.mimetic.live.taught_set == str(path)
    bpy.ops.ed.undo()
    assert bpy.context.scene.mimetic.live.taught_set == "" and path.exists()


def ask_to_keep(index: int) -> None:
    """Unless the session began to measure the head anew since the button was lit."""
    try:
        bpy.ops.mimetic.keep_look(index=index)
    except RuntimeError as reason:
        assert "until the head is known" in str(reason)


@pytest.mark.newest
def test_a_look_is_kept_on_a_press_while_the_session_runs(
    settings, extension, tmp_path, monkeypatch
):
    live, operators = extension("live"), extension("operators.live")
    settings.use_teaching = True
    play_unpaced(extension, monkeypatch, settings.clip_path, is_looped=True)
    for name in ("neutral", "smile"):
        bpy.ops.mimetic.add_look(look=name)
    settings.active_look = 0
    assert not bpy.ops.mimetic.keep_look.poll()
    session = live.active = operators._session(bpy.context)
    keeper = session.thread.keeper
    try:
        session.thread.start()
        until = time.monotonic() + 120
        while session.thread.is_running and not keeper.kept and time.monotonic() < until:
            if bpy.ops.mimetic.keep_look.poll() and not keeper.keeping:
                ask_to_keep(0)
            time.sleep(0.02)
        assert settings.active_look == 1  # the next that is not kept
        session.thread.stop()
        assert keeper.kept == ["neutral"]
        assert "neutral: kept" in session.new_lines()
    finally:
        session.thread.stop()
        session.end()
        live.active = None
    with pytest.raises(RuntimeError, match="two are needed"):
        bpy.ops.mimetic.save_set(filepath=str(tmp_path / "one.npz"))
    assert not (tmp_path / "one.npz").exists()


def test_usual_looks_are_listed_once(scene):
    settings = scene.mimetic.live
    bpy.ops.mimetic.add_look(look="eyes closed")
    assert settings.looks[0].parts == {"EYES"}
    assert bpy.ops.mimetic.add_usual_looks() == {"FINISHED"}
    from mimetic.puppet.usual_looks import USUAL_LOOKS

    names = [look.name for look in settings.looks]
    assert sorted(names) == sorted(USUAL_LOOKS) and names[1] == "neutral"
    assert not bpy.ops.mimetic.add_usual_looks.poll()
    with pytest.raises(RuntimeError, match="smile already"):
        bpy.ops.mimetic.add_look(look="smile")
    settings.active_look = 1
    assert bpy.ops.mimetic.remove_look() == {"FINISHED"}
    assert "neutral" not in settings.looks and settings.active_look == 1


def test_a_look_drives_sliders_or_an_expression(settings, extension):
    face = bpy.context.active_object
    keys = face.data.shape_keys.key_blocks
    keys[SMILE].value = 0.6
    assert bpy.ops.mimetic.keep_expression(name="grin") == {"FINISHED"}
    bpy.ops.mimetic.add_look(look="smile", state="EXPRESSION", expression="grin")
    bpy.ops.mimetic.add_look(name="wink", parts={"EYES"})
    keys[SMILE].value, keys["lid_upper.L"].value = 0.0, 1.0
    assert bpy.ops.mimetic.take_sliders() == {"FINISHED"}
    as_look = extension("look_settings").as_look
    smile, wink = (as_look(look) for look in settings.looks)
    assert smile.values[SMILE] == pytest.approx(0.6) and smile.parts == ()
    assert wink.values["lid_upper.L"] == pytest.approx(1) and wink.parts == ("eye.L", "eye.R")
    assert json.loads(settings.looks[1].sliders)[SMILE] == 0
    with pytest.raises(RuntimeError, match="is no expression"):
        bpy.ops.mimetic.add_look(name="x", state="EXPRESSION", expression="nothing")


def test_grey_buttons_say_why(settings, extension, monkeypatch):
    operators, live = extension("operators.live_looks"), extension("live")
    context = bpy.context

    def reason(name):
        return getattr(operators, f"MIMETIC_OT_{name}").obstacle(context)

    assert reason("remove_look") == operators.NO_LOOK == reason("keep_look")
    assert "Keep a look first" in reason("save_set")
    bpy.ops.mimetic.add_look(name="wink", state="SLIDERS")
    assert "Start Live" in reason("keep_look")

    class Thread:
        keeper = None

    class Session:
        thread = Thread()

    monkeypatch.setattr(live, "active", Session())
    assert "tick Teach" in reason("keep_look") and "stop it first" in reason("take_sliders")
    Thread.keeper = extension("native").puppet("look_keeper").LookKeeper()
    assert "Take Sliders" in reason("keep_look")
    scene_look = context.scene.mimetic.live.looks[0]
    scene_look.state = "LIVE"
    assert "until the head is known" in reason("keep_look")


def test_a_look_that_cannot_be_kept_is_said_before_the_session(settings):
    bpy.ops.mimetic.add_look(name="wink", state="SLIDERS", frame=3)
    with pytest.raises(RuntimeError, match="Press Take Sliders first"):
        bpy.ops.mimetic.live(use_teaching=True)


def test_new_sets_lie_beside_the_file_and_replace_none(extension, tmp_path):
    takes = extension("takes")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    first = Path(takes.new_set_path())
    assert first == tmp_path / "looks.taught.npz"
    first.touch()
    assert Path(takes.new_set_path()) == tmp_path / "looks.002.taught.npz"


def test_the_panel_shows_list_state_and_advice(settings):
    from panel_texts import drawn

    bpy.ops.mimetic.add_look(look="smile")
    settings.advice = "All looks are told apart\nmost alike: a and b"
    text = drawn("MIMETIC_PT_live_looks")
    assert "All looks are told apart" in text and "most alike: a and b" in text
    assert "mimetic.take_sliders" not in text and "frame" in text
    settings.looks[0].state, settings.source = "SLIDERS", "CAMERA"
    text = drawn("MIMETIC_PT_live_looks")
    assert "mimetic.take_sliders" in text and "frame" not in text
