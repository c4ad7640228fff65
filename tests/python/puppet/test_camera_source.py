# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras that misbehave: each says so in one line, and recovers or ends."""

import threading
import time
from collections import deque
from pathlib import Path

import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.puppet import camera_source
from mimetic.puppet.camera_source import CameraSource, camera_input, is_camera, reason_of
from mimetic.puppet.pictures import Events, NewestPicture

STAND_IN = Path(__file__).with_name("stand_in_camera.py")


@pytest.fixture
def watch(monkeypatch, tmp_path):
    """Runs a stand-in until a picture of brightness `last`, or until it ends by itself."""
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(STAND_IN))
    monkeypatch.setenv("STAND_IN_COUNT", str(tmp_path / "openings"))
    monkeypatch.setattr(camera_source, "STALLED", 0.5)
    monkeypatch.setattr(camera_source, "RETRY", 0.05)

    def run(behaviour, last=20, patience=5.0, longest=20.0):
        source = CameraSource(f"camera:/dev/{behaviour}", size=(32, 24), patience=patience)
        pictures, events, failures = NewestPicture(), Events(), []

        def feed():
            try:
                source.feed(pictures, events)
            except UnreadableMedia as error:
                failures.append(str(error))
            pictures.close()

        thread = threading.Thread(target=feed)
        thread.start()
        seen = []
        give_up = time.monotonic() + longest
        while not pictures.is_closed and time.monotonic() < give_up:
            picture = pictures.take(0.05)
            if picture is not None:
                seen.append(picture)
                if picture.image[0, 0, 0] == last:
                    break
        events.stop()
        thread.join()
        return seen, events.lines, failures

    return run


def test_pictures_come_with_times_that_grow(watch):
    seen, lines, failures = watch("fine")
    assert lines == failures == []
    assert seen[0].image.shape == (24, 32, 3)
    times = [picture.time for picture in seen]
    assert times[0] >= 0 and times == sorted(times)


@pytest.mark.parametrize(
    ("behaviour", "reason"), [("forbidden", "no permission"), ("busy", "another program uses it")]
)
def test_a_camera_that_may_not_be_used_says_why_at_once(watch, behaviour, reason):
    seen, lines, failures = watch(behaviour)
    assert seen == lines == []
    assert len(failures) == 1 and reason in failures[0] and "\n" not in failures[0]


def test_a_stall_is_said_and_its_end(watch):
    seen, lines, failures = watch("stalled")
    assert failures == []
    assert "gives no picture" in lines[0] and lines[1].endswith("gives pictures again")
    assert len(lines) == 2 and seen[-1].image[0, 0, 0] == 20


def test_a_camera_that_stays_silent_is_opened_again(watch, monkeypatch):
    monkeypatch.setattr(camera_source, "GIVEN_UP", 1.0)
    _, lines, failures = watch("silent", last=99, patience=3.0, longest=4.0)
    assert any("it gave no picture" in line for line in lines)
    assert any(line.endswith("is back") for line in lines)
    assert failures == []


def test_a_camera_that_is_plugged_in_again_goes_on(watch):
    seen, lines, failures = watch("replugged")
    assert failures == []
    assert "went away (there is no such camera" in lines[0] and lines[1].endswith("is back")
    times = [picture.time for picture in seen]
    assert times == sorted(times) and seen[-1].image[0, 0, 0] == 20


def test_a_camera_that_stays_away_ends_the_session(watch):
    seen, lines, failures = watch("unplugged", patience=0.3)
    assert seen and "went away" in lines[0]
    assert len(failures) == 1 and "did not come back within 0.3 s" in failures[0]


def test_pictures_of_another_shape_are_said_and_marked(watch):
    seen, lines, failures = watch("resized")
    assert failures == [] and "gives pictures of 320 x 240 now" in lines[0]
    assert any(picture.is_new_view for picture in seen)


def test_cameras_are_named_as_the_system_has_them():
    assert is_camera("camera:0") and is_camera("/dev/video3") and not is_camera("clip.mp4")
    assert camera_input("camera:1", "linux")[-1] == "/dev/video1"
    assert camera_input("camera:FaceTime", "darwin")[-1] == "FaceTime:none"
    assert camera_input("camera:HD {0}", "win32")[-1] == "video=HD {{0}}"


@pytest.mark.parametrize("name", ["camera:", "camera:-f", "camera:a\nb", "camera:/dev/../etc/x"])
def test_what_names_no_camera_is_refused(name):
    with pytest.raises(InvalidInput):
        camera_input(name, "linux")


def test_a_camera_that_is_not_there_says_so():
    with pytest.raises(UnreadableMedia, match="there is no such camera"):
        CameraSource("camera:/dev/video_none").feed(NewestPicture(), Events())


def test_a_microphone_is_not_called_a_camera():
    words = deque([b"[in#0] Unknown input format: 'pulse'"])
    assert reason_of(words, "microphone").startswith("this ffmpeg reads no microphones")
    assert reason_of(words).startswith("this ffmpeg reads no cameras")
